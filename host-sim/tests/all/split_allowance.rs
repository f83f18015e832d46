//! The first of two passes: all that runs along the wall is moved, nothing else may reach what is left, and the job
//! written beside the program names the same cut.

use std::fs;
use std::path::{Path, PathBuf};

use truepath::command::{correct, split};
use truepath_ground::diagnostics::Failure;
use truepath_job::job::{JobFile, Route};
use truepath_job::pass::Pass;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/features");

fn pocket() -> (String, String) {
    let read = |name: &str| fs::read_to_string(Path::new(DATA).join(name)).unwrap();
    (read("pocket.nc"), read("pocket.toml"))
}

fn write(folder: &Path, program: &str, job: &str) -> PathBuf {
    fs::write(folder.join("pocket.nc"), program).unwrap();
    let path = folder.join("pocket.toml");
    fs::write(&path, job).unwrap();
    path
}

fn run(job: &Path, out: &Path) -> Result<split::Split, Failure> {
    split::run(&split::Options { job: job.to_owned(), output: out.to_owned(), ..split::Options::default() })
}

fn refusal(job: &Path, out: &Path) -> (String, Option<usize>) {
    let Err(Failure::Input(error)) = run(job, out) else { panic!("not refused") };
    assert!(!out.exists());
    (error.code().to_owned(), error.line_column().map(|(line, _)| line))
}

/// Largest |X| and |Y| named after the line that holds `from`.
fn reach(text: &str, from: &str) -> [f64; 2] {
    let words = || text[text.find(from).unwrap()..].split_whitespace();
    ['X', 'Y'].map(|axis| {
        let values = words().filter_map(|w| w.strip_prefix(axis)?.parse::<f64>().ok());
        values.map(f64::abs).fold(0.0, f64::max)
    })
}

fn near([x, y]: [f64; 2], [a, b]: [f64; 2]) -> bool {
    (x - a).abs() < 1.2e-3 && (y - b).abs() < 1.2e-3
}

#[test]
fn every_depth_and_the_spring_pass_leave_half_of_the_allowance() {
    let folder = tempfile::tempdir().unwrap();
    let (program, job) = pocket();
    let job = write(folder.path(), &program, &job);
    let written = run(&job, &folder.path().join("first")).unwrap();
    let text = fs::read_to_string(&written.program).unwrap();
    for part in ["(FINISHING Z-6)", "(FINISHING Z-12)", "(SPRING PASS)"] {
        let here = text.split_once(part).unwrap().1;
        let end = here[2..].find('(').map_or(here.len(), |at| at + 2);
        assert!(near(reach(&here[..end], "G0 X"), [24.75, 14.75]), "{part}: {}", &here[..end]);
    }
    assert_eq!(reach(&program, "(FINISHING Z-6)"), [25.0, 15.0]);
    let first = Pass::read(JobFile::read(&written.job).unwrap()).unwrap();
    assert_eq!(first.plan.as_ref().map(|plan| plan.passes.len()), Some(3));
    assert_eq!(first.core.setup.allowance.nm(), 250_000);
}

#[test]
fn a_spring_pass_in_the_other_direction_is_moved_to_the_same_side() {
    let folder = tempfile::tempdir().unwrap();
    let (program, job) = pocket();
    let (before, spring) = program.split_once("(SPRING PASS)").unwrap();
    let tail = &spring[spring.find("N520").unwrap()..];
    let back = "\nG0 X3 Y-12\nG1 Z-12 F120\nG2 X0 Y-15 I-3 J0 F480\nG1 X-22\nG2 X-25 Y-12 I0 J3\nG1 Y12\nG2 X-22 Y15 I3 J0\nG1 X22\nG2 X25 Y12 I0 J-3\nG1 Y-12\nG2 X22 Y-15 I-3 J0\nG1 X0\nG2 X-3 Y-12 I0 J3\n";
    let job = write(folder.path(), &format!("{before}(SPRING PASS){back}{tail}"), &job);
    let written = run(&job, &folder.path().join("first")).unwrap();
    let text = fs::read_to_string(&written.program).unwrap();
    assert!(near(reach(&text, "(SPRING PASS)"), [24.75, 14.75]), "{text}");
    assert!(near(reach(&text, "(FINISHING Z-6)"), [24.75, 14.75]), "{text}");
}

#[test]
fn an_overlap_at_the_end_of_a_closed_contour_keeps_its_distance_from_the_wall() {
    let folder = tempfile::tempdir().unwrap();
    let (program, job) = pocket();
    let overlapped = program.replace("X0\nN375 G3 X3 Y-12 I0 J3", "X0\nN372 G1 X8\nN375 G3 X11 Y-12 I0 J3");
    assert_ne!(program, overlapped);
    let job = write(folder.path(), &overlapped, &job);
    let written = run(&job, &folder.path().join("first")).unwrap();
    let text = fs::read_to_string(&written.program).unwrap();
    assert!(text.contains("N372 G1 X8. Y-14.75\n") || text.contains("N372 G1 X8.\n"), "{text}");
    assert!(near(reach(&text, "(FINISHING Z-6)"), [24.75, 14.75]), "{text}");
}

#[test]
fn another_cut_that_would_take_what_is_left_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let (program, job) = pocket();
    let narrow = format!("{job}\n[[feature]]\nid = \"pocket\"\nblocks = [315, 450]\n");
    let job = write(folder.path(), &program, &narrow);
    let line = program.lines().position(|l| l.starts_with("N465 ")).map(|at| at + 1);
    assert_eq!(refusal(&job, &folder.path().join("first")), ("P021".to_owned(), line));
}

#[test]
fn the_job_of_the_first_pass_names_the_same_cut_in_the_longer_program_with_half_of_its_own_allowance() {
    let folder = tempfile::tempdir().unwrap();
    let (numbered, job) = pocket();
    let plain: String = numbered
        .lines()
        .map(|l| if l.starts_with('N') { l.split_once(' ').unwrap().1 } else { l })
        .map(|l| format!("{l}\n"))
        .collect();
    for (name, program, blocks) in [("numbered", &numbered, [315, 520]), ("plain", &plain, [68, 109])] {
        let folder = folder.path().join(name);
        fs::create_dir(&folder).unwrap();
        let feature = format!("{job}\n[[feature]]\nid = \"pocket\"\nblocks = {blocks:?}\nallowance_mm = 0.4\n");
        let job = write(&folder, program, &feature);
        let written = run(&job, &folder.join("first")).unwrap();
        let whole = Pass::read(JobFile::read(&job).unwrap()).unwrap();
        let first = Pass::read(JobFile::read(&written.job).unwrap()).unwrap();
        assert_eq!(first.core.setup.allowance.nm(), 200_000, "{name}");
        let roles = |pass: &Pass| {
            pass.plan.iter().flat_map(|p| &p.passes).map(|p| (p.number, p.spring, p.z)).collect::<Vec<_>>()
        };
        assert_eq!(roles(&first), roles(&whole), "{name}");
        assert_eq!(roles(&whole).len(), 3, "{name}");
    }
}

/// Ball centres in front of the pocket's walls, 0.25 mm of stock and a deflection on them, at heights of one pass.
fn touches(z: [f64; 2]) -> String {
    let (x, y) = (30.0 - 0.25 - 0.06 - 2.0, 20.0 - 0.25 - 0.045 - 2.0);
    let row = |x: f64, y: f64, z: f64| format!("{x:.6} {y:.6} {z:.6} 0 0 0 0 0 0\n");
    let at = |z: f64| {
        let along = [-15.0, 0.0, 15.0].into_iter().flat_map(move |a| [row(a, -y, z), row(a, y, z)]);
        along.chain([-8.0, 8.0].into_iter().flat_map(move |a| [row(x, a, z), row(-x, a, z)])).collect::<String>()
    };
    z.map(at).concat()
}

fn second(job: &Path, first: &Path, probe: &Path, out: &Path) -> Result<Vec<u32>, Failure> {
    let options = correct::Options {
        job: job.to_owned(),
        probe: Some(probe.to_owned()),
        output: out.to_owned(),
        route: Some(Route::Program),
        first_pass: Some(first.to_owned()),
        ..correct::Options::default()
    };
    let summary = correct::run(&options, &mut |_| ())?;
    let spring = summary.warnings.iter().filter(|w| w.contains("spring pass")).count();
    let feature = summary.feature.expect("a feature");
    assert_eq!(spring, usize::from(feature.pass == 2), "{:?}", summary.warnings);
    Ok(feature.passes_corrected)
}

#[test]
fn the_second_pass_is_corrected_at_every_depth_whichever_of_them_was_probed() {
    let folder = tempfile::tempdir().unwrap();
    let (program, job) = pocket();
    let job = write(folder.path(), &program, &job);
    let written = run(&job, &folder.path().join("first")).unwrap();
    for (name, z) in [("upper", [-4.0, -2.5]), ("lower", [-9.0, -7.5])] {
        let probe = folder.path().join(name);
        fs::write(&probe, touches(z)).unwrap();
        let out = folder.path().join(format!("second-{name}"));
        assert_eq!(second(&job, &written.job, &probe, &out).unwrap(), [1, 2], "{name}");
        let text = fs::read_to_string(out.join("corrected.nc")).unwrap();
        let deeper = text.split_once("(FINISHING Z-12)").unwrap().1.split_once("(SPRING").unwrap().0.to_owned();
        let [x, y] = reach(&format!("G0{deeper}"), "G0");
        assert!(x > 25.03 && x < 25.25 && y > 15.02 && y < 15.25, "{name}: {x} {y}");
    }
}

#[test]
fn the_first_pass_of_another_program_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (program, text) = pocket();
    let job = write(folder.path(), &program, &text);
    let written = run(&job, &folder.path().join("first")).unwrap();
    write(folder.path(), &program.replace("F480", "F470"), &text);
    let probe = folder.path().join("probe.txt");
    fs::write(&probe, touches([-4.0, -2.5])).unwrap();
    let Err(Failure::Input(error)) = second(&job, &written.job, &probe, &folder.path().join("second")) else {
        panic!("two programs were taken for two passes of one part")
    };
    assert_eq!((error.code(), error.line_column().map(|(line, _)| line)), ("K003", Some(3)), "{error}");
}

#[test]
fn who_corrects_the_first_pass_itself_is_told_what_that_means() {
    let folder = tempfile::tempdir().unwrap();
    let (program, text) = pocket();
    let job = write(folder.path(), &program, &text);
    let written = run(&job, &folder.path().join("first")).unwrap();
    let probe = folder.path().join("probe.txt");
    fs::write(&probe, touches([-4.0, -2.5])).unwrap();
    let options = correct::Options {
        job: written.job,
        probe: Some(probe),
        output: folder.path().join("again"),
        route: Some(Route::Program),
        ..correct::Options::default()
    };
    let summary = correct::run(&options, &mut |_| ()).unwrap();
    assert!(summary.warnings.iter().any(|w| w.contains("that of a first pass")), "{:?}", summary.warnings);
}
