//! The command: what it prints and writes, its errors, and the example that goes with it.

use crate::workplace::{refused, truepath};
use std::path::Path;

const PAPER: [&str; 11] = [
    "bore",
    "--hole-radius",
    "90",
    "--cutter-radius",
    "10",
    "--teeth",
    "1",
    "--feed",
    "480",
    "--rpm",
    "95.4929658551372",
];

fn json(bytes: &[u8]) -> serde_json::Value {
    serde_json::from_slice(bytes).expect("JSON")
}

#[test]
fn the_paper_s_case_comes_out_of_the_command_line_with_all_digits() {
    let folder = tempfile::tempdir().expect("a folder");
    let asked = [&PAPER[..], &["--roots", "--phi", "57.2958", "--json"]].concat();
    let done = truepath(folder.path(), &asked);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let summary = json(&done.stdout);
    let number = |path: &str| summary.pointer(path).and_then(serde_json::Value::as_f64).expect("a number");
    assert_eq!(format!("{:.6}", number("/parameters/Pt_mm")), "0.307885");
    assert_eq!(format!("{:.6}", number("/waviness_mm")), "0.307885");
    let words = truepath(folder.path(), &PAPER);
    let words = String::from_utf8_lossy(&words.stdout).into_owned();
    assert!(words.contains("waviness     0.307885 mm"), "{words}");
    assert_eq!(format!("{:.4}", number("/roots/radius_mm")), "89.9275");
    assert_eq!((number("/roots/on_ray"), number("/roots/opposite")), (9.0, 7.0));
    assert!((number("/omega1_rad_per_s") - 0.1).abs() < 1e-15 && (number("/omega2_rad_per_s") - 10.0).abs() < 1e-12);
    let column = |name: &str| -> Vec<String> {
        let rows = summary["on_teeth"].as_array().expect("rows");
        rows.iter().map(|row| format!("{:.6}", row[name].as_f64().expect("a height"))).collect()
    };
    let conventional = column("conventional_mm");
    let reference =
        [(1, "0.307885"), (2, "0.076355"), (3, "0.033886"), (4, "0.019051"), (6, "0.008464"), (8, "0.004760")];
    for (teeth, printed) in reference {
        assert_eq!(conventional[teeth - 1], printed);
    }
    assert_eq!(column("climb_mm")[..3], ["0.427825", "0.105433", "0.046738"]);
    assert_eq!(format!("{:.2}", number("/teeth_exponent")), "-2.00");
    // Three ways to say it.
    for other in [&["--reverse"][..], &["--direction", "climb"], &["--rpm", "-95.4929658551372"]] {
        let mut asked = PAPER.to_vec();
        if other[0] == "--rpm" {
            asked.truncate(9);
        }
        let done = truepath(folder.path(), &[&asked[..], other, &["--json"]].concat());
        let height = json(&done.stdout)["parameters"]["Pt_mm"].as_f64().expect("a height");
        assert_eq!(format!("{height:.6}"), "0.427825", "{other:?}");
    }
}

#[test]
fn a_wanted_waviness_gives_a_feed_and_a_speed_that_leave_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let asked = [&PAPER[..], &["--wanted-waviness", "0.005", "--json"]].concat();
    let wanted = json(&truepath(folder.path(), &asked).stdout)["wanted"].clone();
    let text = |name: &str| wanted[name].as_f64().expect("a number").to_string();
    for (flag, value, feed) in
        [("--feed", text("feed_mm_per_min"), None), ("--rpm", text("rpm_at_given_feed"), Some("480"))]
    {
        let mut asked = PAPER.to_vec();
        asked.truncate(7);
        asked.extend(["--json", flag, &value]);
        asked.extend(if feed.is_some() { ["--feed", "480"] } else { ["--rpm", "95.4929658551372"] });
        let height = json(&truepath(folder.path(), &asked).stdout)["parameters"]["Pt_mm"].as_f64().expect("a height");
        assert!((height - 0.005).abs() < 1e-10, "{flag} {value}: {height}");
    }
}

#[test]
fn the_example_runs_and_writes_every_file() {
    let example = include_str!("../../../examples/bore/arguments.txt");
    let folder = tempfile::tempdir().expect("a folder");
    for line in example.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let done = truepath(folder.path(), &words);
        assert_eq!(done.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&done.stderr));
        let Some(out) = words.iter().position(|w| *w == "-o").map(|n| folder.path().join(words[n + 1])) else {
            continue;
        };
        let summary = json(&std::fs::read(out.join("summary.json")).expect("a summary"));
        assert!(summary["parameters"]["Pt_mm"].as_f64().is_some_and(|p| p > 0.0));
        for name in ["circular.svg", "profile.svg", "teeth.svg"] {
            let picture = std::fs::read_to_string(out.join(name)).expect("a picture");
            assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"), "{name}");
        }
        let mut profile = csv_rows(&out.join("profile.csv"));
        let cusps: Vec<f64> =
            profile.iter().filter(|r| r[5] == "cusp").map(|r| r[3].parse().expect("a number")).collect();
        let deepest = cusps.iter().copied().fold(0.0, f64::min);
        let height = summary["parameters"]["Pt_mm"].as_f64().expect("a height");
        assert!((deepest + height).abs() < 1e-9, "the highest crest is in the table: {deepest} {height}");
        profile.dedup_by(|a, b| a[0] == b[0]);
        assert!(profile.len() > 1000);
    }
}

fn csv_rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).expect("a table");
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn wrong_numbers_are_errors_with_a_code_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: [(&[&str], &str); 11] = [
        (&["--hole-radius", "NaN"], "B001"),
        (&["--hole-radius", "5"], "B001"),
        (&["--cutter-radius", "-3"], "B001"),
        (&["--teeth", "0"], "B001"),
        (&["--feed", "0"], "B001"),
        (&["--feed", "60000"], "B001"),
        (&["--rpm", "inf"], "B001"),
        (&["--rpm", "0.954929658551372"], "B002"),
        (&["--feed", "8000", "--rpm", "-95.493"], "B003"),
        (&["--feed", "0.01"], "B004"),
        (&["--teeth", "one"], "C001"),
    ];
    for (change, code) in cases {
        let mut asked: Vec<&str> = PAPER.to_vec();
        for pair in change.chunks(2) {
            let at = asked.iter().position(|w| *w == pair[0]).expect("an argument");
            asked[at + 1] = pair[1];
        }
        asked.extend(["-o", "out", "--json"]);
        let done = truepath(folder.path(), &asked);
        assert_eq!(done.status.code(), refused(code), "{change:?}");
        assert_eq!(json(&done.stderr)["error"]["code"], code, "{change:?}");
        assert!(!folder.path().join("out").exists(), "{change:?}");
    }
    let more: [(&[&str], &str); 9] = [
        (&["--laps", "0"], "B001"),
        (&["--laps", "1e9"], "B001"),
        (&["--lambda-c", "0"], "B001"),
        (&["--upr", "nan"], "B001"),
        (&["--runout", "7"], "B001"),
        (&["--helix", "90"], "B001"),
        (&["--depth", "-1"], "B001"),
        (&["--wanted-waviness", "20"], "B006"),
        (&["--phi", "3"], "C001"),
    ];
    for (extra, code) in more {
        let done = truepath(folder.path(), &[&PAPER[..], extra, &["--json"]].concat());
        assert_eq!(done.status.code(), refused(code), "{extra:?}");
        assert_eq!(json(&done.stderr)["error"]["code"], code, "{extra:?}");
    }
}
