//! `truepath learn` on files: what it writes, and everything that would apply a correction twice or to another part.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use truepath::command::{correct, learn};
use truepath_correction::learn::LearnSummary;
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/demo/corner-helix");

/// A folder with program, job, the probe files of two parts and the correction of the second, made once.
static BENCH: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["program.nc", "job.toml"] {
        fs::copy(Path::new(DEMO).join(name), at(name)).unwrap();
    }
    let plant = fs::read_to_string(Path::new(DEMO).join("plant.toml")).unwrap();
    let machine: Machine = toml::from_str(&plant).unwrap();
    let pass = Pass::read(JobFile::read(&at("job.toml")).unwrap()).unwrap();
    let probe = |commanded: Option<&[[f64; 2]]>, places: &[f64], name: &str| {
        let milled = virtual_mill::mill(&pass, &machine, commanded).unwrap();
        fs::write(at(name), virtual_mill::probe(&pass, &milled, places, &[0.1, 0.5, 0.9], 6.0).unwrap()).unwrap();
    };
    probe(None, &[20.0, 32.0, 68.0, 80.0], "part-1.txt");
    probe(None, &[21.0, 32.5, 49.0, 68.5, 80.5], "uncorrected.txt");
    let options = correct::Options {
        job: at("job.toml"),
        probe: Some(at("part-1.txt")),
        output: at("first"),
        ..correct::Options::default()
    };
    correct::run(&options, &mut |_| ()).unwrap();
    let commanded = virtual_mill::commanded(&pass, &fs::read(at("first/corrected.nc")).unwrap()).unwrap();
    probe(Some(&commanded), &[21.0, 32.5, 49.0, 68.5, 80.5], "part-2.txt");
    folder
});

/// A copy of the bench to spoil.
fn copy() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    fs::create_dir(path.join("first")).unwrap();
    for part in ["", "first"] {
        for entry in fs::read_dir(BENCH.path().join(part)).unwrap().map(Result::unwrap) {
            if entry.file_type().unwrap().is_file() {
                fs::copy(entry.path(), path.join(part).join(entry.file_name())).unwrap();
            }
        }
    }
    (folder, path)
}

fn edit(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{} has no {from}", file.display());
    fs::write(file, text.replacen(from, to, 1)).unwrap();
}

fn run(folder: &Path, probe: &str, from: &str, out: &str) -> Result<LearnSummary, Failure> {
    run_part(folder, probe, None, from, out)
}

fn run_part(folder: &Path, probe: &str, part: Option<u32>, from: &str, out: &str) -> Result<LearnSummary, Failure> {
    let options = learn::Options {
        job: folder.join("job.toml"),
        probe: Some(folder.join(probe)),
        part,
        from: folder.join(from),
        output: folder.join(out),
        ..learn::Options::default()
    };
    learn::run(&options, &mut |_| ())
}

/// Code and sentence of a refusal; nothing may have been written.
fn refused(folder: &Path, probe: &str, from: &str) -> (String, String) {
    let Err(Failure::Input(error)) = run(folder, probe, from, "second") else { panic!("not refused") };
    assert!(!folder.join("second").exists(), "{error}");
    (error.code().to_owned(), error.to_string())
}

#[test]
fn a_whole_folder_is_written_and_the_next_part_goes_on_from_it() {
    let (_guard, folder) = copy();
    let summary = run(&folder, "part-2.txt", "first", "second").unwrap();
    assert_eq!(summary.verdict.part, 2);
    assert_eq!(summary.verdict.promise.places, 5);
    let names = ["corrected.nc", "correction.csv", "points.csv", "correction.svg", "difference.txt", "probe-raw.txt"];
    for name in names {
        assert!(!fs::read(folder.join("second").join(name)).unwrap().is_empty(), "{name}");
    }
    let read = |name: &str| fs::read(folder.join("second").join(name)).unwrap();
    let told: serde_json::Value = serde_json::from_slice(&read("summary.json")).unwrap();
    assert_eq!(told["part"], 2);
    assert_eq!(told["rolled_back"], false);
    for key in ["max_error_before_mm", "measured_error_mm", "previous_error_mm", "promise", "holdout_residual_mm"] {
        assert!(!told[key].is_null(), "{key}");
    }
    let history = Source::new("history.json", read("history.json"));
    let history = truepath_correction::learning::History::read(&history).unwrap();
    assert_eq!((history.parts.len(), history.next_number()), (2, 3));
    // The corrected program is made from the original one.
    let text = String::from_utf8(read("corrected.nc")).unwrap();
    assert_eq!(text.matches("(TRUEPATH CORRECTED").count(), 1);
}

#[test]
fn a_part_may_be_touched_after_others_that_were_not_and_never_before_one_that_was() {
    let (_guard, folder) = copy();
    let Err(Failure::Input(error)) = run_part(&folder, "part-2.txt", Some(1), "first", "second") else {
        panic!("part 1 is known already")
    };
    assert_eq!(error.code(), "C001");
    assert!(error.to_string().contains("a number above 1"), "{error}");
    assert!(!folder.join("second").exists());
    let next = run(&folder, "part-2.txt", "first", "second").unwrap();
    let seventh = run_part(&folder, "part-2.txt", Some(7), "first", "seventh").unwrap();
    assert_eq!((next.verdict.part, seventh.verdict.part), (2, 7));
    // The more parts lie between two, the more the level of force may have moved, and the more is put down to that.
    let change = |summary: &LearnSummary| summary.verdict.force_change.abs();
    assert!(change(&seventh) > change(&next), "{} {}", seventh.verdict.force_change, next.verdict.force_change);
    let history = Source::new("history.json", fs::read(folder.join("seventh/history.json")).unwrap());
    assert_eq!(truepath_correction::learning::History::read(&history).unwrap().next_number(), 8);
}

#[test]
fn a_new_cutter_is_designed_for_said_and_remembered() {
    let (_guard, folder) = copy();
    edit(&folder.join("job.toml"), "[tool]\n", "[tool]\nparts_cut = 3\n");
    let learned = |from: &str, out: &str, new_cutter| {
        let options = learn::Options {
            job: folder.join("job.toml"),
            probe: Some(folder.join("part-2.txt")),
            new_cutter,
            from: folder.join(from),
            output: folder.join(out),
            ..learn::Options::default()
        };
        learn::run(&options, &mut |_| ()).unwrap()
    };
    let (plain, new) = (learned("first", "plain", false), learned("first", "new", true));
    let said = |summary: &LearnSummary| {
        summary.correct.warnings.iter().find(|said| said.contains("the next correction is for a new cutter")).cloned()
    };
    assert!(said(&plain).is_none());
    assert!(said(&new).is_some_and(|said| said.contains("than part 2, ± ")), "{:?}", new.correct.warnings);
    let expected = new.verdict.new_cutter.expect("what is expected of it");
    assert!(plain.verdict.new_cutter.is_none() && expected.sigma > 0.03 && expected.force_change.abs() < 0.1);
    // What the new cutter leaves open is part of what is promised; the part that was cut is judged as before.
    assert!(new.correct.max_sigma_mm > plain.correct.max_sigma_mm);
    assert_eq!(new.whole_contour_error_mm, plain.whole_contour_error_mm);
    let history = |name: &str| fs::read_to_string(folder.join(name).join("history.json")).unwrap();
    assert!(history("new").contains("\"cutter_from\": 3") || history("new").contains("\"cutter_from\":3"));
    assert!(!history("plain").contains("cutter_from"), "what is not said changes no file");
}

#[test]
fn a_folder_without_a_history_or_with_a_broken_one_is_refused() {
    let (_guard, folder) = copy();
    edit(&folder.join("first/history.json"), "\"version\":1", "\"version\":9");
    assert_eq!(refused(&folder, "part-2.txt", "first").0, "Q001");
    fs::write(folder.join("first/history.json"), "{").unwrap();
    assert_eq!(refused(&folder, "part-2.txt", "first").0, "Q001");
    fs::remove_file(folder.join("first/history.json")).unwrap();
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q001");
    assert!(text.contains("holds no history.json"), "{text}");
}

#[test]
fn a_history_of_another_program_or_cut_is_refused_with_both_values() {
    let (_guard, folder) = copy();
    edit(&folder.join("job.toml"), "teeth = 6", "teeth = 4");
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q002");
    assert!(text.contains("tool.teeth is 4") && text.contains('6'), "{text}");
    edit(&folder.join("job.toml"), "teeth = 4", "teeth = 6");
    edit(&folder.join("program.nc"), "X90. Y30.", "X91. Y30.");
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q002");
    assert!(text.contains("program.nc has the CRC-32"), "{text}");
}

#[test]
fn priors_may_change_from_part_to_part() {
    let (_guard, folder) = copy();
    edit(&folder.join("job.toml"), "stiffness_x_n_per_mm = 880", "stiffness_x_n_per_mm = 1000");
    assert!(run(&folder, "part-2.txt", "first", "second").is_ok());
}

#[test]
fn the_points_of_a_part_that_is_known_are_refused_whatever_the_file_is_called() {
    let (_guard, folder) = copy();
    let (code, text) = refused(&folder, "part-1.txt", "first");
    assert_eq!(code, "Q003");
    assert!(text.contains("that of part 1"), "{text}");
    // Another file of the same points.
    let text = fs::read_to_string(folder.join("part-1.txt")).unwrap();
    fs::write(folder.join("again.txt"), text.lines().rev().collect::<Vec<_>>().join("\n")).unwrap();
    let (code, text) = refused(&folder, "again.txt", "first");
    assert_eq!(code, "Q003");
    assert!(text.contains("12 of 12 points are those of part 1"), "{text}");
}

#[test]
fn learning_twice_from_one_part_is_refused() {
    let (_guard, folder) = copy();
    run(&folder, "part-2.txt", "first", "learned").unwrap();
    let (code, text) = refused(&folder, "part-2.txt", "learned");
    assert_eq!(code, "Q003");
    assert!(text.contains("that of part 2") && text.contains("the points of part 3"), "{text}");
}

#[test]
fn a_corrected_program_that_is_not_the_one_of_the_history_is_refused() {
    let (_guard, folder) = copy();
    edit(&folder.join("first/corrected.nc"), "M30", "M02");
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q004");
    assert!(text.contains("corrected.nc has the CRC-32"), "{text}");
    fs::remove_file(folder.join("first/corrected.nc")).unwrap();
    assert_eq!(refused(&folder, "part-2.txt", "first").0, "Q004");
}

#[test]
fn the_folder_learned_from_is_not_written_to() {
    let (_guard, folder) = copy();
    let Err(Failure::Input(error)) = run(&folder, "part-2.txt", "first", "./first") else { panic!("not refused") };
    assert_eq!(error.code(), "Q005");
}

#[test]
fn a_law_that_knows_no_second_part_is_refused() {
    let (_guard, folder) = copy();
    edit(&folder.join("job.toml"), "[correct]", "[correct]\nlaw = \"mirror\"");
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q006");
    assert!(text.contains("job.toml") || text.contains("mirror"), "{text}");
}

#[test]
fn the_points_of_a_part_cut_without_the_correction_are_refused_so_that_it_is_not_added_once_more() {
    let (_guard, folder) = copy();
    let (code, text) = refused(&folder, "uncorrected.txt", "first");
    assert_eq!(code, "Q007");
    assert!(text.contains("the points of part 2"), "{text}");
}

#[test]
fn a_history_that_was_changed_or_is_cut_short_is_refused() {
    let (_guard, folder) = copy();
    let file = folder.join("first/history.json");
    let whole = fs::read(&file).unwrap();
    let text = String::from_utf8(whole.clone()).unwrap();
    assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok());
    edit(&file, "\"number\":1", "\"number\":2");
    let (code, text) = refused(&folder, "part-2.txt", "first");
    assert_eq!(code, "Q001");
    assert!(text.contains("was changed, or is not whole"), "{text}");
    for length in [0, 1, 10, 22, whole.len() / 2, whole.len() - 1] {
        fs::write(&file, &whole[..length]).unwrap();
        assert_eq!(refused(&folder, "part-2.txt", "first").0, "Q001", "{length} bytes");
    }
    fs::write(&file, &whole).unwrap();
    assert!(run(&folder, "part-2.txt", "first", "second").is_ok());
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_worse_part_whose_points_contradict_each_other_takes_the_correction_back() {
    let (_guard, folder) = copy();
    run(&folder, "part-2.txt", "first", "learned").unwrap();
    let moved = |(k, line): (usize, &str)| {
        let mut numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        numbers[0] += if k % 2 == 0 { -0.15 } else { 0.15 };
        numbers[1] += if k % 3 == 0 { -0.12 } else { 0.12 };
        numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
    };
    let text = fs::read_to_string(folder.join("part-2.txt")).unwrap();
    fs::write(folder.join("part-3.txt"), text.lines().enumerate().map(moved).collect::<Vec<_>>().join("\n")).unwrap();
    let summary = run(&folder, "part-3.txt", "learned", "third").unwrap();
    assert!(summary.verdict.rolled_back, "{:?}", summary.verdict);
    let [used, before] =
        ["third", "first"].map(|name| fs::read_to_string(folder.join(name).join("corrected.nc")).unwrap());
    // All but the checksums of the probe file in the mark.
    let moves = |text: &str| text.lines().filter(|line| !line.starts_with('(')).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(moves(&used), moves(&before));
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_correction_is_not_replaced_by_one_made_from_the_part_that_was_cut_with_it() {
    let (_guard, folder) = copy();
    let again = |probe: &str, out: &str| {
        let options = correct::Options {
            job: folder.join("job.toml"),
            probe: Some(folder.join(probe)),
            output: folder.join(out),
            force: true,
            ..correct::Options::default()
        };
        correct::run(&options, &mut |_| ())
    };
    let before = fs::read(folder.join("first/corrected.nc")).unwrap();
    let refused = |probe: &str, out: &str| {
        let Err(Failure::Input(error)) = again(probe, out) else { panic!("not refused") };
        assert_eq!(error.code(), "Q008");
        error.to_string()
    };
    let text = refused("part-2.txt", "first");
    assert!(text.contains("mm (rms) from the wall of the correction"), "{text}");
    assert_eq!(fs::read(folder.join("first/corrected.nc")).unwrap(), before);
    // In a folder of its own nothing is known of it; it is only likely.
    let Err(Failure::Input(error)) = again("part-2.txt", "other") else { panic!("not refused") };
    let text = Failure::Input(error.clone()).render(Form::Plain).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(error.code() == "Q009" && text.contains("truepath learn --from"), "{text}");
    assert!(again("uncorrected.txt", "plain").unwrap().warnings.iter().all(|w| !w.starts_with("Q008")));
    // Known by name, once it was learned from.
    run(&folder, "part-2.txt", "first", "second").unwrap();
    let text = refused("part-2.txt", "second");
    assert!(text.contains("that of part 2"), "{text}");
    // The part that the program itself has cut may be corrected again, from the same points or from new ones.
    for probe in ["part-1.txt", "uncorrected.txt"] {
        again(probe, "first").unwrap();
    }
}
