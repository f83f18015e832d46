//! Holes drilled right after or right before the contour stay where they were, or the program is refused.

use super::path::{corrected, end, plunges, refusal};

fn program(after: &str) -> String {
    format!(
        "G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nG1 X34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\n{after}G80\nG0 Z50\nG0 X0 Y0\nM2\n"
    )
}

#[test]
fn holes_drilled_right_after_the_contour_stay_at_their_places() {
    for after in [
        "G0 Z10\nG81 X100 Y50 Z-5 R2 F100\nX110\nY60\n",
        "G0 Z10\nG81 X100 Z-5 R2 F100\nX110\n",
        "G81 Y50 Z-5 R2 F100\nX110\n",
        "G0 Z10\nG98 G83 X100 Y50 Z-5 R2 Q1 F100\nX110\n",
        "G0 Z10\nG81 X100 Y50 Z-5 R2 F100 L3\n",
        "G0 Z10\nG91 G81 X10 Z-5 R-2 F100\nX10\nG90\n",
        "G0 Z10\nG91 G81 X10 Z-5 R-2 F100 L1\nX10\nG90\n",
        "G0 Z10\nG91 G81 Y10 Z-5 R-2 F100\nX10\nG90\n",
    ] {
        let program = program(after);
        let text = corrected(&program);
        let (before, holes) = (plunges(&program), plunges(&text));
        assert!(before.len() >= 3 && before.len() == holes.len(), "{text}");
        for (a, b) in before.iter().zip(&holes).skip(1) {
            assert!(a.distance(*b).nm() <= 150, "a hole has moved in\n{text}");
        }
        assert_eq!(end(&text), end(&program));
    }
}

#[test]
fn holes_that_would_move_with_the_end_of_the_contour_are_refused() {
    for (after, line, column) in [
        ("G0 Z10\nG91 G81 X10 Z-5 R-2 F100 L3\nG90\n", 8, "counted in steps"),
        ("G0 Z10\nG81 X90 Y30 Z-5 R2 F100\n", 8, "at the end of the contour"),
        ("G81 X90 Z-5 R2 F100\n", 7, "at the end of the contour"),
    ] {
        let error = refusal(&program(after));
        assert_eq!((error.code(), error.line_column()), ("P003", Some((line, 1))), "{error}");
        assert!(error.to_string().contains(column), "{error}");
    }
}

#[test]
fn holes_counted_in_steps_after_a_move_away_are_kept() {
    let program = program("G0 Z10\nG0 X100 Y40\nG91 G81 X10 Z-5 R-2 F100 L3\nG90\n");
    let text = corrected(&program);
    assert!(text.contains("\nG91 G81 X10 Z-5 R-2 F100 L3\n"), "{text}");
    assert_eq!(plunges(&program)[1..], plunges(&text)[1..]);
}

#[test]
fn a_contour_that_begins_at_a_hole_is_refused() {
    let program = "G21 G90 M3 S1500\nG0 X0 Y0 Z10\nG81 X34 Y80 Z-15 R2 F100\nG80\nG1 Z-15 F400\nG1 X34 Y35\nG1 X90 Y35\nG0 Z9\nM2\n";
    let error = refusal(program);
    assert_eq!((error.code(), error.line_column()), ("P002", Some((3, 1))), "{error}");
    assert!(error.to_string().contains("hole"), "{error}");
}
