//! What holds for every program: it turns, mirrors and shifts with its text, and no bytes make it panic.

use std::fmt::Write as _;

use proptest::prelude::*;
use truepath_rs274::{
    ContourOptions, DeviceMemory, Lines, Program, Token, Words, WrittenWord, find_contours, read_contour,
};
use truepath_units::geometry::{Block, Contour, Curve, Point, Shape, Vector};
use truepath_units::{Offset, Real};

/// A mirror in the y axis, then quarter turns counter-clockwise, then a shift.
#[derive(Clone, Copy, Debug)]
struct Placement {
    mirrored: bool,
    quarters: u8,
    shift: Vector,
}

impl Placement {
    fn turn(self, x: i64, y: i64) -> (i64, i64) {
        let x = if self.mirrored { -x } else { x };
        match self.quarters {
            0 => (x, y),
            1 => (-y, x),
            2 => (-x, -y),
            _ => (y, -x),
        }
    }
    fn point(self, p: Point) -> Point {
        let (x, y) = self.turn(p.x.nm(), p.y.nm());
        Point::from_nm(x, y) + self.shift
    }
    fn block(self, block: &Block) -> (Point, Point, i64, Option<Point>, i64, (i64, i64)) {
        let (centre, sweep) = match block.curve.shape() {
            Shape::Line => (None, Real::ZERO),
            Shape::Arc { centre, sweep } => (Some(self.point(centre)), if self.mirrored { -sweep } else { sweep }),
        };
        let heading = block.curve.start_heading();
        let (start, end) = (self.point(block.curve.start()), self.point(block.curve.end()));
        (start, end, block.s.nm(), centre, sweep.bits(), self.turn(heading.x.bits(), heading.y.bits()))
    }
}

/// One move from the end of the last, nanometres.
#[derive(Clone, Copy, Debug)]
enum Move {
    Line {
        by: (i64, i64),
    },
    /// `quarters` of a turn about a centre, the end `off` by less than the tolerance on it.
    Centre {
        to_centre: (i64, i64),
        quarters: u8,
        off: (i64, i64),
        ccw: bool,
    },
    Radius {
        by: (i64, i64),
        more: i64,
        long: bool,
        ccw: bool,
    },
}

const STILL: Placement = Placement { mirrored: false, quarters: 0, shift: Vector::ZERO };

fn any_move() -> impl Strategy<Value = Move> {
    let far = -90_000_000i64..90_000_000;
    let near = -9_000i64..9_000;
    prop_oneof![
        (far.clone(), far.clone()).prop_map(|by| Move::Line { by }),
        (
            (far.clone(), far.clone()),
            prop_oneof![Just(1u8), Just(2), Just(3), Just(4)],
            (near.clone(), near),
            any::<bool>()
        )
            .prop_map(|(to_centre, quarters, off, ccw)| Move::Centre { to_centre, quarters, off, ccw }),
        ((far.clone(), far), 1i64..90_000_000, any::<bool>(), any::<bool>())
            .prop_map(|(by, more, long, ccw)| Move::Radius { by, more, long, ccw }),
    ]
}

/// Nanometres as a number of millimetres.
fn number(nm: i64) -> String {
    let (sign, nm) = (if nm < 0 { "-" } else { "" }, nm.unsigned_abs());
    format!("{sign}{}.{:06}", nm / 1_000_000, nm % 1_000_000)
}

/// The moves as a program, placed elsewhere.
fn program(moves: &[Move], placed: Placement, incremental: bool) -> String {
    let start = placed.point(Point::from_nm(0, 0));
    let mut text = format!("G21 G90 G17\nG0 X{} Y{} Z-1\nF100\n", number(start.x.nm()), number(start.y.nm()));
    let mut at = (0i64, 0i64);
    if incremental {
        text.push_str("G91\n");
    }
    for m in moves {
        let (by, arc) = match *m {
            Move::Line { by } => (by, None),
            Move::Centre { to_centre: (i, j), quarters, off, ccw } => {
                let (x, y) = Placement { quarters, ..STILL }.turn(-i, -j);
                let off = if quarters == 4 { (0, 0) } else { off };
                let (x, y) = if quarters == 4 { (-i, -j) } else { (x, y) };
                let (i2, j2) = placed.turn(i, j);
                ((i + x + off.0, j + y + off.1), Some((ccw, format!("I{} J{}", number(i2), number(j2)))))
            }
            Move::Radius { by, more, long, ccw } => {
                let r = Vector::from_nm(by.0, by.1).length().nm() / 2 + more;
                (by, Some((ccw, format!("R{}", number(if long { -r } else { r })))))
            }
        };
        let code = match &arc {
            None => "G1",
            Some((ccw, _)) if *ccw != placed.mirrored => "G3",
            Some(_) => "G2",
        };
        let end = (at.0 + by.0, at.1 + by.1);
        let target = placed.point(Point::from_nm(end.0, end.1));
        let step = placed.turn(by.0, by.1);
        let (x, y) = if incremental { step } else { (target.x.nm(), target.y.nm()) };
        let centre = arc.map_or(String::new(), |(_, words)| words);
        writeln!(text, "{code} X{} Y{} {centre}", number(x), number(y)).expect("a string takes everything");
        at = end;
    }
    text + "M2\n"
}

fn blocks(program: &str) -> Result<Vec<Block>, String> {
    let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line of 1 nm");
    let mut buffer = vec![Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 64];
    let contour = read_contour(
        &Program::new(program.as_bytes()),
        &mut DeviceMemory::new().lend(),
        &mut buffer,
        &ContourOptions::default(),
    );
    let contour = contour.map_err(|e| format!("{e}\n{program}"))?;
    buffer.truncate(contour.blocks);
    Ok(buffer)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn a_shifted_turned_or_mirrored_program_gives_the_shifted_turned_or_mirrored_contour_bit_for_bit(
        moves in proptest::collection::vec(any_move(), 1..12),
        mirrored: bool, quarters in 0u8..4, sx: i32, sy: i32, incremental: bool,
    ) {
        let placed = Placement { mirrored, quarters, shift: Vector::from_nm(sx.into(), sy.into()) };
        let plain = blocks(&program(&moves, STILL, false)).map_err(TestCaseError::fail)?;
        let other = blocks(&program(&moves, placed, incremental)).map_err(TestCaseError::fail)?;
        let expected: Vec<_> = plain.iter().map(|b| placed.block(b)).collect();
        let found: Vec<_> = other.iter().map(|b| STILL.block(b)).collect();
        prop_assert_eq!(found, expected);
        prop_assert!(Contour::new(&plain).is_some());
    }
}

/// Reads the bytes in every way and checks what must hold of any outcome.
fn survives(program: &[u8]) -> Result<(), TestCaseError> {
    let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line of 1 nm");
    let mut buffer = [Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 8];
    match read_contour(&Program::new(program), &mut DeviceMemory::new().lend(), &mut buffer, &ContourOptions::default())
    {
        Ok(contour) => prop_assert!(Contour::new(&buffer[..contour.blocks]).is_some()),
        Err(error) => {
            prop_assert!(error.span().end() <= program.len() + 1);
            let sentence = error.kind.to_string();
            prop_assert!(!sentence.is_empty() && error.to_string().contains(error.kind.code()));
        }
    }
    let _ = find_contours(&Program::new(program), &mut DeviceMemory::new().lend(), &ContourOptions::default(), |c| {
        assert!(c.blocks > 0)
    });
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50_000))]

    #[test]
    fn random_bytes_never_panic(program in proptest::collection::vec(any::<u8>(), 0..64)) {
        survives(&program)?;
    }

    #[test]
    #[ignore = "slow: cargo xtask test --all"]
    fn random_blocks_never_panic(
        words in proptest::collection::vec((prop::sample::select(&b"GGGGXYZIJRFSTHDLPQMNO/%;(\nGXY"[..]),
            prop_oneof!["[0-3]", "(17|20|21|28|40|41|42|43|49|53|54|55|90|91|90.1|91.1|30)", "-?[0-9]{0,9}\\.?[0-9]{0,9}", "\n"]), 0..40),
    ) {
        let text: String = words.iter().flat_map(|(letter, number)| [char::from(*letter).to_string(), number.clone()]).collect();
        survives(text.as_bytes())?;
    }

    #[test]
    fn a_word_reads_back_from_its_own_span(number in "[+-]?[0-9]{1,9}(\\.[0-9]{0,9})?", lead in "[ \t]{0,3}") {
        let text = format!("{lead}X{number}");
        let line = Lines::new(text.as_bytes()).next().expect("one line");
        let Some(Ok(Token::Word(WrittenWord { letter: b'X', value: Some(value), span }))) = Words::new(line).next() else {
            return Err(TestCaseError::fail("no word"));
        };
        prop_assert_eq!(span.of(text.as_bytes()), text.trim().as_bytes());
        let written: f64 = number.parse().map_err(|_| TestCaseError::fail("a number"))?;
        prop_assert!((value.times(1_000_000) as f64 - written * 1e6).abs() <= 1.0 + written.abs() * 1e-9);
    }
}
