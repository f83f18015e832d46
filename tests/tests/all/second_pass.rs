//! A single part: half of the allowance is cut and probed, and the second half is corrected over the actual surface.

use std::fs;
use std::path::{Path, PathBuf};

use truepath::command::{correct, split};
use truepath_correction::second_pass;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_job::surface::Surface;
use truepath_plant as plant;
use truepath_plant::Milled;
use truepath_trial::virtual_mill;

const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../host-sim/demo");

fn demo(name: &str) -> std::path::PathBuf {
    Path::new(DEMO).join(name)
}

fn machine(name: &str) -> plant::Machine {
    toml::from_str(&fs::read_to_string(demo(name).join("plant.toml")).unwrap()).unwrap()
}

fn pass(job: &Path) -> Pass {
    Pass::read(JobFile::read(job).unwrap()).unwrap()
}

/// Mills what a program leaves of the actual surface of an earlier pass.
fn mill_over(pass: &Pass, machine: &plant::Machine, surface: Vec<[f64; 2]>, text: Option<&[u8]>) -> Milled {
    let pass = pass.clone().over(Surface::new(surface).unwrap()).unwrap();
    let centres = text.map(|text| virtual_mill::commanded(&pass, text).unwrap());
    virtual_mill::mill(&pass, machine, centres.as_deref()).unwrap()
}

fn halved(job: &Path, output: PathBuf) -> Result<split::Split, Failure> {
    split::run(&split::Options { job: job.to_owned(), output, ..split::Options::default() })
}

/// Largest error of a single part: split, milled, probed, corrected; and of the second pass without correction.
fn single_part(name: &str, places: &[f64], levels: &[f64]) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("split");
    let job = demo(name).join("job.toml");
    let written = halved(&job, out).unwrap();
    let (whole, first) = (pass(&job), pass(&written.job));
    let machine = machine(name);
    let milled = virtual_mill::mill(&first, &machine, None).unwrap();
    let ball = first.job.require_probe().unwrap().ball_diameter.nm() as f64 / 1e6;
    let probe = virtual_mill::probe(&first, &milled, places, levels, ball).unwrap();
    fs::write(folder.path().join("probe.txt"), &probe).unwrap();

    let result = folder.path().join("second");
    let options = correct::Options {
        job,
        probe: Some(folder.path().join("probe.txt")),
        output: result.clone(),
        route: Some(Route::Program),
        first_pass: Some(written.job),
        ..correct::Options::default()
    };
    correct::run(&options, &mut |_| ()).unwrap();
    assert!(fs::read_to_string(result.join("first-pass-surface.csv")).unwrap().starts_with("x_mm,y_mm\n"));
    let text = fs::read(result.join("corrected.nc")).unwrap();
    let surface = milled.surface(&[0.1, 0.5, 0.9]);
    let before = mill_over(&whole, &machine, surface.clone(), None).score().max_error_mm;
    (before, mill_over(&whole, &machine, surface, Some(&text)).score().max_error_mm)
}

#[test]
fn the_second_pass_of_a_single_part_comes_out_right() {
    let (before, after) = single_part("corner", &[15.0, 25.0, 35.0, 48.0, 65.0, 75.0, 85.0], &[0.5]);
    assert!(before > 0.1 && after < 0.006, "corner: {before:.4} -> {after:.4}");
    let (before, after) = single_part("corner-helix", &[15.0, 25.0, 35.0, 48.0, 65.0, 75.0, 85.0], &[0.1, 0.5, 0.9]);
    assert!(before > 0.2 && after < 0.03, "corner-helix: {before:.4} -> {after:.4}");
}

#[test]
fn the_first_pass_leaves_half_of_the_allowance_and_is_no_corrected_program() {
    let folder = tempfile::tempdir().unwrap();
    let job = demo("corner").join("job.toml");
    let written = halved(&job, folder.path().join("a")).unwrap();
    let text = fs::read_to_string(&written.program).unwrap();
    assert!(text.contains("(TRUEPATH FIRST PASS, LEAVES 1.5 MM)"), "{text}");
    assert!(text.contains("X35.5 Y35.") && text.contains("X39. Y31.5 I3.5 J0."), "{text}");
    let (first, whole) = (pass(&written.job), pass(&job));
    assert_eq!(first.core.setup.allowance.nm() * 2, whole.core.setup.allowance.nm());
    assert_eq!(first.blocks.len(), whole.blocks.len());
    for (a, b) in first.blocks.iter().zip(&whole.blocks) {
        let apart = a.curve.start().distance(b.curve.start()).nm();
        assert!((apart - 1_500_000).abs() < 1_100, "{apart}");
    }
}

#[test]
fn a_sharp_inside_corner_cannot_be_split_and_other_jobs_are_no_first_pass() {
    let folder = tempfile::tempdir().unwrap();
    let program = fs::read_to_string(demo("corner").join("program.nc")).unwrap();
    let sharp =
        program.replace("G01 X34. Y35. F250.", "G01 X34. Y30. F250.").replace("G03 X39. Y30. I5. J0 F150.\n", "");
    fs::write(folder.path().join("program.nc"), sharp).unwrap();
    let text = fs::read_to_string(demo("corner").join("job.toml")).unwrap();
    let job = folder.path().join("job.toml");
    fs::write(&job, &text).unwrap();
    let out = folder.path().join("out");
    let Err(Failure::Input(error)) = halved(&job, out.clone()) else { panic!("split across a sharp corner") };
    assert_eq!((error.code(), error.line_column().map(|(line, _)| line)), ("P020", Some(12)));
    assert!(!out.exists());

    let whole = pass(&demo("corner").join("job.toml"));
    let other =
        JobFile::parse(Source::new("other.toml", text.replace("teeth = 6", "teeth = 4").into_bytes()), &demo("corner"));
    let other = Pass::read(other.unwrap()).unwrap();
    let milled = virtual_mill::mill(&other, &machine("corner"), None).unwrap();
    let probe = virtual_mill::probe(&other, &milled, &[30.0, 75.0], &[0.5], 6.0).unwrap();
    let measurement = Measurement::read(&other, &Source::new("probe.txt", probe.into_bytes())).unwrap();
    let refused = second_pass::correct_second_pass(&whole, &other, &measurement, &[], &[Route::Program], &mut |_| ());
    let Err(Failure::Input(error)) = refused else { panic!("two machines' passes were taken for one part's") };
    assert_eq!(error.code(), "K003");
}
