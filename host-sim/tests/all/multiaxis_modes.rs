//! `truepath multiaxis`: codes that change what X, Y and Z are, and words that act at the end of a move.

use crate::multiaxis_support::{Feed, Machine, TRUNNION, feeds};
use crate::workplace::truepath;

/// Where a move of X, Y, Z and both rotary axes starts.
const START: &str = "G21 G90 G94 F500\nG0 X0 Y0 Z0 A0 C0\n";
/// One that errs by more than 5 µm.
const MOVE: &str = "G1 X40 Y1 C20\nM2\n";

/// The rewritten program, or code, line and column of the error.
fn run(machine: &Machine, program: &str, options: &[&str]) -> Result<String, (String, u64, u64)> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.toml"), machine.toml()).unwrap();
    std::fs::write(folder.path().join("in.nc"), program).unwrap();
    let fixed = ["multiaxis", "in.nc", "--machine", "m.toml", "--tolerance", "0.005", "-o", "out.nc", "--json"];
    let output = truepath(folder.path(), &[&fixed, options].concat());
    if output.status.success() {
        return Ok(std::fs::read_to_string(folder.path().join("out.nc")).unwrap());
    }
    let error: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    let number = |key: &str| error["error"][key].as_u64().unwrap();
    Err((error["error"]["code"].as_str().unwrap().to_owned(), number("line"), number("column")))
}

fn refused(program: &str, options: &[&str], line: u64) {
    let found = run(&TRUNNION, &format!("{START}{program}{MOVE}"), options);
    assert_eq!(found, Err(("A009".to_owned(), line, 1)), "{program}");
}

fn divided(program: &str, options: &[&str]) {
    let text = run(&TRUNNION, &format!("{START}{program}{MOVE}"), options).unwrap();
    assert!(text.contains("PIECES"), "{program}: {text}");
}

#[test]
fn behind_compensation_the_tool_stands_beside_the_programmed_place() {
    refused("G41 D1\nG1 X1\nG40\n", &[], 6);
    divided("G41 D1\nG1 X1\nG40\nG0 X0 Y0 Z0\n", &[]);
    divided("G40\n", &[]);
}

#[test]
fn words_of_a_tool_offset_are_no_place() {
    refused("G43.1 X0 Y0 Z30\n", &[], 4);
    divided("G43.1 Z30\nG0 X0 Y0 Z0\n", &[]);
}

#[test]
fn offsets_that_turn_with_the_table_are_not_those_of_the_machine_file() {
    let behind = "G0 X0 Y0 Z0 A0 C0\n";
    refused(&format!("G54.2 P1\n{behind}"), &["--dialect", "fanuc"], 5);
    refused(&format!("G254\n{behind}"), &["--dialect", "haas"], 5);
    divided(&format!("G254\nG255\n{behind}"), &["--dialect", "haas"]);
}

#[test]
fn a_row_behind_g54_is_another_offset() {
    let program = format!("G1 X1 C1\nG54 P2\nG0 X0 Y0 Z0 A0 C0\n{MOVE}");
    let found = run(&TRUNNION, &format!("{START}{program}"), &["--dialect", "fanuc"]);
    assert_eq!(found, Err(("A009".to_owned(), 6, 1)));
}

#[test]
fn g49_does_not_end_switched_kinematics_and_g43_ends_a_centre_point_code() {
    let behind = "G0 X0 Y0 Z0 A0 C0\nG1 X40 Y1 C20\nM2\n";
    let kept = run(&TRUNNION, &format!("M428\nG49\n{START}{behind}"), &[]).unwrap();
    assert!(!kept.contains("PIECES"), "{kept}");
    let ended = run(&TRUNNION, &format!("G43.4 H1\nG43 H1\n{START}{behind}"), &["--dialect", "fanuc"]).unwrap();
    assert!(ended.contains("PIECES"), "{ended}");
}

#[test]
fn g92_3_takes_up_what_g92_2_left_and_nothing_after_g92_1() {
    let ends = |text: &str| feeds(text).last().map(|m| m.to).unwrap();
    // X counts 100 less with G92 in force: the same joints need the same points.
    let plain = run(&TRUNNION, &format!("{START}{MOVE}"), &[]).unwrap();
    let taken_up = format!("{START}G92 X-100\nG92.2\nG92.3\nG0 X-100 Y0 Z0\nG1 X-60 Y1 C20\nM2\n");
    let taken_up = run(&TRUNNION, &taken_up, &[]).unwrap();
    assert_eq!(ends(&taken_up)[0], -60.0);
    assert_eq!(feeds(&taken_up).len(), feeds(&plain).len());
    for (named, wanted) in feeds(&taken_up).iter().zip(feeds(&plain)) {
        assert!((named.to[0] + 100.0 - wanted.to[0]).abs() < 1e-9, "{named:?}");
    }
    let gone = run(&TRUNNION, &format!("{START}G92 X-100\nG92.1\nG92.3\nG0 X0 Y0 Z0\n{MOVE}"), &[]).unwrap();
    assert!(feeds(&gone).iter().zip(feeds(&plain)).all(|(a, b)| a.to == b.to), "{gone}");
    // What an earlier program has left is not known.
    refused("G92.3\nG0 X0 Y0 Z0 A0 C0\n", &[], 5);
}

#[test]
fn the_spindle_stops_when_the_move_is_done() {
    let program = format!("{START}G1 X40 Y1 C20 M5 M9\nM2\n");
    let last = |text: &str| text.lines().rev().nth(1).unwrap().to_owned();
    let haas = run(&TRUNNION, &program, &["--dialect", "haas"]).unwrap();
    assert!(last(&haas).ends_with("C20.0 M5 M9") && haas.matches("M5").count() == 1, "{haas}");
    // LinuxCNC stops it before the move, and it stays so.
    let linuxcnc = run(&TRUNNION, &program, &[]).unwrap();
    assert!(!last(&linuxcnc).contains("M5") && linuxcnc.lines().nth(2).unwrap().ends_with("M5 M9"), "{linuxcnc}");
}

#[test]
fn a_standing_tip_gets_its_time_by_the_turn() {
    let program = "G21 G90 G93\nG0 X60 Y0 Z0 A0 C0\nG1 A30 C70 F3\nM2\n";
    for rule in ["equal", "midpoint", "longest"] {
        let text = run(&TRUNNION, program, &["--xyz", "tip", "--rule", rule]).unwrap();
        let pieces: Vec<Feed> = feeds(&text);
        assert!(pieces.len() > 4, "{text}");
        let minutes: f64 = pieces.iter().map(|piece| 1.0 / piece.feed).sum();
        assert!((minutes * 3.0 - 1.0).abs() < 1e-5, "{rule}: {minutes}");
        for piece in &pieces {
            let rate = (piece.to[5] - piece.from[5]) * piece.feed;
            assert!((rate / 210.0 - 1.0).abs() < 1e-3, "{rule}: {rate} degrees a minute in {piece:?}");
        }
    }
}

#[test]
fn led_along_the_great_circle_the_rounded_words_need_no_second_run() {
    let program = "G21 G90 G94 F500\nG0 X0 Y0 Z0 A20 C0\nG1 X30.5 Y-12.25 A41.3 C61.7\nG1 X-8 Y22 A17.9 C-33.1\nM2\n";
    let folder = tempfile::tempdir().unwrap();
    let guided = format!("orientation_tolerance_deg = 0.01\n{}", TRUNNION.toml());
    std::fs::write(folder.path().join("m.toml"), guided).unwrap();
    std::fs::write(folder.path().join("in.nc"), program).unwrap();
    for (from, to) in [("in.nc", "first.nc"), ("first.nc", "second.nc")] {
        let options = ["--machine", "m.toml", "--tolerance", "0.1", "--xyz", "tip", "-o", to];
        let output = truepath(folder.path(), &[&["multiaxis", from], &options[..]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let [first, second] =
        ["first.nc", "second.nc"].map(|name| std::fs::read_to_string(folder.path().join(name)).unwrap());
    assert!(feeds(&first).len() > 20, "{first}");
    assert_eq!(first, second);
}

#[test]
fn a_reference_run_of_rotary_axes_does_not_cut() {
    let program = format!("{START}G1 X1 F500\nG91 G28 Z0\nG28 A0 C0\nM30\n");
    assert_eq!(run(&TRUNNION, &program, &[]), Ok(program.clone()));
    refused("G1 X1 F500\nG28 A0\nG0 X0 Y0 Z0\n", &[], 6);
}

#[test]
fn written_out_a_move_of_a_subprogram_keeps_its_line() {
    let program = format!("{START}M98 P2\nM30\nO2\nG1 X40 Y1 C20\nM99\n");
    let text = run(&TRUNNION, &program, &["--dialect", "fanuc", "--unroll"]).unwrap();
    assert!(text.contains("(LINE 6 IN "), "{text}");
    let stays = run(&TRUNNION, &program, &["--dialect", "fanuc"]);
    assert_eq!(stays, Err(("A011".to_owned(), 6, 1)));
}

#[test]
fn an_increment_from_a_place_not_said_is_not_written_out() {
    let steered = "#1=1\nG90 G1 X[#1] F500\nM2\n";
    for before in ["G91 G0 A5\n", "G90 G0 A5 C5\nG55\nG91 G0 A5\n", "G90 G0 A5 C5\nG28 A0\nG91 G0 A5\n"] {
        let found = run(&TRUNNION, &format!("G21\nG0 X0 Y0 Z0\n{before}{steered}"), &["--unroll"]);
        let line = 2 + before.lines().count() as u64;
        assert_eq!(found.map_err(|e| (e.0, e.1)), Err(("A012".to_owned(), line)), "{before}");
    }
    let known = format!("G21\nG0 X0 Y0 Z0\nG90 G0 A5 C5\nG91 G0 A5\n{steered}");
    assert!(run(&TRUNNION, &known, &["--unroll"]).unwrap().contains("G0 A10.0"));
}
