//! Programs → canonical moves: order of execution, what is known of a position, and the bytes each step comes from.

use crate::interpret::interpret;
use truepath_rs274::{
    Axes, Canon, Coolant, DeviceMemory, GcodeErrorKind, Lines, Options, PathControl, Plane, Spindle, Token, ToolLength,
    Units, Words,
};
use truepath_units::{Offset, Position, Real};

const P18: &[u8] = include_bytes!("../data/p18-corner.nc");

fn steps(program: &[u8]) -> Vec<(u32, Canon)> {
    let mut steps = Vec::new();
    let run = interpret(Options::default(), program, &mut DeviceMemory::new().lend(), &mut |event| {
        steps.push((event.source.line, *event.canon));
        Ok(())
    });
    run.unwrap_or_else(|e| panic!("{e}"));
    steps
}

fn mm(x: i64) -> Option<Position> {
    Some(Position::from_nm(x * 1_000_000))
}

#[test]
fn the_paper_s_program_becomes_these_steps() {
    let at = |x, y, z| Axes { x, y, z };
    let below = |x, y| at(mm(x), mm(y), mm(-15));
    let expected = [
        (2, Canon::ProgramNumber(1)),
        (3, Canon::Units(Units::Millimetres)),
        (3, Canon::Plane(Plane::Xy)),
        (3, Canon::Compensation { wall: None, offset_number: None }),
        (3, Canon::ToolLength(ToolLength::Off)),
        (4, Canon::Reference { second: false, axes: [false, false, true], via: Axes::UNKNOWN }),
        (5, Canon::Reference { second: false, axes: [true, true, false], via: Axes::UNKNOWN }),
        (6, Canon::WorkOffset(1)),
    ];
    let found = steps(P18);
    assert_eq!(found[..8], expected);
    let Canon::Comment(remark) = found[8].1 else { panic!("the remark comes before the tool change") };
    assert_eq!(remark.of(P18), b"Freza d20");
    let expected = [
        (7, Canon::SelectTool(1)),
        (7, Canon::ChangeTool(Some(1))),
        (8, Canon::SpindleSpeed(Real::from_int(1500))),
        (8, Canon::Spindle(Spindle::Clockwise)),
        (9, Canon::Coolant(Coolant::Flood)),
        (9, Canon::Traverse { from: Axes::UNKNOWN, to: at(mm(34), mm(80), mm(10)) }),
        (10, Canon::FeedRate(Real::from_int(400))),
        (10, Canon::Feed { from: at(mm(34), mm(80), mm(10)), to: below(34, 80) }),
        (11, Canon::FeedRate(Real::from_int(250))),
        (11, Canon::Feed { from: below(34, 80), to: below(34, 35) }),
        (12, Canon::FeedRate(Real::from_int(150))),
    ];
    assert_eq!(found[9..20], expected);
    let (12, Canon::Arc { from, to, centre, counter_clockwise: true, .. }) = found[20] else { panic!("an arc") };
    assert_eq!((from, to), (below(34, 35), below(39, 30)));
    assert_eq!((Some(centre.x), Some(centre.y)), (mm(39), mm(35)));
    assert_eq!(found.last(), Some(&(19, Canon::End(30))));
}

#[test]
fn a_block_is_executed_in_the_order_of_the_standard_not_of_the_text() {
    let found = steps(b"G21 G90 G0 X0 Y0 Z0\nX1 M30 G1 M8 M3 T2 M6 S100 F200 (last) Z0");
    let kinds: Vec<_> = found.iter().filter(|(line, _)| *line == 2).map(|(_, c)| *c).collect();
    assert!(matches!(kinds[0], Canon::Comment(_)));
    assert_eq!(
        kinds[1..7],
        [
            Canon::FeedRate(Real::from_int(200)),
            Canon::SpindleSpeed(Real::from_int(100)),
            Canon::SelectTool(2),
            Canon::ChangeTool(Some(2)),
            Canon::Spindle(Spindle::Clockwise),
            Canon::Coolant(Coolant::Flood),
        ]
    );
    assert!(matches!(kinds[7], Canon::Feed { .. }));
    assert_eq!(kinds[8], Canon::End(30));
}

#[test]
fn whatever_moves_an_axis_elsewhere_makes_its_position_unknown() {
    for (block, unknown) in [
        ("G28", "XYZ"),
        ("G30 Z5", "Z"),
        ("G53 G0 X0", "X"),
        ("G43 H1", "Z"),
        ("G43.1 Z0.5", "Z"),
        ("G49", "Z"),
        ("G55", "XYZ"),
        ("T1 M6", "Z"),
        ("G54", ""),
        ("G53", ""),
        ("M0", ""),
    ] {
        let program = format!("G21 G90 G0 X1 Y2 Z3\n{block}\nG0 Y7\nM2");
        let Some((_, Canon::Traverse { from, .. })) =
            steps(program.as_bytes()).into_iter().find(|(line, c)| *line == 3 && matches!(c, Canon::Traverse { .. }))
        else {
            panic!("a traverse")
        };
        let known = |axis, value| if unknown.contains(axis) { None } else { value };
        assert_eq!(from, Axes { x: known('X', mm(1)), y: known('Y', mm(2)), z: known('Z', mm(3)) }, "{block}");
    }
}

#[test]
fn machine_coordinates_and_path_modes_are_passed_on() {
    let found = steps(b"G20 G64 P0.001 Q0.01\nG61\nG61.1\nG53 G0 Z-0.1\nG4 P2.5\nM2");
    let tolerance = |nm| Some(Offset::from_nm(nm));
    assert_eq!(
        found[1].1,
        Canon::PathControl(PathControl::Blend { tolerance: tolerance(25_400), merge: tolerance(254_000) })
    );
    assert_eq!(
        [found[2].1, found[3].1],
        [Canon::PathControl(PathControl::Exact), Canon::PathControl(PathControl::ExactStop)]
    );
    let to = Axes { z: Some(Position::from_nm(-2_540_000)), ..Axes::UNKNOWN };
    assert_eq!(found[4].1, Canon::MachineMove { to, rapid: true });
    assert!(matches!(found[5].1, Canon::Dwell(time) if time.exactly_times(1000) == Some(2500)));
}

#[test]
fn a_writer_can_change_one_word_and_keep_every_other_byte() {
    // The X of every cutting move becomes `X9`; everything else stays, byte for byte.
    let mut written = Vec::new();
    let mut kept = 0;
    interpret(Options::default(), P18, &mut DeviceMemory::new().lend(), &mut |event| {
        let Canon::Feed { from, to } = *event.canon else { return Ok(()) };
        let line = Lines::new(P18).nth(event.source.line as usize - 1).ok_or(GcodeErrorKind::NoMotion)?;
        assert_eq!(line.span(), event.source.block);
        for token in Words::new(line) {
            if let Ok(Token::Word(word)) = token
                && word.letter == b'X'
                && from.z == to.z
            {
                written.extend_from_slice(&P18[kept..word.span.start]);
                written.extend_from_slice(b"X9");
                kept = word.span.end();
            }
        }
        Ok(())
    })
    .expect("readable");
    written.extend_from_slice(&P18[kept..]);
    let text = String::from_utf8_lossy(P18);
    let expected = text.replace("G01 X34. Y35. F250.", "G01 X9 Y35. F250.").replace("G01 X90.", "G01 X9");
    assert_eq!(String::from_utf8_lossy(&written), expected);
}

#[test]
fn what_the_receiver_refuses_is_an_error_at_its_block() {
    let program = b"G21 G90\n  G0 X1 (one)\nM2";
    let refused =
        interpret(Options::default(), program, &mut DeviceMemory::new().lend(), &mut |event| match *event.canon {
            Canon::Traverse { .. } => Err(GcodeErrorKind::NoContour),
            _ => Ok(()),
        });
    let error = refused.expect_err("refused");
    assert_eq!((error.kind, error.line, error.column), (GcodeErrorKind::NoContour, 2, 3));
    assert_eq!(error.span().of(program), b"G0 X1 (one)");
}
