//! `simulate --program`: all passes of a program over one part.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

const JOB: &str = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.6\n[tool]\n\
    diameter_mm = 10.0\nteeth = 4\nhelix_deg = 38.0\n[cut]\naxial_depth_mm = 12.0\n[force]\nmaterial = \"al-6082-t6\"\n\
    [machine]\nstiffness_x_n_per_mm = 1900\nstiffness_y_n_per_mm = 1900\n[probe]\nball_diameter_mm = 4.0\n\
    format = \"linuxcnc-log\"\nz_reference = \"centre\"\n";

const PLANT: &str = "ktc_n_per_mm2 = 900\nkrc_n_per_mm2 = 250\nkte_n_per_mm = 12\nkre_n_per_mm = 14\n\
    size_exponent = 0.15\ncompliance_mm_per_n = [[0.0008, 0.00002], [0.00002, 0.0007]]\nbend = 0.15\nseed = 3\n";

/// A wall with an inside corner on the right, from (5, 60) to (60, 5): a pass `beside` mm off it.
fn pass(beside: f64, z: f64, feed: f64, back: bool) -> String {
    let (near, far) = (5.0 + beside, 8.0);
    if back {
        format!(
            "G0 X60 Y{:.3}\nG1 Z{z:.1} F300\nG1 Y{near:.3} F{feed}\nG1 X{far}\nG2 X{near:.3} Y{far} R{:.3}\nG1 Y60\nG1 X12\nG0 Z10\n",
            near + 4.0,
            far - near
        )
    } else {
        format!(
            "G0 X12 Y60\nG1 Z{z:.1} F300\nG1 X{near:.3} F{feed}\nG1 Y{far}\nG3 X{far} Y{near:.3} R{:.3}\nG1 X60\nG1 Y{:.3}\nG0 Z10\n",
            far - near,
            near + 4.0
        )
    }
}

fn program(passes: &[String]) -> String {
    format!("G21 G90 G17\nT2 M6\nS6000 M3\nG0 X12 Y60 Z10\n{}M30\n", passes.concat())
}

/// Job, plant, the program of one pass, and others.
fn desk(others: &[(&str, String)]) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let own = program(&[pass(0.0, -12.0, 700.0, false)]);
    for (name, text) in [("part.nc", own.as_str()), ("job.toml", JOB), ("plant.toml", PLANT)] {
        fs::write(desk.path().join(name), text).expect("written");
    }
    for (name, text) in others {
        fs::write(desk.path().join(name), text).expect("written");
    }
    desk
}

fn run(folder: &Path, arguments: &str) -> Result<Value, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    let done = command.arg("--json").args(arguments.split(' ')).current_dir(folder).output().expect("it runs");
    match done.status.code() {
        Some(0) => Ok(serde_json::from_slice(&done.stdout).expect("JSON")),
        _ => Err(String::from_utf8_lossy(&done.stderr).into_owned()),
    }
}

fn number(of: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(of, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?} in {of}"))
}

#[test]
fn every_pass_of_a_program_meets_what_the_one_before_left() {
    let desk = desk(&[
        ("same.nc", program(&[pass(0.0, -12.0, 700.0, false)])),
        ("spring.nc", program(&[pass(0.0, -12.0, 700.0, false), pass(0.0, -12.0, 700.0, false)])),
        ("planned.nc", program(&[pass(0.15, -12.0, 700.0, false), pass(0.0, -12.0, 500.0, true)])),
        ("levels.nc", program(&[pass(0.0, -6.0, 700.0, false), pass(0.0, -12.0, 700.0, false)])),
    ]);
    let call = |arguments: &str| run(desk.path(), arguments).unwrap_or_else(|said| panic!("{arguments}: {said}"));
    let mill = |name: &str| call(&format!("simulate job.toml --plant plant.toml --program {name}.nc -o {name}"));
    let plain = call("simulate job.toml --plant plant.toml -o plain");
    let [same, spring, planned, levels] = ["same", "spring", "planned", "levels"].map(mill);
    let profile = |summary: &Value| number(summary, &["surface", "profile_mm"]);
    let laps = |summary: &Value| summary["laps"].as_array().map_or(0, Vec::len);
    assert_eq!([&plain, &same, &spring, &planned, &levels].map(laps), [0, 1, 2, 2, 2]);
    // One pass: the same machine but for the cutter that yields to the stock of the instant.
    assert!((profile(&plain) / profile(&same) - 1.0).abs() < 0.05, "{} {}", profile(&plain), profile(&same));
    assert!(profile(&spring) < 0.6 * profile(&same), "{} {}", profile(&spring), profile(&same));
    assert!(profile(&planned) < 0.6 * profile(&same), "{} {}", profile(&planned), profile(&same));
    assert!(profile(&levels) < 0.95 * profile(&same), "{} {}", profile(&levels), profile(&same));

    let [first, last] = [0, 1].map(|k| &planned["laps"][k]);
    assert!((number(first, &["beside_mm"]) - 0.15).abs() < 0.03 && number(last, &["beside_mm"]).abs() < 1e-3);
    assert_eq!((first["climb"].as_bool(), last["climb"].as_bool()), (Some(true), Some(false)));
    assert_eq!(last["reversed"].as_bool(), Some(true));
    assert_eq!(number(last, &["greatest_feed_mm_per_min"]), 500.0);
    assert_eq!(number(&levels["laps"][0], &["tip_z_mm"]), -6.0);

    // The table of heights and the unrolled wall say what the whole says.
    let heights = planned["surface"]["heights"].as_array().expect("heights");
    assert_eq!(heights.len(), 30);
    let most = heights.iter().map(|h| number(h, &["profile_mm"])).fold(0.0, f64::max);
    assert_eq!(most, profile(&planned));
    let map = fs::read_to_string(desk.path().join("planned/wall-map.csv")).expect("a map");
    let mut lines = map.lines();
    assert_eq!(lines.next(), Some("s_mm,z_mm,error_mm,wall_mm"));
    let length = number(&planned, &["length_mm"]);
    let rows = lines.map(|line| line.split(',').map(|f| f.parse::<f64>().expect("a number")).collect::<Vec<_>>());
    let judged = rows.filter(|row| row[0] > 6.0 && row[0] < length - 6.0);
    let found = judged.map(|row| row[2].abs()).fold(0.0, f64::max);
    assert!((found - most).abs() < 0.002, "{found} {most}");
}

#[test]
fn the_ball_feels_the_wall_that_the_whole_process_left() {
    let process = [pass(0.15, -12.0, 700.0, false), pass(0.0, -6.0, 700.0, false), pass(0.0, -12.0, 700.0, true)];
    let desk = desk(&[("planned.nc", program(&process))]);
    let call = |arguments: &str| run(desk.path(), arguments).unwrap_or_else(|said| panic!("{arguments}: {said}"));
    let plan = call("probe job.toml --dialect linuxcnc -o verify.nc");
    call("simulate job.toml --plant plant.toml --program planned.nc --touch verify.nc -o done");
    call("inspect job.toml --probe done/probe.txt -o seen");
    let text = fs::read_to_string(desk.path().join("seen/points.csv")).expect("points");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{name} in {head:?}"));
    let (s, height, error) = (column("s_mm"), column("height"), column("error_mm"));
    let map = fs::read_to_string(desk.path().join("done/wall-map.csv")).expect("a map");
    let map: Vec<Vec<f64>> =
        map.lines().skip(1).map(|l| l.split(',').map(|f| f.parse().expect("a number")).collect()).collect();
    let mut felt = 0;
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let [s, height, error] = [s, height, error].map(|k| fields[k].parse::<f64>().expect("a number"));
        let z = 12.0 * (height - 1.0);
        let off = |row: &&Vec<f64>| (row[0] - s).abs() + 3.0 * (row[1] - z).abs();
        let nearest = map.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a row");
        assert!((nearest[2] - error).abs() < 0.004, "s {s} z {z}: {error}, in the map {nearest:?}");
        felt += 1;
    }
    assert_eq!(felt, plan["points"].as_array().expect("points").len());
}

#[test]
fn a_program_of_another_part_is_refused() {
    let elsewhere = program(&["G0 X100 Y60\nG1 Z-12 F300\nG1 Y20 F700\nG1 X140\nG0 Z10\n".to_owned()]);
    let other_tool = program(&[pass(0.0, -12.0, 700.0, false)]).replace("T2", "T3");
    let desk = desk(&[("elsewhere.nc", elsewhere), ("tool.nc", other_tool)]);
    for name in ["elsewhere", "tool"] {
        let arguments = format!("simulate job.toml --plant plant.toml --program {name}.nc -o {name}");
        let said = run(desk.path(), &arguments).expect_err("nothing to cut");
        assert!(said.contains("S008"), "{said}");
        assert!(!desk.path().join(name).join("summary.json").exists());
    }
    let both = "simulate job.toml --plant plant.toml --program tool.nc --from out -o both";
    assert!(run(desk.path(), both).is_err());
}
