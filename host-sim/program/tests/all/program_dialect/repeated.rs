//! A contour in a loop or a subprogram: edited in place when it is executed once, refused when more often.

use truepath_core::gcode::Options;
use truepath_program::BlockEdit;

use super::path::{corrected, edits, end, refusal, refusal_of, rewritten};

const WALLS: &str = "N10 G1 X34 Y35 F400\nN20 G3 X39 Y30 I5 J0\nN30 G1 X90 Y30\n";

/// A program whose walls stand between these lines.
fn program(before: &str, after: &str) -> String {
    format!("G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\n{before}{WALLS}{after}G0 Z9\nG0 X0 Y0\nM2\n")
}

/// The edits of one pass, as often as the lines are executed.
fn times(plain: &str, shift: u32, count: usize) -> Vec<BlockEdit> {
    let edits = edits(plain, Options::default()).into_iter().map(|e| BlockEdit { line: e.line + shift, ..e });
    let edits: Vec<_> = edits.collect();
    std::iter::repeat_n(edits, count).flatten().collect()
}

#[test]
fn a_contour_in_a_loop_or_a_branch_that_is_taken_once_is_corrected_in_place() {
    for (before, after) in [
        ("o1 repeat [1]\n", "o1 endrepeat\n"),
        ("o1 if [1 EQ 1]\n", "o1 endif\n"),
        ("#1=0\no1 while [#1 LT 1]\n#1=[#1+1]\n", "o1 endwhile\n"),
        ("o1 sub\n", "o1 endsub\no1 call\n"),
    ] {
        let program = program(before, after);
        let text = corrected(&program);
        for line in before.lines().chain(after.lines()) {
            assert!(text.lines().any(|l| l == line), "{line} is missing in\n{text}");
        }
        assert_eq!(end(&text), end(&program));
    }
}

#[test]
fn a_contour_in_a_subprogram_called_by_m98_is_corrected_in_place() {
    let program =
        format!("G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nM98 P100\nG0 Z9\nG0 X0 Y0\nM30\nO100\n{WALLS}M99\n");
    let text = corrected(&program);
    assert!(text.contains("\nM98 P100\n") && text.contains("\nO100\nN10 "), "{text}");
    assert_eq!(end(&text), end(&program));
}

#[test]
fn a_contour_that_is_executed_twice_is_refused_at_its_first_line() {
    let plain = program("", "");
    for (before, after, line) in [
        ("o1 repeat [2]\nG0 X34 Y80\n", "G0 X100 Y100\no1 endrepeat\n", 6),
        ("o1 sub\nG0 X34 Y80\n", "G0 X100 Y100\no1 endsub\no1 call\no1 call\n", 6),
    ] {
        for count in [1, 2] {
            let edits = times(&plain, 2, count);
            let error = refusal_of(rewritten(&program(before, after), &edits, Options::default()));
            assert_eq!((error.code(), error.line_column()), ("P004", Some((line, 1))), "{error}");
            assert!(error.to_string().contains("executed several times"), "{error}");
        }
    }
}

#[test]
fn a_move_to_the_contour_that_other_passes_use_too_is_refused() {
    // The contour runs once, but the subprogram that leads to its start is called twice.
    let program = "G21 G90 M3 S1500\no1 sub\nG0 X34 Y80 Z10\no1 endsub\no1 call\nG0 X0 Y0\no1 call\nG1 Z-15 F400\nG1 X34 Y35\nG1 X90 Y35\nG0 Z9\nG0 X0 Y0\nM2\n";
    let error = refusal(program);
    assert_eq!((error.code(), error.line_column()), ("P004", Some((3, 1))), "{error}");
}

#[test]
fn a_subprogram_in_another_file_is_refused_at_its_call() {
    for call in ["o<wall> call", "M98 P100"] {
        let plain = program("", "");
        let program = program("", "").replace(WALLS, &format!("{call}\n"));
        let edits = times(&plain, 0, 1);
        let error = refusal_of(rewritten(&program, &edits, Options::default()));
        assert_eq!((error.code(), error.line_column()), ("G144", Some((4, 1))), "{error}");
    }
}
