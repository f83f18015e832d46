//! The corrected path of a program: its contour moved aside, and what a program does, for comparison.

use truepath_core::gcode::{Axes, Canon, ContourOptions, HostMemory, Interpreter, Options, Program, read_contour};
use truepath_core::geometry::{Block, Contour, Curve, Point};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_program::{BlockEdit, RewriteOptions, Rewritten, rewrite_program};

/// The contour of a program.
pub fn blocks(program: &str, options: Options<'static>) -> Vec<Block> {
    let line = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line");
    let mut buffer = vec![Block { curve: line, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 4096];
    let options = ContourOptions { program: options, ..ContourOptions::default() };
    let memory = &mut HostMemory::new();
    let contour = read_contour(&Program::new(program.as_bytes()), &mut memory.lend(), &mut buffer, &options)
        .unwrap_or_else(|e| panic!("{e} in\n{program}"));
    buffer.truncate(contour.blocks);
    buffer
}

/// The contour displaced by up to 0.2 mm to its left, one edit for each line.
pub fn edits(program: &str, options: Options<'static>) -> Vec<BlockEdit> {
    let blocks = blocks(program, options);
    let contour = Contour::new(&blocks).expect("a contour");
    let mut edits: Vec<BlockEdit> = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let length = block.curve.length().nm();
        let count = (length / 100_000).max(2);
        let sample = |k: i64| {
            let s = block.s + Offset::from_nm(length * k / count);
            let place = contour.at(s, index).expect("a place");
            let left = place.heading.left();
            let size = 0.08 + 0.12 / (1.0 + ((s.nm() as f64 * 1e-6 - 40.0) / 6.0).powi(2));
            let by = |r: Real| (r.bits() as f64 / 4_294_967_296.0 * size * 1e6).round() as i64;
            [place.point.x.nm() + by(left.x), place.point.y.nm() + by(left.y)]
        };
        let mut samples: Vec<[i64; 2]> = (0..=count).map(sample).collect();
        match edits.last_mut() {
            Some(edit) if edit.line == block.line => edit.samples.extend(samples.into_iter().skip(1)),
            last => {
                if let Some(edit) = last {
                    samples[0] = *edit.samples.last().expect("a sample");
                }
                edits.push(BlockEdit::new(block.line, samples));
            }
        }
    }
    edits
}

/// Corrects a program, each edit as it is.
pub fn rewritten(program: &str, edits: &[BlockEdit], options: Options<'static>) -> Result<Rewritten, Failure> {
    let options = RewriteOptions { program: options, ..RewriteOptions::default() };
    rewrite_program(&Source::new("part.nc", program.as_bytes().to_vec()), edits, &options)
}

/// The corrected text of a program.
pub fn corrected(program: &str) -> String {
    let done = rewritten(program, &edits(program, Options::default()), Options::default());
    let done = done.unwrap_or_else(|e| panic!("{e} in\n{program}"));
    assert!(done.difference.largest_deviation_mm <= 0.001 && done.difference.largest_shift.mm > 0.15);
    String::from_utf8(done.text).expect("ASCII")
}

/// Why a program is refused.
pub fn refusal(program: &str) -> InputError {
    refusal_of(rewritten(program, &edits(program, Options::default()), Options::default()))
}

/// The error of the input.
pub fn refusal_of(done: Result<Rewritten, Failure>) -> InputError {
    match done {
        Err(Failure::Input(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(done) => panic!("written:\n{}", String::from_utf8_lossy(&done.text)),
    }
}

/// The points of the plane where Z goes down by a feed move: holes and plunges, nm.
pub fn plunges(program: &str) -> Vec<Point> {
    let mut places = Vec::new();
    Interpreter::new(Options::default())
        .run(program.as_bytes(), &mut HostMemory::new().lend(), &mut |event| {
            if let Canon::Feed { from, to } = *event.canon
                && from.point() == to.point()
                && from.z > to.z
            {
                places.extend(to.point());
            }
            Ok(())
        })
        .unwrap_or_else(|e| panic!("{e} in\n{program}"));
    places
}

/// Where the program ends.
pub fn end(program: &str) -> Axes {
    let mut at = Axes::UNKNOWN;
    Interpreter::new(Options::default())
        .run(program.as_bytes(), &mut HostMemory::new().lend(), &mut |event| {
            if let Canon::Feed { to, .. } | Canon::Traverse { to, .. } | Canon::Arc { to, .. } = *event.canon {
                at = to;
            }
            Ok(())
        })
        .unwrap_or_else(|e| panic!("{e} in\n{program}"));
    at
}
