//! The whole way without a machine: `simulate --touch` is the machine that is probed, `simulate --from` the one that cuts the
//! corrected program.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// A folder with job, program and plant of the demonstration's pocket.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo/pocket");
    for name in ["job.toml", "program.nc", "plant.toml"] {
        fs::copy(from.join(name), desk.path().join(name)).expect("a copy");
    }
    desk
}

/// Runs a command; its summary, or what it said.
fn truepath(folder: &Path, arguments: &[&str]) -> Result<Value, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    let done = command.arg("--json").args(arguments).current_dir(folder).output().expect("the program runs");
    match done.status.code() {
        Some(0) => Ok(serde_json::from_slice(&done.stdout).expect("JSON")),
        _ => Err(String::from_utf8_lossy(&done.stderr).into_owned()),
    }
}

const MILL: [&str; 4] = ["simulate", "job.toml", "--plant", "plant.toml"];

#[test]
fn a_part_is_probed_and_its_correction_cut_before_there_is_metal() {
    let desk = desk();
    let call = |arguments: &[&str]| truepath(desk.path(), arguments).unwrap_or_else(|said| panic!("{said}"));
    let plan = call(&["probe", "job.toml", "--dialect", "linuxcnc", "-o", "verify.nc"]);
    let first = call(&[&MILL[..], &["--touch", "verify.nc", "-o", "first"]].concat());
    let log = fs::read_to_string(desk.path().join("first/probe.txt")).expect("a probe file");
    let points = plan["points"].as_array().expect("points").len();
    assert_eq!(log.lines().filter(|l| l.ends_with(",1.000000")).count(), points, "{log}");
    let job = fs::read_to_string(desk.path().join("job.toml")).expect("a job");
    fs::write(desk.path().join("job.toml"), job.replace("\"linuxcnc\"", "\"linuxcnc-log\"")).expect("a job");
    call(&["correct", "job.toml", "--probe", "first/probe.txt", "-o", "out"]);
    let second = call(&[&MILL[..], &["--from", "out", "-o", "second"]].concat());
    let error = |summary: &Value| summary["judged"]["max_error_mm"].as_f64().expect("a wall");
    assert!(error(&second) < 0.2 * error(&first), "{} became {}", error(&first), error(&second));
}

#[test]
fn the_file_is_that_of_the_control_the_program_is_for() {
    let desk = desk();
    let mut walls = Vec::new();
    for (dialect, format) in [("haas", "dprnt"), ("fanuc", "dprnt"), ("linuxcnc", "linuxcnc-log"), ("grbl", "grbl")] {
        let call = |arguments: &[&str]| truepath(desk.path(), arguments).unwrap_or_else(|said| panic!("{said}"));
        call(&["probe", "job.toml", "--dialect", dialect, "--points", "3", "-o", "verify.nc", "--force"]);
        call(&[&MILL[..], &["--touch", "verify.nc", "-o", "first", "--force"]].concat());
        let found = call(&["inspect", "job.toml", "--probe", "first/probe.txt", "--format", format]);
        let errors = found["contacts"].as_array().expect("contacts").iter().filter_map(|c| c["error_mm"].as_f64());
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        walls.push(errors);
    }
    for wall in &walls[1..] {
        assert_eq!(wall.len(), 9);
        // The same wall; each reading has its noise of 2 µm.
        assert!(wall.iter().zip(&walls[0]).all(|(a, b)| (a - b).abs() < 0.012), "{walls:?}");
    }
}

#[test]
fn a_ball_that_comes_down_on_the_part_is_an_error() {
    let desk = desk();
    // G41 drawn to the outline of the part; who takes it for the path of the cutter's centre looks for the wall inside the part.
    let outline = "G21 G17 G90\nT2 M6\nS3200 M3\nG0 X-20 Y-20 Z10\nG1 Z-12 F300\nG41 D2 G1 X0 Y-10 F600\nG1 Y60\n\
                   G40 G1 X-20 Y70\nG0 Z10\nM30\n";
    fs::write(desk.path().join("program.nc"), outline).expect("a program");
    let job = fs::read_to_string(desk.path().join("job.toml")).expect("a job").replace("wall = \"right\"", "");
    fs::write(desk.path().join("mistaken.toml"), job.replace("[tool]", "[tool]\ncompensation = \"centre\""))
        .expect("a job");
    fs::write(desk.path().join("job.toml"), job.replace("[tool]", "[tool]\ncompensation = \"radius\"")).expect("a job");
    truepath(desk.path(), &["probe", "mistaken.toml", "--dialect", "linuxcnc", "-o", "verify.nc"]).expect("a program");
    let said =
        truepath(desk.path(), &[&MILL[..], &["--touch", "verify.nc", "-o", "first"]].concat()).expect_err("a hit");
    assert!(said.contains("L004") && said.contains("verify.nc"), "{said}");
    assert!(!desk.path().join("first").exists(), "nothing is written");
}
