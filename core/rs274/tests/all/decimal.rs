//! Lengths without a point, as calculators and as controls set to least increments read them; M99 in a main program.

use crate::interpret::interpret;
use truepath_rs274::{Axes, Canon, DeviceMemory, Dialect, GcodeError, Options, PointlessLength, Warning};
use truepath_units::Position;

/// The end of the last move in nanometres, F in 2⁻³² and the warnings from `W014` on.
fn end(program: &str, options: Options<'_>) -> Result<([i64; 3], i64, Vec<Warning>), GcodeError> {
    let (mut at, mut feed) = (Axes::UNKNOWN, 0);
    let mut memory = DeviceMemory::new();
    let summary = interpret(options, program.as_bytes(), &mut memory.lend(), &mut |event| {
        if let Canon::Traverse { to, .. } | Canon::Feed { to, .. } | Canon::Arc { to, .. } = *event.canon {
            at = to;
        }
        feed = event.modal.feed.map_or(0, truepath_units::Real::bits);
        Ok(())
    })?;
    let warnings = summary.warnings.as_slice().iter().filter(|w| w.kind.code() > "W013").copied().collect();
    Ok(([at.x, at.y, at.z].map(|v| v.map_or(i64::MAX, Position::nm)), feed, warnings))
}

fn least(program: &str) -> [i64; 3] {
    end(program, Options { decimal: PointlessLength::Least, ..Options::default() }).unwrap().0
}

#[test]
fn least_increments_are_thousandths_of_a_millimetre_and_ten_thousandths_of_an_inch() {
    let cases = [
        ("G21 G90 G0 X10 Y10. Z-5", [10_000, 10_000_000, -5_000]),
        ("G20 G90 G0 X10 Y10. Z-.5", [25_400, 254_000_000, -12_700_000]),
        // Expressions and parameters are what they are.
        ("#1=10\nG21 G90 G0 X#1 Y[5*2] Z10", [10_000_000, 10_000_000, 10_000]),
        ("G21 G90 G0 X0 Y0 Z0\nG91 G1 X500 F100\nX500", [1_000_000, 0, 0]),
        ("G21 G90 G0 X0 Y0 Z0\nG2 X10000 Y10000 R10000 F100", [10_000_000, 10_000_000, 0]),
        ("G21 G90 G0 X0 Y0 Z0\nG2 X20000 Y0 I10000 J0 F100", [20_000_000, 0, 0]),
        ("G21 G90 G0 X0 Y0 Z0\nG1 X20000 F100 ,C1000\nY20000", [20_000_000, 20_000_000, 0]),
        ("G21 G90 G0 X1 0 Y1 0 . Z0", [10_000, 10_000_000, 0]),
    ];
    for (program, expected) in cases {
        assert_eq!(least(program), expected, "{program}");
    }
}

#[test]
fn a_feed_is_what_is_written_in_both_ways() {
    for decimal in [PointlessLength::Calculator, PointlessLength::Least] {
        let options = Options { decimal, dialect: Dialect::Haas, ..Options::default() };
        let (_, feed, _) = end("G21 G90 G0 X0. Y0. Z0.\nG1 X1. F150\nM30", options).unwrap();
        assert_eq!(feed, 150 << 32);
    }
}

#[test]
fn a_calculator_warns_once_where_the_control_may_be_set_otherwise() {
    let program = "G21 G90 G0 X0 Y0 Z5.\nG1 X10. F150\nG1 Y10 F150\nX20\nM30";
    for dialect in [Dialect::Fanuc, Dialect::Haas] {
        let (at, _, warnings) = end(program, Options { dialect, ..Options::default() }).unwrap();
        assert_eq!(at, [20_000_000, 10_000_000, 5_000_000]);
        let seen: Vec<_> = warnings.iter().map(|w| (w.kind.code(), w.line, w.column, w.times)).collect();
        assert_eq!(seen, [("W014", 3, 4, 2)]);
        let options = Options { dialect, decimal: PointlessLength::Least, ..Options::default() };
        assert_eq!(end(program, options).unwrap().2, []);
    }
    assert_eq!(end(program, Options::default()).unwrap().2, []);
}

#[test]
fn a_macro_takes_no_length_without_a_point_where_controls_differ() {
    let program = |word: &str| format!("G21 G90 G0 X0. Y0. Z0.\nG65 P9 {word}\nM30\nO9\nG0 X#24 Z#26\nM99\n");
    let options = Options { dialect: Dialect::Fanuc, decimal: PointlessLength::Least, ..Options::default() };
    let error = end(&program("X10. Z5"), options).unwrap_err();
    assert_eq!((error.line, error.column, error.kind.code()), (2, 13, "G116"));
    let (at, ..) = end(&program("X10. Z0 F200 S3"), options).unwrap();
    assert_eq!(at, [10_000_000, 0, 0]);
}

#[test]
fn a_main_program_that_repeats_itself_is_read_once_with_a_warning_of_its_own() {
    for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Linuxcnc] {
        let options = Options { dialect, ..Options::default() };
        let mut memory = DeviceMemory::new();
        let mut moves = 0;
        let program = b"%\nO1\nG21 G91 F100.\nG1 X1.\nM98 P2\nM99\nO2\nG1 X1.\nM99\n%\n";
        let summary =
            interpret(Options { start: Axes::ORIGIN, ..options }, program, &mut memory.lend(), &mut |event| {
                moves += i32::from(matches!(event.canon, Canon::Feed { .. }));
                Ok(())
            })
            .unwrap();
        let seen: Vec<_> = summary.warnings.as_slice().iter().map(|w| (w.kind.code(), w.line)).collect();
        assert_eq!((moves, seen, summary.end), (2, vec![("W015", 6)], None), "{dialect:?}");
    }
}
