//! Targets over the height, the gouge guard and the comparison of laws, on the virtual machine.

use std::path::Path;

use truepath::command::compare;
use truepath::command::compare::CompareSummary;
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Machine, Milled};
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../../demo/corner-helix/job.toml");
const PLANT: &str = include_str!("../../demo/corner-helix/plant.toml");
const PROGRAM: &str = include_str!("../../demo/corner-helix/program.nc");
const PLACES: [f64; 5] = [20.0, 32.0, 49.0, 68.0, 80.0];
const HEIGHTS: [f64; 3] = [0.1, 0.5, 0.9];
/// Left out at either end.
const TRIM: f64 = 8.0;

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn machine() -> Machine {
    toml::from_str(PLANT).unwrap()
}

fn pass(correct: &str) -> Pass {
    let text = JOB.replace("[correct]", &format!("[correct]\n{correct}"));
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).unwrap();
    shown(Pass::new(job, Source::new("program.nc", PROGRAM.as_bytes().to_vec())))
}

fn probed(pass: &Pass) -> String {
    let milled = shown(virtual_mill::mill(pass, &machine(), None));
    shown(virtual_mill::probe(pass, &milled, &PLACES, &HEIGHTS, 6.0))
}

/// The correction, and the part that is milled with it.
fn milled(keys: &str) -> (CorrectedPass, Milled) {
    let pass = pass(keys);
    let file = Source::new("probe.txt", probed(&pass).into_bytes());
    let measurement = shown(Measurement::read(&pass, &file));
    let done = shown(correct_pass(&pass, &measurement, &[], &[Route::Program], &mut |_| ()));
    let text = done.program.as_deref().unwrap();
    let part = shown(virtual_mill::mill(&pass, &machine(), Some(&shown(virtual_mill::commanded(&pass, text)))));
    (done, part)
}

/// Errors at the judged places: one row a place, one column a level.
fn errors(milled: &Milled, levels: &[f64]) -> Vec<Vec<f64>> {
    let rows = milled.wall_errors(levels);
    let s = &milled.path.s_mm;
    let judged = (0..s.len()).filter(|i| s[*i] > TRIM && s[*i] < milled.path.length_mm - TRIM);
    judged
        .map(|i| rows.iter().map(|row| row[i]).collect::<Vec<f64>>())
        .filter(|e| e.iter().all(|e| e.is_finite()))
        .collect()
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn each_target_brings_its_own_quantity_nearest_to_zero() {
    let levels: Vec<f64> = (0..20).map(|k| (f64::from(k) + 0.5) / 20.0).collect();
    let largest = |milled: &Milled, levels: &[f64], quantity: fn(&[f64]) -> f64| {
        errors(milled, levels).iter().map(|e| quantity(e).abs()).fold(0.0, f64::max)
    };
    let mean: fn(&[f64]) -> f64 = |e| e.iter().sum::<f64>() / e.len() as f64;
    let middle: fn(&[f64]) -> f64 =
        |e| f64::midpoint(e.iter().copied().fold(f64::MAX, f64::min), e.iter().copied().fold(f64::MIN, f64::max));
    let upper: Vec<f64> = levels.iter().copied().filter(|z| *z > 0.5).collect();
    let keys = ["target = \"mean\"", "target = \"tip\"", "target = \"minimax\"", "band_mm = [5.0, 10.0]"];
    let left = keys.map(|keys| {
        let (_, part) = milled(keys);
        [
            largest(&part, &levels, mean),
            largest(&part, &[0.0], mean),
            largest(&part, &levels, middle),
            largest(&part, &upper, mean),
        ]
    });
    for quantity in 0..4 {
        let least = left.iter().map(|row| row[quantity]).fold(f64::MAX, f64::min);
        assert!(left[quantity][quantity] <= least, "{}: {left:?}", keys[quantity]);
        assert!(left[quantity][quantity] < 0.08, "{}: {left:?}", keys[quantity]);
    }
}

#[test]
fn the_guard_holds_on_a_machine_it_does_not_know_and_reports_what_it_costs() {
    let levels: Vec<f64> = (0..=20).map(|k| f64::from(k) / 20.0).collect();
    let deepest = |part: &Milled| errors(part, &levels).iter().flatten().copied().fold(f64::MAX, f64::min);
    let (free, ungarded) = milled("");
    assert!(free.summary.guard.is_none());
    assert!(deepest(&ungarded) < -0.03, "{}", deepest(&ungarded));
    let (held, guarded) = milled("max_gouge_mm = 0.02");
    assert!(deepest(&guarded) > -0.02, "{}", deepest(&guarded));
    let guard = held.summary.guard.unwrap();
    assert!(guard.heeded && (guard.max_gouge_mm, guard.confidence_sigmas) == (0.02, 3));
    assert!(guard.deepest_with_confidence_mm < 0.0205, "{guard:?}");
    assert!(guard.deepest_mm < guard.deepest_with_confidence_mm, "{guard:?}");
    assert!(guard.moved_mm > 0.02 && !guard.places.is_empty(), "{guard:?}");
    let worst = guard.places.iter().find(|p| p.moved_mm() == guard.moved_mm).unwrap();
    assert!(worst.from_s_mm <= worst.at_s_mm && worst.at_s_mm <= worst.to_s_mm);
    assert!(worst.wanted_mm > worst.allowed_mm, "{worst:?}");
    // The target pays for it, and the summary says so.
    assert!(held.summary.max_error_after_mm > free.summary.max_error_after_mm + 0.01);
    assert!(held.summary.warnings.iter().any(|w| w.contains("holds the cutter back")), "{:?}", held.summary.warnings);
}

/// A folder with job, program, plant and probe file, and the comparison in it.
fn compared(on_plant: bool) -> (tempfile::TempDir, CompareSummary) {
    let desk = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(desk.path().join(name), text).unwrap();
    write("program.nc", PROGRAM);
    write("job.toml", JOB);
    write("plant.toml", PLANT);
    write("probe.txt", &probed(&pass("")));
    let [job, probe, plant, out] = ["job.toml", "probe.txt", "plant.toml", "out"].map(|name| desk.path().join(name));
    let options = compare::Options {
        job,
        probe,
        plant: on_plant.then_some(plant),
        output: Some(out),
        ..compare::Options::default()
    };
    let summary = shown(compare::run(&options, &mut |_| ()));
    (desk, summary)
}

#[test]
fn every_law_is_compared_on_a_machine_that_shares_no_physics_with_the_model() {
    let (desk, summary) = compared(true);
    assert_eq!((summary.machine, summary.target, summary.points_used), ("plant", "mean", 15));
    let names: Vec<&str> = summary.laws.iter().map(|row| row.law).collect();
    assert_eq!(names, ["none", "constant", "mirror", "paper", "model"]);
    let error = |name: &str| summary.laws.iter().find(|row| row.law == name).and_then(|row| row.max_error_mm).unwrap();
    assert!(error("none") > 0.5, "{summary:?}");
    assert!(
        ["none", "constant", "mirror", "paper"].into_iter().all(|law| error(law) > 2.0 * error("model")),
        "{summary:?}"
    );
    let model = summary.laws.last().unwrap();
    assert!((model.factor.unwrap() - error("none") / error("model")).abs() < 1e-9);
    let paper = &summary.laws[3];
    assert!(paper.remark.contains("origin of the program"), "{}", paper.remark);
    for name in ["compare.csv", "walls.csv", "summary.json", "compare.svg"] {
        assert!(desk.path().join("out").join(name).metadata().unwrap().len() > 200, "{name}");
    }
    let table = std::fs::read_to_string(desk.path().join("out/compare.csv")).unwrap();
    assert!(table.starts_with("law,title,max_error_mm,rms_error_mm,worst_height_mm,gouge_mm,factor,"), "{table}");
    assert_eq!(table.lines().count(), 6);
}

#[test]
fn without_a_virtual_machine_the_laws_are_compared_on_the_identified_one() {
    let (_desk, summary) = compared(false);
    assert_eq!(summary.machine, "identified");
    let [none, .., model] = summary.laws.as_slice() else { panic!("{summary:?}") };
    assert!(none.max_error_mm.unwrap() > 0.5 && model.factor.unwrap() > 15.0, "{summary:?}");
}
