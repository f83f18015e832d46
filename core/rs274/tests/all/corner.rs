//! `,R` and `,C`: where the arc or the chamfer begins and ends, what is refused, and that shifted, turned and mirrored
//! programs give shifted, turned and mirrored corners to the last bit. The table's places follow from
//! t = r · tan(θ/2), computed outside of this crate with 20 digits.

use crate::interpret::interpret;
use proptest::prelude::*;
use truepath_rs274::{Axes, Canon, CompensationBy, DeviceMemory, GcodeError, Options, Plane};
use truepath_units::{Offset, Position};

/// A line or an arc: its kind (`F`, `T`, `L` for G2, `R` for G3), line of the program, end, centre; nanometres.
type Move = (char, u32, [i64; 2], [i64; 2]);

fn run(program: &str, options: Options<'_>) -> Result<Vec<Move>, GcodeError> {
    let mut moves = Vec::new();
    let mut memory = DeviceMemory::new();
    interpret(options, program.as_bytes(), &mut memory.lend(), &mut |event| {
        let at = |to: Axes, [a, b]: [usize; 2]| [a, b].map(|axis| to.get(axis).map_or(i64::MAX, Position::nm));
        let turn = |counter_clockwise: bool| if counter_clockwise { 'R' } else { 'L' };
        let line = event.source.line;
        match *event.canon {
            Canon::Traverse { to, .. } => moves.push(('T', line, at(to, [0, 1]), [0, 0])),
            Canon::Feed { to, .. } => {
                let [first, second, _] = event.modal.plane.axes();
                moves.push(('F', line, at(to, [first, second]), [0, 0]));
            }
            Canon::Arc { to, centre, counter_clockwise, .. } => {
                moves.push((turn(counter_clockwise), line, at(to, [0, 1]), [centre.x.nm(), centre.y.nm()]));
            }
            Canon::PlaneArc { plane, to, centre, counter_clockwise, .. } => {
                let [first, second, _] = plane.axes();
                moves.push((turn(counter_clockwise), line, at(to, [first, second]), [centre.x.nm(), centre.y.nm()]));
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(moves)
}

/// The moves behind the first two lines, which set modes and the start.
fn moves(program: &str) -> Vec<Move> {
    let mut found = run(program, Options::default()).unwrap_or_else(|e| panic!("{program}: {e}"));
    found.retain(|m| m.1 > 2);
    found
}

fn refused(program: &str) -> (u32, u32, &'static str) {
    let error = run(program, Options::default()).expect_err(program);
    (error.line, error.column, error.kind.code())
}

const NONE: [i64; 2] = [0, 0];

#[test]
fn a_corner_becomes_an_arc_or_a_chamfer_that_belongs_to_its_block() {
    const START: &str = "G21 G90 G17 F100\nG0 X0 Y0 Z0\n";
    let cases: [(&str, &[Move]); 8] = [
        // A right angle to the left, and to the right.
        (
            "G1 X50 ,R10\nY40\nM30",
            &[
                ('F', 3, [40_000_000, 0], NONE),
                ('R', 3, [50_000_000, 10_000_000], [40_000_000, 10_000_000]),
                ('F', 4, [50_000_000, 40_000_000], NONE),
            ],
        ),
        (
            "G1 X50, R 10.\nY-40\nM30",
            &[
                ('F', 3, [40_000_000, 0], NONE),
                ('L', 3, [50_000_000, -10_000_000], [40_000_000, -10_000_000]),
                ('F', 4, [50_000_000, -40_000_000], NONE),
            ],
        ),
        (
            "G1 X50 ,C5\nY40\nM30",
            &[
                ('F', 3, [45_000_000, 0], NONE),
                ('F', 3, [50_000_000, 5_000_000], NONE),
                ('F', 4, [50_000_000, 40_000_000], NONE),
            ],
        ),
        // 45° and 135°.
        (
            "G1 X50 ,R10\nX90 Y40\nM30",
            &[
                ('F', 3, [45_857_864, 0], NONE),
                ('R', 3, [52_928_932, 2_928_932], [45_857_864, 10_000_000]),
                ('F', 4, [90_000_000, 40_000_000], NONE),
            ],
        ),
        (
            "G1 X50 ,R10\nX10 Y40\nM30",
            &[
                ('F', 3, [25_857_864, 0], NONE),
                ('R', 3, [32_928_932, 17_071_068], [25_857_864, 10_000_000]),
                ('F', 4, [10_000_000, 40_000_000], NONE),
            ],
        ),
        // A triangle of 3, 4, 5, incremental: what follows goes on from the corner as programmed.
        (
            "G91 G1 X30 Y40 ,R#1\nX40 Y-30\nX1\nM30",
            &[
                ('F', 3, [30_000_000, 40_000_000], NONE),
                ('F', 4, [70_000_000, 10_000_000], NONE),
                ('F', 5, [71_000_000, 10_000_000], NONE),
            ],
        ),
        (
            "#1=2.5\nG91 G1 X30 Y40 ,R[#1*2]\nX40 Y-30 F200 (slower)\nX1\nM30",
            &[
                ('F', 4, [27_000_000, 36_000_000], NONE),
                ('L', 4, [34_000_000, 37_000_000], [31_000_000, 33_000_000]),
                ('F', 5, [70_000_000, 10_000_000], NONE),
                ('F', 6, [71_000_000, 10_000_000], NONE),
            ],
        ),
        // Straight on there is nothing to cut off.
        (
            "G1 X20 ,R10\nX50 ,C3\nX60\nM30",
            &[('F', 3, [20_000_000, 0], NONE), ('F', 4, [50_000_000, 0], NONE), ('F', 5, [60_000_000, 0], NONE)],
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(moves(&format!("{START}{text}")), expected, "{text}");
    }
}

#[test]
fn corners_may_take_all_of_a_line() {
    // A slot with round ends: the short sides are arcs only.
    let found = moves("G21 G90 G17 F100\nG0 X20 Y0 Z0\nG1 X40 ,R10\nY20 ,R10\nX0 ,R10\nY0 ,R10\nX20\nM30");
    let mm = |v: [i64; 2]| v.map(|c| c * 1_000_000);
    assert_eq!(
        found,
        [
            ('F', 3, mm([30, 0]), NONE),
            ('R', 3, mm([40, 10]), mm([30, 10])),
            ('R', 4, mm([30, 20]), mm([30, 10])),
            ('F', 5, mm([10, 20]), NONE),
            ('R', 5, mm([0, 10]), mm([10, 10])),
            ('R', 6, mm([10, 0]), mm([10, 10])),
            ('F', 7, mm([20, 0]), NONE),
        ]
    );
}

#[test]
fn corners_are_cut_in_the_plane_in_force_and_in_the_unit_in_force() {
    let found = moves("G20 G90 G18 F10\nG0 X0 Y0 Z0\nG1 Z1 ,R.1\nX1\nM30");
    assert_eq!(
        found,
        [
            ('F', 3, [22_860_000, 0], NONE),
            ('R', 3, [25_400_000, 2_540_000], [22_860_000, 2_540_000]),
            ('F', 4, [25_400_000, 25_400_000], NONE),
        ]
    );
    assert_eq!(Plane::Zx.axes(), [2, 0, 1]);
}

#[test]
fn what_stands_between_the_two_lines_comes_behind_the_corner_in_its_order() {
    let program = "G21 G90 F100\nG0 X0 Y0 Z0\nG1 X50 ,R10\n(turn) F50\nS900 M3\nY40\nM30";
    let mut seen = String::new();
    let mut memory = DeviceMemory::new();
    interpret(Options::default(), program.as_bytes(), &mut memory.lend(), &mut |event| {
        if event.source.line > 2 {
            seen.push(match *event.canon {
                Canon::Feed { .. } => 'f',
                Canon::Arc { .. } => 'a',
                Canon::Comment(_) => 'c',
                Canon::FeedRate(_) => 'F',
                Canon::SpindleSpeed(_) => 'S',
                Canon::Spindle(_) => 'M',
                Canon::End(_) => 'E',
                _ => '?',
            });
            // The arc is cut at the feed of its block.
            if let Canon::Arc { .. } = *event.canon {
                assert_eq!(event.modal.feed.map(truepath_units::Real::bits), Some(100 << 32));
            }
        }
        Ok(())
    })
    .unwrap();
    assert_eq!(seen, "facFSMfE");
}

#[test]
fn the_cutter_compensates_the_corner_as_it_does_an_arc_of_the_program() {
    let head = "G21 G90 G17 F100\nG0 X0 Y-20 Z0\n";
    for side in ["G41", "G42"] {
        let word = format!("{head}{side} D1 G1 X10 Y0\nX50 ,R10\nY40\nG40 X80\nM30");
        let written = format!("{head}{side} D1 G1 X10 Y0\nX40\nG3 X50 Y10 R10\nG1 Y40\nG40 X80\nM30");
        let options = Options { compensation: CompensationBy::Radius(Offset::from_um(2_000)), ..Options::default() };
        let strip = |text: &str| run(text, options).unwrap().into_iter().map(|m| (m.0, m.2, m.3)).collect::<Vec<_>>();
        let found = strip(&word);
        assert_eq!(found, strip(&written), "{side}");
        assert!(found.iter().any(|m| m.0 == 'R'), "{side}: {found:?}");
    }
}

#[test]
fn corners_that_are_none_are_refused_at_their_word() {
    const START: &str = "G21 G90 G17 F100\nG0 X0 Y0 Z0\n";
    let cases = [
        ("G0 X5 ,R1\nY5\nM30", (3, 7, "G058")),
        ("G2 X10 Y0 I5 J0 ,R1\nG1 Y5\nM30", (3, 17, "G058")),
        ("G1 Z-1 ,R1\nX5\nM30", (3, 8, "G058")),
        ("G1 ,R1\nX5\nM30", (3, 4, "G058")),
        // Something else follows, or nothing.
        ("G1 X50 ,R10\nG0 Y40\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nG3 Y40 R20\nM30", (3, 8, "G058")),
        ("G1 X50 ,C10\nZ5\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\n", (3, 8, "G058")),
        ("G1 X50 ,R10\nG55\nY40\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nG19\nY40\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nG41 D1 Y40\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nG40\nY40\nM30", (3, 8, "G058")),
        ("G1 X50 ,R10\nG4 P1\nY40\nM30", (3, 8, "G058")),
        // The second line keeps only 9 mm for the last corner.
        ("G1 X50 ,R50.001\nY60\nM30", (3, 8, "G059")),
        ("G1 X50 ,R10\nY9.999\nM30", (3, 8, "G059")),
        ("G1 X50 ,R10\nY19 ,C9.001\nX0\nM30", (4, 5, "G059")),
        ("G1 X50 ,R1\nX0\nM30", (3, 8, "G110")),
        ("G1 X50 ,C1\nX0\nM30", (3, 8, "G110")),
        ("G1 X50 ,A45\nX0\nM30", (3, 8, "G111")),
        ("G1 X50 ,R1 ,C1\nY40\nM30", (3, 12, "G112")),
        ("G1 X50 Z1 ,R1\nY40\nM30", (3, 11, "G113")),
        ("G1 X50 ,R1\nY40 Z1\nM30", (3, 8, "G113")),
        ("G1 X50 A5 ,R1\nY40\nM30", (3, 8, "G113")),
        ("G1 X50 ,R1\nY40 A5\nM30", (3, 8, "G113")),
        ("G93 G1 X50 F1 ,R1\nY40 F1\nM30", (3, 15, "G114")),
        ("G1 X50 ,R1\n(1)\n(2)\n(3)\n(4)\n(5)\nY40\nM30", (8, 1, "G115")),
        ("G1 X50 ,R-1\nY40\nM30", (3, 8, "G028")),
        ("G1 X50 ,B1\nY40\nM30", (3, 8, "G001")),
    ];
    for (text, expected) in cases {
        assert_eq!(refused(&format!("{START}{text}")), expected, "{text}");
    }
}

#[test]
fn a_corner_of_zero_is_none() {
    let found = moves("G21 G90 G17 F100\nG0 X0 Y0 Z0\nG1 X50 ,R0\nG0 Y40\nM30");
    assert_eq!(found, [('F', 3, [50_000_000, 0], NONE), ('T', 4, [50_000_000, 40_000_000], NONE)]);
}

/// Nanometres as a program writes them in millimetres.
fn written(nm: i64) -> String {
    let sign = if nm < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", nm.unsigned_abs() / 1_000_000, nm.unsigned_abs() % 1_000_000)
}

fn cornered(points: [[i64; 2]; 3], letter: char, size: i64) -> Option<Vec<Move>> {
    let [a, b, c] = points.map(|[x, y]| format!("X{} Y{}", written(x), written(y)));
    let program = format!("G21 G90 G17 F100\nG0 {a} Z0\nG1 {b} ,{letter}{}\n{c}\nM30", written(size));
    run(&program, Options::default()).ok()
}

proptest! {
    #[test]
    fn shifted_turned_and_mirrored_lines_have_such_corners_to_the_last_bit(
        a in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
        b in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
        c in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
        size in 1i64..60_000_000, chamfer: bool,
        shift in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
    ) {
        let letter = if chamfer { 'C' } else { 'R' };
        let original = cornered([a, b, c], letter, size);
        let with = |f: &dyn Fn([i64; 2]) -> [i64; 2], mirrored: bool| original.clone().map(|moves| {
            moves.into_iter().map(|(kind, line, to, centre)| {
                let arc = matches!(kind, 'L' | 'R');
                let kind = match kind { 'L' if mirrored => 'R', 'R' if mirrored => 'L', kind => kind };
                (kind, line, f(to), if arc { f(centre) } else { NONE })
            }).collect::<Vec<_>>()
        });
        let shifted = |[x, y]: [i64; 2]| [x + shift[0], y + shift[1]];
        prop_assert_eq!(cornered([a, b, c].map(shifted), letter, size), with(&shifted, false));
        let turned = |[x, y]: [i64; 2]| [-y, x];
        prop_assert_eq!(cornered([a, b, c].map(turned), letter, size), with(&turned, false));
        let mirrored = |[x, y]: [i64; 2]| [-x, y];
        prop_assert_eq!(cornered([a, b, c].map(mirrored), letter, size), with(&mirrored, true));
    }

    #[test]
    fn an_arc_touches_both_lines_within_two_nanometres(
        a in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
        c in [-300_000_000i64..300_000_000, -300_000_000..300_000_000],
        size in 1_000i64..60_000_000,
    ) {
        let Some(moves) = cornered([a, [0, 0], c], 'R', size) else { return Ok(()) };
        let Some(arc) = moves.iter().find(|m| matches!(m.0, 'L' | 'R')) else { return Ok(()) };
        let centre = arc.3.map(|v| v as f64);
        for end in [a, c] {
            let end = end.map(|v| v as f64);
            let distance = (end[0] * centre[1] - end[1] * centre[0]).abs() / end[0].hypot(end[1]);
            prop_assert!((distance - size as f64).abs() < 2.0, "{} from the line, radius {}", distance, size);
        }
        let radius = (arc.2[0] as f64 - centre[0]).hypot(arc.2[1] as f64 - centre[1]);
        prop_assert!((radius - size as f64).abs() < 4.0, "{} to the end, radius {}", radius, size);
    }
}
