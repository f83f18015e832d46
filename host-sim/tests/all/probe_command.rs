//! Probe files from the command line: flags that describe columns, the table of points, the raw file, a wild point.

use crate::workplace::{text, truepath};
use std::fs;
use std::path::Path;
use std::process::Output;

const JOB: &str = include_str!("../../demo/corner/job.toml");
const POCKET: &str = include_str!("../../../core/tests/data/pocket-probe.txt");

/// A folder with job and program of a demonstration, and a probe file.
fn desk(part: &str, probe: &[u8]) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo").join(part);
    for name in ["job.toml", "program.nc"] {
        fs::copy(from.join(name), desk.path().join(name)).expect("a copy");
    }
    fs::write(desk.path().join("probe.txt"), probe).expect("a file");
    desk
}

fn data(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("job/tests/data/probe").join(name)).expect("a probe file")
}

fn errors(output: &Output) -> Vec<f64> {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    json["contacts"].as_array().unwrap().iter().map(|c| c["error_mm"].as_f64().unwrap()).collect()
}

#[test]
fn flags_describe_the_columns_and_win_over_the_job() {
    let desk = desk("corner", &data("columns-machine-surface.csv"));
    let offset = "format = \"columns\"\nwork_offset_mm = [-372.5, -250.25, -412.0]\npoint = \"tip\"";
    fs::write(desk.path().join("job.toml"), JOB.replace("format = \"linuxcnc\"", offset)).unwrap();
    let flags =
        ["--cols", "z,x,y", "--sep", "semicolon", "--decimal", "comma", "--frame", "machine", "--point", "surface"];
    let arguments = [&["inspect", "job.toml", "--probe", "probe.txt", "--json"], &flags[..]].concat();
    let found = errors(&truepath(desk.path(), &arguments));
    for (found, expected) in found.iter().zip([0.08, 0.09, 0.099_393, 0.09, 0.08]) {
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
    }
    assert_eq!(found.len(), 5);
}

#[test]
fn a_format_on_the_command_line_stands_in_for_that_of_the_job() {
    let desk = desk("corner", &data("inspection.txt"));
    let arguments = ["inspect", "job.toml", "--probe", "probe.txt", "--json", "--format", "inspection"];
    assert_eq!(errors(&truepath(desk.path(), &arguments)).len(), 5);
}

#[test]
fn flags_that_contradict_each_other_are_refused() {
    let desk = desk("corner", &data("columns-centre.csv"));
    for (flags, words) in [
        (&["--cols", "x,y"][..], "x, y and z, each once"),
        (&["--cols", "x,y,z", "--format", "grbl"], "names another format"),
        (&["--sep", "comma", "--decimal", "comma"], "commas are to separate the columns"),
        (&["--frame", "machine"], "the work offset is not known"),
        (&["--frame", "table"], "possible values: work, machine"),
    ] {
        let failed = truepath(desk.path(), &[&["inspect", "job.toml", "--probe", "probe.txt"], flags].concat());
        assert_eq!(failed.status.code(), Some(2), "{flags:?}: {}", text(&failed.stderr));
        assert!(text(&failed.stderr).contains(words), "{flags:?}: {}", text(&failed.stderr));
    }
}

#[test]
fn inspect_keeps_the_raw_file_and_lists_every_reading() {
    let desk = desk("corner", &data("linuxcnc.txt"));
    let done = truepath(desk.path(), &["inspect", "job.toml", "--probe", "probe.txt", "-o", "out"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let out = desk.path().join("out");
    assert_eq!(fs::read(out.join("probe-raw.txt")).unwrap(), data("linuxcnc.txt"));
    let points = fs::read_to_string(out.join("points.csv")).unwrap();
    let rows: Vec<&str> = points.lines().collect();
    assert_eq!(rows[0], "line,status,s_mm,x_mm,y_mm,nx,ny,height,error_mm,reason");
    assert!(rows[1].starts_with("1,used,") && rows[1].ends_with(",0.5,0.08,"), "{points}");
    assert_eq!(rows[6], "6,aside,,80.0,19.0,,,,,-4.000 mm from the nominal wall");
    assert_eq!(rows.len(), 7);
    let again = truepath(desk.path(), &["inspect", "job.toml", "--probe", "probe.txt", "-o", "out"]);
    assert_eq!(again.status.code(), Some(1), "written over without --force");
}

/// Corrects a demonstration; the summary and the table of points.
fn corrected(part: &str, probe: &str) -> (serde_json::Value, String, String) {
    let desk = desk(part, probe.as_bytes());
    let done = truepath(desk.path(), &["correct", "job.toml", "--probe", "probe.txt", "-o", "out"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let read = |name: &str| fs::read_to_string(desk.path().join("out").join(name)).unwrap();
    assert_eq!(read("probe-raw.txt"), probe);
    (serde_json::from_str(&read("summary.json")).unwrap(), read("points.csv"), read("correction.csv"))
}

/// The largest difference of two tables of corrections, mm.
fn difference(a: &str, b: &str) -> f64 {
    let numbers = |text: &str| {
        let rows =
            text.lines().skip(1).map(|row| row.split(',').skip(3).take(2).map(|v| v.parse::<f64>().unwrap()).collect());
        rows.collect::<Vec<Vec<f64>>>()
    };
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn one_wild_point_neither_stops_the_run_nor_moves_the_correction() {
    let (_, _, clean) = corrected("pocket", POCKET);
    let mut lines: Vec<String> = POCKET.lines().map(str::to_owned).collect();
    // 0.4 mm of chip under the ball: still on the wall, and no deflection.
    assert!(lines[4].starts_with("32.938220 "));
    lines[4] = lines[4].replace("32.938220", "32.538220");
    let (summary, points, wild) = corrected("pocket", &(lines.join("\n") + "\n"));
    let moved = difference(&clean, &wild);
    assert!(moved < 0.001, "the correction moved by {moved} mm");
    assert_eq!(summary["points_outlying"], 1);
    assert!(points.lines().any(|row| row.starts_with("5,outlying,") && row.contains("the model expects")), "{points}");
    // The same place without the wild point.
    lines[4] = lines[4].replace("32.538220", "25.0");
    let (summary, points, aside) = corrected("pocket", &(lines.join("\n") + "\n"));
    assert_eq!(summary["points_rejected"], 1);
    assert!(points.lines().any(|row| row.starts_with("5,aside,")), "{points}");
    assert!(difference(&clean, &aside) < 0.002);
}

#[test]
fn one_wild_point_of_four_does_not_carry_the_correction_away() {
    let row = |x: f64, y: f64| format!("{x:.6} {y:.6} -10.0 0 0 0 0 0 0\n");
    let good = row(27.0882, 50.0) + &row(27.0882, 60.0) + &row(61.1, 23.0907) + &row(70.0, 23.0907);
    let (_, _, clean) = corrected("corner", &good);
    let wild = row(27.0882, 50.0) + &row(27.7882, 60.0) + &row(61.1, 23.0907) + &row(70.0, 23.0907);
    let (summary, _, moved) = corrected("corner", &wild);
    assert_eq!(summary["points_outlying"], 1);
    let moved = difference(&clean, &moved);
    assert!(moved < 0.001, "the correction moved by {moved} mm");
}
