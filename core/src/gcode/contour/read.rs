//! The contour of a program, read into a slice lent by the caller, whose length is the only limit.
//!
//! A program given without further ado must hold exactly one run of cutting moves; with more, the caller names the
//! lines.

use super::run::{Run, RunReader};
use crate::gcode::{
    GcodeError, GcodeErrorKind, Interpreter, LineRange, Options, PathControl, ProgramSummary, Spindle, Units,
};
use crate::geometry::{Block, Side};
use crate::units::{Offset, Position, Real};

/// How a contour is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContourOptions {
    /// What the program does not say.
    pub program: Options,
    /// Only moves on these lines belong to the contour; the whole program is executed all the same.
    pub within: Option<LineRange>,
}

/// The contour that was read, and what the program says about its cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContourProgram {
    /// Blocks written to the buffer, from its start; arc length counts from 0.
    pub blocks: usize,
    /// Its length.
    pub length: Offset,
    /// Height of the pass, program coordinates.
    pub z: Position,
    /// Lines of its first and last block.
    pub lines: LineRange,
    /// Whether it ends where it starts.
    pub closed: bool,
    /// The side of the wall by G41 or G42; `None` when the program does not say it.
    pub wall: Option<Side>,
    /// The lowest feed on it, mm/min; 0 when a block has none.
    pub lowest_feed: Real,
    /// The highest feed on it, mm/min.
    pub highest_feed: Real,
    /// S, revolutions per minute; `None` when the program has none.
    pub speed: Option<Real>,
    /// M3, M4, or stopped when the program has neither.
    pub spindle: Spindle,
    /// The tool in the spindle; `None` without M6.
    pub tool: Option<u32>,
    /// The unit of its words.
    pub units: Units,
    /// G61 or G64 in force; `None` when the program does not say it.
    pub path: Option<PathControl>,
    /// What is known of the whole program.
    pub summary: ProgramSummary,
}

/// Reads the one contour of a program into `buffer`.
///
/// # Errors
/// Whatever is not understood; no contour, several of them, one that does not fit into the buffer, of unknown height,
/// from an unknown place, or with the wall on both sides.
pub fn read_contour(
    program: &[u8],
    buffer: &mut [Block],
    options: &ContourOptions,
) -> Result<ContourProgram, GcodeError> {
    let mut reader = RunReader::new(options.within);
    let (mut first, mut second): (Option<Run>, Option<Run>) = (None, None);
    let mut count = 0u32;
    let limit = buffer.len();
    let mut keep = |run: Run| {
        count = count.saturating_add(1);
        match (first, second) {
            (None, _) => first = Some(run),
            (_, None) => second = Some(run),
            _ => {}
        }
        count
    };
    let mut ended_before = 0;
    let mut filled = 0usize;
    let summary = Interpreter::new(options.program).run(program, &mut |event| {
        let progress = reader.step(event)?;
        if let Some(run) = progress.ended {
            ended_before = keep(run);
        }
        // Only the first run is stored: with a second one there is no contour to return.
        if let Some(block) = progress.block.filter(|_| ended_before == 0) {
            *buffer.get_mut(filled).ok_or(GcodeErrorKind::ContourTooLong { limit })? = block;
            filled = filled.saturating_add(1);
        }
        Ok(())
    })?;
    if let Some(run) = reader.finish() {
        keep(run);
    }
    let Some(run) = first else {
        return Err(GcodeError { kind: GcodeErrorKind::NoContour, line: 1, column: 1, start: 0, len: 0 });
    };
    if let Some(second) = second {
        let kind = GcodeErrorKind::SeveralContours { count, first: run.lines, second: second.lines };
        return Err(second.error(kind));
    }
    if run.both_sides {
        return Err(run.error(GcodeErrorKind::BothSides));
    }
    let z = run.z.ok_or_else(|| run.error(GcodeErrorKind::HeightUnknown))?;
    Ok(ContourProgram {
        blocks: run.blocks,
        length: run.length,
        z,
        lines: run.lines,
        closed: run.start == run.end,
        wall: run.wall,
        lowest_feed: run.lowest_feed,
        highest_feed: run.highest_feed,
        speed: run.setup.speed,
        spindle: run.setup.spindle,
        tool: run.setup.tool,
        units: run.units,
        path: run.path,
        summary,
    })
}
