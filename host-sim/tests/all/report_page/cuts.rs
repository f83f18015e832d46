//! Programs with several cuts: which one the page shows, and what became of the others.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use truepath::command::{correct, inspect, simulate};
use truepath_ground::units::rounded;
use truepath_job::job::{JobFile, Which};
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

use super::part::shown;
use super::reading::{data, in_mm};

const MACHINE: &str = "ktc_n_per_mm2 = 700\nkrc_n_per_mm2 = 210\nkte_n_per_mm = 14\nkre_n_per_mm = 14\nstiffness_x_n_per_mm = 1500\nstiffness_y_n_per_mm = 2000\n";

/// A copy of a program with several cuts, with its job.
fn copied(name: &str) -> (tempfile::TempDir, PathBuf) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/features");
    let folder = tempfile::tempdir().unwrap();
    for ending in ["toml", "nc"] {
        let file = format!("{name}.{ending}");
        fs::copy(from.join(&file), folder.path().join(&file)).unwrap();
    }
    let job = folder.path().join(format!("{name}.toml"));
    (folder, job)
}

fn simulated(job: &Path, out: &Path, which: Which) -> Value {
    let (job, output) = (job.to_owned(), out.to_owned());
    let options = simulate::Options { job, output, which, ..simulate::Options::default() };
    shown(simulate::run(&options));
    data(&out.join("report.html"))
}

/// Role, level and outcome of every cut.
fn outcomes(page: &Value) -> Vec<(String, Option<u64>, String)> {
    let text = |v: &Value| v.as_str().unwrap().to_owned();
    let cuts = page["program"]["cuts"].as_array().unwrap().iter();
    cuts.map(|cut| (text(&cut["role"]), cut["level"].as_u64(), text(&cut["became"]))).collect()
}

fn of_walls(page: &Value) -> Vec<(u64, String)> {
    outcomes(page).into_iter().filter(|(role, ..)| role == "finish").map(|(_, level, b)| (level.unwrap(), b)).collect()
}

#[test]
fn a_page_of_one_of_several_depths_names_it_and_lists_the_others() {
    let (folder, job) = copied("pocket");
    let which = Which { pass: Some(2), ..Which::default() };
    let page = simulated(&job, &folder.path().join("out"), which);
    let program = &page["program"];
    assert_eq!(in_mm(&program["shown"]), "the finishing contour, pass 2 of 2, Z -12 mm, lines 86-94");
    assert!(program["why"].as_str().unwrap().contains("whose wall no other run takes away"));
    assert_eq!(of_walls(&page), [(1, "elsewhere".to_owned()), (2, "shown".to_owned())]);
    assert_eq!(outcomes(&page).len(), 9);
    let summary: Value = serde_json::from_slice(&fs::read(folder.path().join("out/summary.json")).unwrap()).unwrap();
    for (cut, told) in
        program["cuts"].as_array().unwrap().iter().zip(summary["feature"]["candidates"].as_array().unwrap())
    {
        for key in ["role", "first_line", "last_line", "z_mm", "length_mm", "why"] {
            assert_eq!(cut[key], told[key]);
        }
    }
    // In a line, as a page of several contours tells it.
    let outcome = &page["outcome"];
    assert_eq!((&outcome["lines"], &outcome["z_mm"]), (&serde_json::json!([86, 94]), &serde_json::json!(-12.0)));
    assert_eq!(outcome["length_mm"], summary["length_mm"]);
    assert_eq!(outcome["before_mm"].as_f64().unwrap(), rounded(summary["max_error_mm"].as_f64().unwrap(), 6));
    for none in ["measured_mm", "after_mm", "sigma_mm", "gouge_mm"] {
        assert!(outcome.get(none).is_none(), "{none}");
    }
}

#[test]
fn a_correction_tells_which_depths_got_it_and_an_inspection_which_it_judged() {
    let (folder, job) = copied("pocket");
    let at = |name: &str| folder.path().join(name);
    let pass = shown(JobFile::read(&job).map_err(Into::into).and_then(Pass::read));
    let machine: Machine = toml::from_str(MACHINE).unwrap();
    let milled = shown(virtual_mill::mill(&pass, &machine, None));
    let places: Vec<f64> = [0.1, 0.35, 0.6, 0.9].iter().map(|share| share * milled.path.length_mm).collect();
    fs::write(at("probe.txt"), shown(virtual_mill::probe(&pass, &milled, &places, &[0.3, 0.8], 4.0))).unwrap();
    shown(correct::run(
        &correct::Options {
            job: job.clone(),
            probe: Some(at("probe.txt")),
            output: at("out"),
            ..correct::Options::default()
        },
        &mut |_| (),
    ));
    let page = data(&at("out/report.html"));
    assert_eq!(of_walls(&page), [(1, "shown".to_owned()), (2, "corrected".to_owned())]);
    let others: Vec<String> = outcomes(&page).into_iter().filter(|(role, ..)| role != "finish").map(|o| o.2).collect();
    assert!(others.len() == 7 && others.iter().all(|became| became == "unchanged"), "{others:?}");

    let told = shown(inspect::run(&inspect::Options {
        job,
        probe: Some(at("probe.txt")),
        output: Some(at("inspected")),
        ..inspect::Options::default()
    }));
    let limits = "Judged is the wall of the finishing contour, pass 1 of 2, Z -6 mm, lines 71-79; not those of pass 2 (Z -12 mm).";
    assert!(told.summary.statements.iter().any(|s| s == limits), "{:?}", told.summary.statements);
    let page = data(&at("inspected/report.html"));
    assert_eq!(page["statements"].as_array().unwrap().iter().filter(|s| in_mm(s) == limits).count(), 1);
}

#[test]
fn a_marked_feature_is_named_with_the_others_of_the_program() {
    let (folder, job) = copied("markers");
    let which = Which { feature: Some("boss".to_owned()), ..Which::default() };
    // The tool of the job is that of one feature.
    let page = simulated(&job, &folder.path().join("out"), which);
    assert!(in_mm(&page["program"]["shown"]).starts_with("feature \"boss\", Z "), "{}", page["program"]);
    assert_eq!(page["program"]["other_features"], serde_json::json!(["pocket"]));
}

#[test]
fn a_program_with_one_cut_needs_no_list() {
    let part = super::part::pocket("");
    part.simulate(false, "out");
    let program = &data(&part.at("out/report.html"))["program"];
    assert_eq!(program.as_object().unwrap().keys().collect::<Vec<_>>(), ["crc32", "name"]);
}
