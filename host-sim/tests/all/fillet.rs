//! `fillet` as a user runs it: programs of several kinds, what is written beside them, and what is refused.

use std::fs;
use std::path::Path;

use truepath::command::fillet::{self, Options, Report};
use truepath_ground::diagnostics::Failure;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;

const JOB: &str = "version = 1\nprogram = \"part.nc\"   # mine\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 10\nteeth = 4\nhelix_deg = 30\n[cut]\naxial_depth_mm = 10\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\nstiffness_x_n_per_mm = 4000\nstiffness_y_n_per_mm = 4000\n";
/// The outline of a window in inches, compensated by the control.
const WINDOW: &str = "O0001\nG20 G90 G17 G40\nT1 M6\nS3000 M3\nG0 X1. Y0. Z1.\nG1 Z-.5 F20.\nG41 D1 X1. Y-1. F12.\nX2.\nY1.\nX-2.\nY-1.\nX1.\nG40 Y0.\nG0 Z1.\nM30\n";
const CONVERSATIONAL: &str = "0 BEGIN PGM P MM\n1 TOOL CALL 1 Z S3000\n2 L Z+50 R0 FMAX M3\n3 L X+0 Y+0 R0 FMAX\n4 L Z-10 R0 F300\n5 L X+10 Y-20 RL F200\n6 L X+40\n7 L Y+20\n8 L X-40\n9 L Y-20\n10 L X+10\n11 L X+0 Y+0 R0\n12 L Z+50 R0 FMAX M30\n13 END PGM P MM\n";

fn run(folder: &Path, file: &str, program: &str, job: &str, corner_radius: f64) -> Result<Report, Failure> {
    fs::write(folder.join(file), program).unwrap();
    fs::write(folder.join("job.toml"), job.replace("part.nc", file)).unwrap();
    fillet::run(&Options {
        job: folder.join("job.toml"),
        corner_radius,
        output: folder.join("out"),
        feature: None,
        force: true,
    })
}

fn refused(result: Result<Report, Failure>) -> (String, String) {
    match result {
        Err(Failure::Input(error)) => (error.code().to_owned(), error.found().to_owned()),
        other => panic!("{other:?}"),
    }
}

/// The pass of a written job, whose corners all are arcs of 2 mm.
fn all_round(report: &Report, corners: usize) -> Pass {
    assert_eq!(report.corners.len(), corners);
    let pass = Pass::read(JobFile::read(&report.job).unwrap()).unwrap();
    let arcs = pass.blocks.iter().filter_map(|b| b.curve.signed_radius()).map(|r| r.abs().nm());
    assert!(arcs.clone().count() >= corners && arcs.into_iter().all(|r| (r - 2_000_000).abs() < 3_000));
    for pair in pass.blocks.windows(2) {
        let kink = pair[0].curve.end_heading().cross(pair[1].curve.start_heading());
        assert!(truepath_ground::units::float(kink.abs()) < 0.01, "{pair:?}");
    }
    pass
}

#[test]
fn a_window_in_inches_that_the_control_compensates() {
    let folder = tempfile::tempdir().unwrap();
    let job = format!("dialect = \"haas\"\n{JOB}").replace("teeth = 4", "teeth = 4\ncompensation = \"radius\"");
    let report = run(folder.path(), "part.nc", WINDOW, &job, 7.0).unwrap();
    all_round(&report, 4);
    assert!(report.program.ends_with("part.filleted.nc"));
    // Comments of the job stay, and its original is as it was.
    assert!(fs::read_to_string(&report.job).unwrap().contains("# mine"));
    assert_eq!(fs::read_to_string(folder.path().join("part.nc")).unwrap(), WINDOW);
    let text = fs::read_to_string(&report.program).unwrap();
    assert!(text.contains("(TRUEPATH FILLETS, R 2 MM ON THE PATH)") && !text.contains("TRUEPATH CORRECTED"));
}

#[test]
fn a_conversational_program_keeps_its_kind() {
    let folder = tempfile::tempdir().unwrap();
    let job = format!("dialect = \"heidenhain\"\n{JOB}").replace("teeth = 4", "teeth = 4\ncompensation = \"radius\"");
    let report = run(folder.path(), "part.h", CONVERSATIONAL, &job, 7.0).unwrap();
    all_round(&report, 4);
    assert!(report.program.ends_with("part.filleted.h"));
}

#[test]
fn every_contour_of_a_program_gets_arcs() {
    let folder = tempfile::tempdir().unwrap();
    let square = |x: i32| format!("G0 X{x} Y0 Z5\nG1 Z-10 F200\nG1 X{} Y0 F300\nY-30\nX{x}\nY0\nG0 Z5\n", x + 40);
    let program = format!("G21 G90 G17\nT1 M6\nS3000 M3\n{}{}M30\n", square(0), square(100));
    let job = format!("wall = \"left\"\n{JOB}");
    let report = run(folder.path(), "part.nc", &program, &job, 7.0).unwrap();
    // Three of each square; it begins in the fourth, which is said.
    assert_eq!(report.corners.iter().filter(|c| c.radius_mm == 2.0).count(), 6, "{:?}", report.corners);
    assert!(report.warnings.iter().any(|text| text.contains("begins and ends in a sharp inside corner")));
    let lines: Vec<u32> = report.corners.iter().map(|c| c.line).collect();
    assert!(lines.iter().any(|line| *line < 11) && lines.iter().any(|line| *line > 11), "{lines:?}");
    assert_eq!(Pass::every(JobFile::read(&report.job).unwrap()).unwrap().len(), 2);
}

#[test]
fn files_beside_the_job_are_found_from_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let program =
        "G21 G90 G17\nT1 M6\nS3000 M3\nG0 X-60 Y-40 Z5\nG1 Z-10 F1000\nG1 X-60 Y0 F300\nX0\nY-40\nG0 Z5\nM2\n";
    fs::write(
        folder.path().join("stock.csv"),
        "x_mm,y_mm\n-64.5,-60\n-64.5,-2\n-62.6,2.6\n-58,4.5\n-2,4.5\n2.6,2.6\n4.5,-2\n4.5,-60\n",
    )
    .unwrap();
    let job = format!("wall = \"left\"\n{JOB}").replace("allowance_mm = 0.5", "surface = \"stock.csv\"");
    let report = run(folder.path(), "part.nc", program, &job, 7.0).unwrap();
    let text = fs::read_to_string(&report.job).unwrap();
    assert!(text.contains("surface = \"../stock.csv\""), "{text}");
    assert!(all_round(&report, 2).surface.is_some());
}

#[test]
fn a_radius_no_larger_than_the_cutters_and_a_round_contour_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let job = format!("dialect = \"haas\"\n{JOB}").replace("teeth = 4", "teeth = 4\ncompensation = \"radius\"");
    let (code, found) = refused(run(folder.path(), "part.nc", WINDOW, &job, 5.0));
    assert!(
        code == "C001" && found.contains("--corner-radius 0.1968504 in with a cutter of 0.1968504 in radius"),
        "{found}"
    );
    let circle = "G21 G90 G17\nT1 M6\nS3000 M3\nG0 X30 Y0 Z5\nG1 Z-10 F200\nG3 X30 Y0 I-30 J0 F300\nG0 Z5\nM30\n";
    let (code, found) = refused(run(folder.path(), "part.nc", circle, &format!("wall = \"right\"\n{JOB}"), 7.0));
    assert!(code == "P023" && found.starts_with("no sharp inside corner"), "{code} {found}");
    assert!(!folder.path().join("out").exists());
}
