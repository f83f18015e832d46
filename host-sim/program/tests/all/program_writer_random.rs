//! The corrected program of random contours in random spellings.

use proptest::prelude::*;
use truepath_core::gcode::{Canon, ContourOptions, HostMemory, Interpreter, Program, read_contour};
use truepath_core::geometry::{Block, Contour, Curve, Point};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Source;
use truepath_program::{BlockEdit, RewriteOptions, rewrite_program};

/// A line or an arc that goes on in the present heading or turns first.
#[derive(Clone, Debug)]
struct Stretch {
    corner_deg: f64,
    length_mm: f64,
    /// Radius of an arc, signed: positive turns left; 0 for a line.
    radius_mm: f64,
}

#[derive(Clone, Copy, Debug)]
struct Spelling {
    inches: bool,
    incremental: bool,
    absolute_centres: bool,
    radius_words: bool,
    tight: bool,
    numbered: bool,
    commented: bool,
}

fn stretch() -> impl Strategy<Value = Stretch> {
    let corner = prop_oneof![3 => Just(0.0), 1 => -60.0..60.0];
    let radius = prop_oneof![2 => Just(0.0f64), 1 => 4.0f64..60.0, 1 => -60.0f64..-4.0];
    (corner, 0.5f64..40.0, radius).prop_map(|(corner_deg, length_mm, radius_mm)| {
        // At most a third of a turn, so that R words stay exact.
        let length_mm = if radius_mm == 0.0 { length_mm } else { length_mm.min(2.0 * radius_mm.abs()) };
        Stretch { corner_deg, length_mm, radius_mm }
    })
}

fn spelling() -> impl Strategy<Value = Spelling> {
    any::<[bool; 7]>().prop_map(|[inches, incremental, absolute_centres, radius_words, tight, numbered, commented]| {
        Spelling { inches, incremental, absolute_centres, radius_words, tight, numbered, commented }
    })
}

/// The program of a contour that starts at (12, −7).
fn program(stretches: &[Stretch], s: Spelling) -> String {
    let unit = if s.inches { 25.4 } else { 1.0 };
    let round = |mm: f64| ((mm / unit) * 1e5).round() / 1e5;
    let gap = if s.tight { "" } else { " " };
    let (mut at, mut heading) = ([12.0f64, -7.0f64], 0.3f64);
    let mut text = format!(
        "%\n{} G90\nS2000 M3\nG0 X{} Y{} Z10\n",
        if s.inches { "G20" } else { "G21" },
        round(at[0]),
        round(at[1])
    );
    let start = [round(at[0]), round(at[1])];
    text += "G1 Z-5 F300\n";
    if s.absolute_centres {
        text += "G90.1\n";
    }
    if s.incremental {
        text += "G91\n";
    }
    // Positions as the reader of the program sees them, in program units.
    let mut read = start;
    for (index, stretch) in stretches.iter().enumerate() {
        if s.numbered {
            text += &format!("N{}{gap}", 10 * (index + 1));
        }
        heading += stretch.corner_deg.to_radians();
        let (to, centre) = if stretch.radius_mm == 0.0 {
            ([at[0] + stretch.length_mm * heading.cos(), at[1] + stretch.length_mm * heading.sin()], None)
        } else {
            let r = stretch.radius_mm;
            let c = [at[0] - r * heading.sin(), at[1] + r * heading.cos()];
            heading += stretch.length_mm / r;
            ([c[0] + r * heading.sin(), c[1] - r * heading.cos()], Some(c))
        };
        let word = [0, 1].map(|a| if s.incremental { round(to[a] - read[a] * unit) } else { round(to[a]) });
        let motion = match (centre, stretch.radius_mm > 0.0) {
            (None, _) => "G1",
            (_, true) => "G3",
            _ => "G2",
        };
        text += &format!("{motion}{gap}X{}{gap}Y{}", word[0], word[1]);
        if let Some(c) = centre {
            if s.radius_words {
                text += &format!("{gap}R{}", round(stretch.radius_mm.abs()));
            } else {
                let from = if s.absolute_centres { [0.0; 2] } else { [read[0] * unit, read[1] * unit] };
                text += &format!("{gap}I{}{gap}J{}", round(c[0] - from[0]), round(c[1] - from[1]));
            }
        }
        if s.commented {
            text += &format!("{gap}(WALL {index})");
        }
        text += "\n";
        read = [0, 1].map(|a| if s.incremental { read[a] + word[a] } else { word[a] });
        at = to;
    }
    text + "G0 Z20\nG0 X1 Y2\nM30\n%\n"
}

fn read(program: &[u8]) -> Vec<Block> {
    let line = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line");
    let mut buffer = vec![Block { curve: line, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 1024];
    let contour =
        read_contour(&Program::new(program), &mut HostMemory::new().lend(), &mut buffer, &ContourOptions::default())
            .expect("one contour");
    buffer.truncate(contour.blocks);
    buffer
}

fn edits(blocks: &[Block], wave: [f64; 4]) -> Vec<BlockEdit> {
    let contour = Contour::new(blocks).expect("a contour");
    let real = |r: Real| r.bits() as f64 / 4_294_967_296.0;
    let mut edits: Vec<BlockEdit> = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let length = block.curve.length().nm();
        let count = (length / 100_000).max(2);
        let mut samples: Vec<[i64; 2]> = (0..=count)
            .map(|k| {
                let s = block.s + Offset::from_nm(length * k / count);
                let place = contour.at(s, index).expect("a place");
                let along = s.nm() as f64 * 1e-6;
                let size = wave[0] + wave[1] * (along * wave[2]).sin();
                let left = place.heading.left();
                let move_nm =
                    |direction: Real, constant: f64| ((size * real(direction) + constant) * 1e6).round() as i64;
                [place.point.x.nm() + move_nm(left.x, wave[3]), place.point.y.nm() + move_nm(left.y, -wave[3])]
            })
            .collect();
        if let Some(before) = edits.last() {
            samples[0] = *before.samples.last().expect("a sample");
        }
        edits.push(BlockEdit::new(block.line, samples));
    }
    edits
}

fn last_place(program: &[u8]) -> Point {
    let mut at = None;
    let read = Interpreter::new(Default::default()).run(program, &mut HostMemory::new().lend(), &mut |event| {
        if let Canon::Traverse { to, .. } = *event.canon {
            at = to.point();
        }
        Ok(())
    });
    read.expect("a readable program");
    at.expect("a traverse")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn any_contour_is_written_within_the_tolerance_and_nothing_else_moves(
        stretches in prop::collection::vec(stretch(), 1..7),
        spelling in spelling(),
        wave in (-0.3f64..0.3, 0.0f64..0.1, 0.05f64..0.6, -0.05f64..0.05),
    ) {
        let original = program(&stretches, spelling).into_bytes();
        let blocks = read(&original);
        let edits = edits(&blocks, wave.into());
        let source = Source::new("random.nc", original.clone());
        let options = RewriteOptions { tolerance: Offset::from_um(1), ..RewriteOptions::default() };
        let rewritten = rewrite_program(&source, &edits, &options).expect("a corrected program");
        let text = String::from_utf8_lossy(&rewritten.text);
        prop_assert!(rewritten.difference.largest_deviation_mm <= 0.001, "{} mm\n{}", rewritten.difference.largest_deviation_mm, text);

        let after = read(&rewritten.text);
        prop_assert!(Contour::new(&after).is_some());
        let ends = [
            (after[0].curve.start(), edits[0].samples[0]),
            (after[after.len() - 1].curve.end(), *edits[edits.len() - 1].samples.last().expect("a sample")),
        ];
        for (written, sample) in ends {
            let off = written.distance(Point::from_nm(sample[0], sample[1])).nm();
            prop_assert!(off <= 200, "an end is {off} nm off\n{text}");
        }
        // The interpreter accepts the arcs by its own rule; they are far better than that.
        for block in &after {
            if let truepath_core::geometry::Shape::Arc { centre, .. } = block.curve.shape() {
                let ends = block.curve.start().distance(centre) - block.curve.end().distance(centre);
                prop_assert!(ends.nm().abs() <= 20_000, "{} mm\n{text}", ends.nm());
            }
        }
        let home = last_place(&rewritten.text).distance(last_place(&original)).nm();
        prop_assert!(home <= 100, "the program ends {home} nm off\n{text}");
        for index in 0..stretches.len() {
            if spelling.numbered {
                prop_assert_eq!(text.lines().filter(|l| l.starts_with(&format!("N{}G", 10 * (index + 1))) || l.starts_with(&format!("N{} ", 10 * (index + 1)))).count(), 1);
            }
            prop_assert_eq!(text.matches(&format!("(WALL {index})")).count(), usize::from(spelling.commented));
        }
        prop_assert!(!text.lines().any(|l| l.contains("G1") && l.contains('R') && !l.starts_with('(') && !l.contains("(W")));
        let kept = text.lines().filter(|l| !l.starts_with('(')).count();
        let lines = std::str::from_utf8(&original).expect("ASCII").lines().count();
        prop_assert_eq!(kept, lines - blocks.len() + rewritten.difference.straight_moves + rewritten.difference.arcs);
    }
}
