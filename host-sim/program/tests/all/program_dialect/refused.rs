//! What cannot be written is refused with its code, its line and what to do instead.

use truepath_core::gcode::Options;

use super::path::{edits, refusal, refusal_of, rewritten};

fn program(mode: &str, walls: &str, after: &str) -> String {
    format!("G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\n{mode}{walls}{after}G0 Z9\nG0 X0 Y0\nM2\n")
}

const WALLS: &str = "G1 X34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\n";

#[test]
fn an_origin_set_at_the_displaced_end_is_refused() {
    for shift in ["G92 X0 Y0\n", "G52 X1\n", "G10 L20 P1 X0\n"] {
        let error = refusal(&program("", WALLS, shift));
        assert_eq!((error.code(), error.line_column()), ("P005", Some((7, 1))), "{shift}{error}");
    }
}

#[test]
fn an_origin_set_after_a_move_away_is_not() {
    for shift in ["G0 X100 Y100\nG92 X0 Y0\nG92.1\n", "G0 X100 Y100\nG52 X1\nG52 X0\n"] {
        let program = program("", WALLS, shift);
        rewritten(&program, &edits(&program, Options::default()), Options::default())
            .unwrap_or_else(|e| panic!("{shift}{e}"));
    }
}

#[test]
fn lines_that_cannot_be_divided_are_refused() {
    let timed = "G1 X34 Y35 F10\nG3 X39 Y30 I5 J0 F20\nG1 X90 Y30 F5\n";
    let error = refusal(&program("G93\n", timed, "G94 F400\n"));
    assert_eq!((error.code(), error.line_column()), ("P006", Some((5, 1))), "{error}");

    let turns = program("", "G1 X34 Y35\nG3 X34 Y35 I5 J0 P2\nG1 X34 Y20\n", "");
    let once = turns.replace(" P2", "");
    let error = refusal_of(rewritten(&turns, &edits(&once, Options::default()), Options::default()));
    assert_eq!((error.code(), error.line_column()), ("P006", Some((5, 1))), "{error}");
}

#[test]
fn every_refusal_says_what_to_do() {
    for (program, advice) in [
        (program("", WALLS, "G92 X0 Y0\n"), "put a G0 or G1 move"),
        (program("G93\n", &WALLS.replace('\n', " F9\n"), "G94 F400\n"), "G94"),
        (program("", WALLS, "G38.2 X100 Y40 F50\n"), "short G1 move"),
    ] {
        let error = refusal(&program);
        assert!(format!("{error:?}").contains(advice), "{error:?}");
    }
}

#[test]
fn a_program_that_computes_with_its_displaced_place_is_refused() {
    for after in ["#1=#5421\nG0 X100 Y100\nG0 Y#1\n", "G0 X100 Y[100 - #<_y>]\n"] {
        let error = refusal(&program("", WALLS, after));
        assert_eq!((error.code(), error.line_column()), ("P003", Some((7, 1))), "{error}");
    }
}
