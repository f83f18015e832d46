//! The whole way without a machine: `simulate --touch` is the machine that is probed, `simulate --from` the one that cuts the
//! corrected program.

use serde_json::Value;

use crate::workplace::Workplace;

/// A folder with job, program and plant of the demonstration's pocket.
fn workplace() -> Workplace {
    Workplace::demo("pocket", &["job.toml", "program.nc", "plant.toml"])
}

const MILL: &str = "simulate job.toml --plant plant.toml";

#[test]
fn a_part_is_probed_and_its_correction_cut_before_there_is_metal() {
    let desk = workplace();
    let call = |arguments: &str| desk.call(arguments);
    let plan = call("probe job.toml --dialect linuxcnc -o verify.nc");
    let first = call(&format!("{MILL} --touch verify.nc -o first"));
    let log = desk.read("first/probe.txt");
    let points = plan["points"].as_array().expect("points").len();
    assert_eq!(log.lines().filter(|l| l.ends_with(",1.000000")).count(), points, "{log}");
    let job = desk.read("job.toml");
    desk.write("job.toml", job.replace("\"linuxcnc\"", "\"linuxcnc-log\""));
    call("correct job.toml --probe first/probe.txt -o out");
    let second = call(&format!("{MILL} --from out -o second"));
    let error = |summary: &Value| summary["judged"]["max_error_mm"].as_f64().expect("a wall");
    assert!(error(&second) < 0.2 * error(&first), "{} became {}", error(&first), error(&second));
}

#[test]
fn the_file_is_that_of_the_control_the_program_is_for() {
    let desk = workplace();
    let mut walls = Vec::new();
    for (dialect, format) in [("haas", "dprnt"), ("fanuc", "dprnt"), ("linuxcnc", "linuxcnc-log"), ("grbl", "grbl")] {
        desk.call(&format!("probe job.toml --dialect {dialect} --points 3 -o verify.nc --force"));
        desk.call(&format!("{MILL} --touch verify.nc -o first --force"));
        let found = desk.call(&format!("inspect job.toml --probe first/probe.txt --format {format}"));
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
    let desk = workplace();
    // G41 drawn to the outline of the part; who takes it for the path of the cutter's centre looks for the wall inside the part.
    let outline = "G21 G17 G90\nT2 M6\nS3200 M3\nG0 X-20 Y-20 Z10\nG1 Z-12 F300\nG41 D2 G1 X0 Y-10 F600\nG1 Y60\n\
                   G40 G1 X-20 Y70\nG0 Z10\nM30\n";
    desk.write("program.nc", outline);
    let job = desk.read("job.toml").replace("wall = \"right\"", "");
    desk.write("mistaken.toml", job.replace("[tool]", "[tool]\ncompensation = \"centre\""));
    desk.write("job.toml", job.replace("[tool]", "[tool]\ncompensation = \"radius\""));
    desk.call("probe mistaken.toml --dialect linuxcnc -o verify.nc");
    let said = desk.run(&format!("{MILL} --touch verify.nc -o first")).expect_err("a hit");
    assert!(said.contains("L004") && said.contains("verify.nc"), "{said}");
    assert!(!desk.path().join("first").exists(), "nothing is written");
}
