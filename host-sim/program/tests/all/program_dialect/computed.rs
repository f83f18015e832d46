//! Contour words that are parameters or expressions become numbers; the rest of their lines stays.

use truepath_core::gcode::Options;

use super::path::{blocks, corrected, edits, end, refusal, rewritten};

const COMPUTED: &str = "%\n#1=32\n#<y>=30\nG21 G90 M3 S1500\nG0 X[#1+2] Y80 Z10\nG1 Z-15 F400\nN10 G1 X[#1+2] Y[#<y>+5] (first wall)\nN20 G3 X39 Y#<y> R[10/2]\nN30 G1 X90 Y#<y> F[2*150]\nG0 Z100\nG0 X#1 Y#<y>\nM2\n%\n";

#[test]
fn computed_words_of_the_contour_become_numbers_and_the_rest_of_the_lines_is_kept() {
    let text = corrected(COMPUTED);
    let lines = |number: &str| text.lines().find(|l| l.starts_with(number)).expect("a line of the contour");
    for number in ["N10", "N20", "N30"] {
        let coordinates = lines(number).replace("F[2*150]", "");
        assert!(!coordinates.contains(['[', '#', 'R']), "{coordinates}");
    }
    assert!(lines("N10").ends_with("(first wall)") && lines("N30").contains("F[2*150]"), "{text}");
    assert_eq!(text.matches("F[2*150]").count(), 1, "{text}");
    for kept in ["#1=32\n", "#<y>=30\n", "\nG0 X#1 Y#<y>\n"] {
        assert!(text.contains(kept), "{kept} is missing in\n{text}");
    }
    assert_eq!(end(&text), end(COMPUTED));
}

#[test]
fn a_parameter_set_on_a_contour_line_is_set_once_and_keeps_its_value_for_what_follows() {
    let program = "#1=34\nG21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\n#1=[#1+5] G1 X#1 Y35\n#1=[#1+1] X90 Y35\nG0 Z9\nG0 X#1 Y0\nM2\n";
    let text = corrected(program);
    assert_eq!(text.matches("#1=[#1+5]").count(), 1, "{text}");
    assert_eq!(text.matches("#1=[#1+1]").count(), 1, "{text}");
    assert_eq!(end(&text), end(program));
    assert_eq!(end(program).x.map(|x| x.nm()), Some(40_000_000));
}

#[test]
fn computed_words_of_an_incremental_contour_become_numbers_too() {
    let program = "#1=45\nG21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nG91 G1 Y[-#1]\nG3 X5 Y-5 I5 J0\nG1 X[#1+6]\nG90 G0 Z9\nG0 X0 Y0\nM2\n";
    let text = corrected(program);
    let options = Options::default();
    let (before, after) = (blocks(program, options), blocks(&text, options));
    let ends = [before.last(), after.last()].map(|b| b.expect("a block").curve.end());
    let last = edits(program, options).pop().and_then(|e| e.samples.last().copied()).expect("a sample");
    assert!((ends[1].x.nm() - last[0]).abs() <= 150 && (ends[1].y.nm() - last[1]).abs() <= 150, "{text}");
    assert!(ends[0].distance(ends[1]).nm() > 50_000);
}

#[test]
fn a_computed_g_word_on_the_contour_is_refused() {
    let program = "#1=1\nG21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nG#1 X34 Y35\nG1 X90 Y35\nG0 Z9\nM2\n";
    let error = refusal(program);
    assert_eq!((error.code(), error.line_column()), ("P006", Some((5, 1))), "{error}");
}

#[test]
fn corners_the_control_would_cut_are_written_out_or_refused_at_their_line() {
    let program = "G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nG1 X34 Y30 ,R5\nG1 X90 Y30\nG0 Z9\nM2\n";
    let plain = edits(&program.replace(" ,R5", ""), Options::default());
    match rewritten(program, &plain, Options::default()) {
        Ok(done) => assert!(!String::from_utf8_lossy(&done.text).contains(",R")),
        Err(failure) => {
            let error = super::path::refusal_of(Err(failure));
            assert_eq!((error.code(), error.line_column()), ("G058", Some((4, 12))), "{error}");
        }
    }
}
