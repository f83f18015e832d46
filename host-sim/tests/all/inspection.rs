//! `truepath inspect` judges a part: verdict by rule, limits from job or command line, the report page.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

const JOB: &str = include_str!("../../demo/corner/job.toml");
const PROGRAM: &str = include_str!("../../demo/corner/program.nc");

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Two touches on each leg with these errors in micrometres, ball of 6 mm.
fn touches(um: [i64; 4]) -> String {
    let [a, b, c, d] = um.map(|e| 27.0 + e as f64 / 1e3);
    format!(
        "{a:.6} 60 -10 0 0 0 0 0 0\n{b:.6} 50 -8 0 0 0 0 0 0\n61.1 {:.6} -10 0 0 0 0 0 0\n70 {:.6} -12 0 0 0 0 0 0\n",
        c - 4.0,
        d - 4.0
    )
}

/// A folder with the corner, a `[part]` and a probe file.
fn desk(part: &str, probe: &str) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(desk.path().join(name), text).expect("a file");
    write("program.nc", PROGRAM);
    write("job.toml", &format!("{JOB}\n{part}"));
    write("probe.txt", probe);
    desk
}

fn inspect(desk: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(["inspect", "job.toml", "--probe", "probe.txt"]).args(more).current_dir(desk);
    command.output().expect("the program runs")
}

/// Summary and contacts as `--json` prints them.
fn judged(part: &str, probe: &str, more: &[&str]) -> Value {
    let done = inspect(desk(part, probe).path(), &[&["--json"], more].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    serde_json::from_slice(&done.stdout).expect("JSON")
}

/// The data of a report page.
fn page(file: &Path) -> Value {
    let page = fs::read_to_string(file).expect("a page");
    let (_, rest) = page.split_once(r#"id="truepath-data">"#).expect("the place of the data");
    serde_json::from_str(rest.split_once("</script>").expect("its end").0).expect("JSON")
}

#[test]
fn the_verdict_follows_the_rule_and_a_failed_part_is_no_failed_command() {
    let guarded = "[part]\ntolerance_mm = 0.05\nuncertainty_mm = 0.004";
    let uneven = "[part]\nlower_mm = -0.0\nupper_mm = 0.02";
    for (part, um, state, points) in [
        (guarded, [46, -46, 0, 10], "pass", ["pass"; 4]),
        (guarded, [47, 0, 0, 0], "open", ["open", "pass", "pass", "pass"]),
        (guarded, [54, 0, 0, -54], "open", ["open", "pass", "pass", "open"]),
        (guarded, [47, 55, 0, 0], "fail", ["open", "fail", "pass", "pass"]),
        ("[part]\ntolerance_mm = 0.05", [50, -50, 0, 0], "pass", ["pass"; 4]),
        ("[part]\ntolerance_mm = 0.05", [50, -51, 0, 0], "fail", ["pass", "fail", "pass", "pass"]),
        (uneven, [0, 20, 1, 19], "pass", ["pass"; 4]),
        (uneven, [-1, 20, 1, 21], "fail", ["fail", "pass", "pass", "fail"]),
    ] {
        let found = judged(part, &touches(um), &[]);
        let verdict = &found["summary"]["verdict"];
        assert_eq!(verdict["state"], state, "{part} {um:?}: {verdict}");
        assert!(verdict["text"].as_str().unwrap().starts_with(state), "{verdict}");
        let each: Vec<&str> =
            found["contacts"].as_array().unwrap().iter().map(|c| c["verdict"].as_str().unwrap()).collect();
        assert_eq!(each, points, "{part} {um:?}");
    }
}

#[test]
fn without_a_tolerance_the_verdict_is_open_and_says_so() {
    let desk = desk("", &touches([80, 90, 90, 80]));
    let done = inspect(desk.path(), &[]);
    assert_eq!(done.status.code(), Some(0));
    let said = text(&done.stdout);
    assert!(said.contains("\nverdict: open: no tolerance given\nnext: truepath correct "), "{said}");
    assert!(!said.contains("pass"));
}

#[test]
fn the_command_line_stands_in_for_the_job_and_its_mistakes_are_its_own() {
    let part = "[part]\nserial = \"1\"\nlower_mm = -0.01\nupper_mm = 0.0";
    let probe = touches([80, 90, 90, 80]);
    let found = judged(part, &probe, &["--tolerance", "0.09", "--serial", "17", "--date", "2026-11-21"]);
    let summary = &found["summary"];
    assert_eq!(summary["verdict"]["state"], "pass");
    assert_eq!(summary["tolerance"], serde_json::json!({"lower_mm": -0.09, "upper_mm": 0.09, "from": "command line"}));
    assert_eq!((&summary["part"]["serial"], &summary["part"]["date"]), (&"17".into(), &"2026-11-21".into()));
    assert_eq!(judged(part, &probe, &[])["summary"]["tolerance"]["from"], "job");
    let desk = desk(part, &probe);
    let long = "x".repeat(101);
    for (flags, words) in [
        (["--tolerance", "0"], "--tolerance on the command line is \"0\"; expected half the width of the tolerance"),
        (["--tolerance", "-0.02"], "--tolerance on the command line is \"-0.02\""),
        (["--tolerance", "nan"], "--tolerance on the command line is \"nan\""),
        (["--tolerance", "11"], "0.0001 to 10 mm"),
        (["--tolerance", "1e999999999999"], "--tolerance on the command line"),
        (["--serial", ""], "--serial on the command line is \"\"; expected 1 to 100 characters on one line"),
        (["--serial", "a\nb"], "--serial on the command line"),
        (["--serial", &long], "1 to 100 characters"),
        (["--date", "\u{202e}1202"], "--date on the command line"),
        (
            ["--serial", "\u{200b}"],
            "--serial on the command line is \"\\u{200b}\"; expected 1 to 100 characters on one line, none",
        ),
        (["--serial", "1\u{2060}7"], "--serial on the command line is \"1\\u{2060}7\""),
        (["--serial", "1\u{200d}7"], "none of them invisible"),
    ] {
        let failed = inspect(desk.path(), &flags);
        assert_eq!(failed.status.code(), Some(2), "{flags:?}");
        let said = text(&failed.stderr);
        assert!(said.contains(words) && said.contains("C001"), "{flags:?}: {said}");
    }
}

#[test]
fn what_was_set_aside_or_never_touched_is_told_beside_the_verdict() {
    let probe = touches([1, 2, 3, 4]) + "500 500 -10 0 0 0 0 0 0\n";
    let found = judged("[part]\ntolerance_mm = 0.02\nreach_mm = 5", &probe, &[]);
    let summary = &found["summary"];
    assert_eq!((&summary["verdict"]["state"], &summary["points_rejected"]), (&"pass".into(), &1.into()));
    let said: Vec<&str> = summary["statements"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
    assert!(said[0].starts_with("Simple acceptance"));
    assert!(said.iter().any(|s| s.contains("4 measured places only")), "{said:?}");
    assert!(said.iter().any(|s| s.starts_with("1 reading was set aside and not judged")), "{said:?}");
    // A wall 1.5 mm off is no contact of the contour, yet nobody shall sign for it.
    let doubted = judged("[part]\ntolerance_mm = 0.02", &touches([1, 2, 3, 1500]), &[]);
    let verdict = &doubted["summary"]["verdict"];
    assert_eq!((&verdict["state"], &doubted["summary"]["points_rejected"]), (&"open".into(), &1.into()), "{verdict}");
    assert!(verdict["text"].as_str().unwrap().starts_with("open, though all 3 points lie within"), "{verdict}");
    let said = doubted["summary"]["statements"].to_string();
    assert!(said.contains("does not pass whatever its points say"), "{said}");
    // Touched at s = 20, 30, 74.954 and 83.854 of 103.854 mm.
    let coverage = &summary["coverage"];
    let stretches: Vec<[f64; 2]> = coverage["stretches"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| [&s["from_mm"], &s["to_mm"]].map(|v| v.as_f64().unwrap()))
        .collect();
    for (found, expected) in stretches.iter().zip([[0.0, 15.0], [35.0, 69.954], [88.854, 103.854]]) {
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-3), "{stretches:?}");
    }
    assert_eq!(stretches.len(), 3);
    assert!((coverage["farther_mm"].as_f64().unwrap() - 64.954).abs() < 2e-3);
}

/// What a page says, in millimetres: texts with lengths are there in both units.
fn in_millimetres(said: &Value) -> Value {
    match said {
        Value::Array(both) if both.len() == 2 && both.iter().all(Value::is_string) => both[0].clone(),
        Value::Array(all) => all.iter().map(in_millimetres).collect(),
        Value::Object(all) => all.iter().map(|(key, value)| (key.clone(), in_millimetres(value))).collect(),
        other => other.clone(),
    }
}

#[test]
fn the_page_holds_the_figures_of_the_table_and_the_summary() {
    let part = "[part]\nname = \"Bracket <b>\"\nserial = \"17\"\ntolerance_mm = 0.085\nuncertainty_mm = 0.002";
    let desk = desk(part, &(touches([80, 90, 86, 81]) + "500 500 -10 0 0 0 0 0 0\n"));
    let done = inspect(desk.path(), &["-o", "out"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let out = desk.path().join("out");
    let page = page(&out.join("report.html"));
    let summary: Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    let mut table = csv::Reader::from_path(out.join("points.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    assert_eq!(head.iter().next_back(), Some("verdict"));
    let points = page["points"].as_array().unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(points.len(), rows.len());
    for (point, row) in points.iter().zip(&rows) {
        let cell = |name: &str| row.get(head.iter().position(|h| h == name).unwrap()).unwrap();
        for name in ["line", "s_mm", "x_mm", "y_mm", "nx", "ny", "error_mm"] {
            let shown = point.get(name).and_then(Value::as_f64);
            assert_eq!(shown, cell(name).parse().ok(), "{name} of line {}", cell("line"));
        }
        for name in ["status", "verdict"] {
            assert_eq!(point.get(name).and_then(Value::as_str).unwrap_or(""), cell(name));
        }
        let reason = point.get("reason").map_or_else(|| Value::from(""), in_millimetres);
        assert_eq!(reason, cell("reason"));
    }
    let verdicts: Vec<Option<&str>> = points.iter().map(|p| p.get("verdict").and_then(Value::as_str)).collect();
    assert_eq!(verdicts, [Some("pass"), Some("fail"), Some("open"), Some("pass"), None]);
    for key in ["verdict", "statements", "coverage"] {
        assert_eq!(in_millimetres(&page[key]), summary[key], "{key}");
    }
    let crc = |at: usize| page["files"][at]["crc32"].as_str().unwrap();
    assert_eq!(
        [crc(0), crc(1), crc(2)],
        ["program_crc32", "probe_crc32", "job_crc32"].map(|k| summary[k].as_str().unwrap())
    );
    assert_eq!((&page["part"]["name"], &page["kind"]), (&"Bracket <b>".into(), &"inspect".into()));
    assert_eq!(page["limits"], serde_json::json!({"lower_mm": -0.085, "upper_mm": 0.085, "uncertainty_mm": 0.002}));
    let mean = page["results"].as_array().unwrap().iter().find(|r| r["name"] == "mean").unwrap();
    assert_eq!(mean["value"], summary["mean_error_mm"]);
}

#[test]
fn the_same_files_give_the_same_bytes_whatever_the_clock_says() {
    let desk = desk("[part]\ntolerance_mm = 0.1", &touches([80, 90, 90, 80]));
    for out in ["one", "two"] {
        assert_eq!(inspect(desk.path(), &["-o", out]).status.code(), Some(0));
    }
    for name in ["report.html", "summary.json", "points.csv"] {
        let [one, two] = ["one", "two"].map(|out| fs::read(desk.path().join(out).join(name)).unwrap());
        assert!(one == two, "{name} differs");
    }
}

#[test]
fn a_job_with_a_part_is_corrected_to_the_same_program_as_without_one() {
    let probe = touches([80, 90, 90, 80]);
    let corrected = |part: &str| {
        let desk = desk(part, &probe);
        let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
        command.args(["correct", "job.toml", "--probe", "probe.txt", "-o", "out"]).current_dir(desk.path());
        let done = command.output().expect("the program runs");
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        fs::read(desk.path().join("out/correction.csv")).unwrap()
    };
    assert_eq!(corrected(""), corrected("[part]\nname = \"bracket\"\ntolerance_mm = 0.1"));
}
