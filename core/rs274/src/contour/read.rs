//! The contour of a program, read into a slice lent by the caller, whose length is the only limit.
//!
//! A program given without further ado must hold exactly one run of cutting moves; with more, the caller names the
//! lines, or the run and its blocks. Runs count in the order of execution, so that a contour milled in a loop or by a
//! subprogram called several times is a run each time.

use super::run::{Run, RunReader};
use crate::{
    GcodeError, GcodeErrorKind, Interpreter, LineRange, Memory, Options, PathControl, Program, ProgramSummary, Spindle,
    Units,
};
use truepath_units::geometry::{Block, Side};
use truepath_units::{Offset, Position, Real};

/// How a contour is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContourOptions {
    /// What the program does not say.
    pub program: Options<'static>,
    /// Only moves on these lines belong to the contour; the whole program is executed all the same.
    pub within: Option<LineRange>,
    /// Only these blocks of this run are the contour.
    pub part: Option<RunPart>,
}

/// Some blocks of one run of cutting moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunPart {
    /// The run, counted from 1 in the order of execution.
    pub run: u32,
    /// The first of its blocks that counts, from 0.
    pub first: u32,
    /// How many count, at least 1.
    pub blocks: u32,
}

impl RunPart {
    /// The error that the program has no such blocks.
    const fn missing(self) -> GcodeErrorKind {
        GcodeErrorKind::PartMissing { run: self.run, first: self.first, blocks: self.blocks }
    }
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
/// Whatever is not understood; no contour, several of them, no such part, one that does not fit into the buffer, of
/// unknown height, from an unknown place, or with the wall on both sides.
pub fn read_contour(
    program: &Program<'_>,
    memory: &mut Memory<'_>,
    buffer: &mut [Block],
    options: &ContourOptions,
) -> Result<ContourProgram, GcodeError> {
    let mut reader = RunReader::new(options.within);
    let mut kept = Kept { options, buffer, filled: 0, found: None, second: None, count: 0 };
    let mut index = 0u32;
    let summary = Interpreter::new(options.program).run(*program, memory, &mut |event| {
        let progress = reader.step(event)?;
        if let Some(run) = progress.ended {
            kept.ended(run);
            index = 0;
        }
        if let Some(block) = progress.block {
            kept.block(block, reader.number(), index)?;
            index = index.saturating_add(1);
        }
        Ok(())
    })?;
    let without_start = reader.without_start();
    if let Some(run) = reader.finish() {
        kept.ended(run);
    }
    match without_start.filter(|_| kept.found.is_none() && options.part.is_none()) {
        Some(error) => Err(error),
        None => kept.contour(summary),
    }
}

/// What is kept of a program while it is read.
struct Kept<'a> {
    options: &'a ContourOptions,
    buffer: &'a mut [Block],
    filled: usize,
    found: Option<Run>,
    second: Option<Run>,
    count: u32,
}

impl Kept<'_> {
    /// Stores a block of the run wanted. Without a part that is the first one: with a second there is no contour.
    fn block(&mut self, block: Block, run: u32, index: u32) -> Result<(), GcodeErrorKind> {
        let (first, wanted) = match self.options.part {
            Some(part) => (0, part.run == run && index >= part.first && index < part.first.saturating_add(part.blocks)),
            None => (self.count, true),
        };
        if first > 0 || !wanted {
            return Ok(());
        }
        let limit = self.buffer.len();
        let before = self.filled.checked_sub(1).and_then(|last| self.buffer.get(last));
        let s = before.map_or(Offset::ZERO, |b| b.s + b.curve.length());
        *self.buffer.get_mut(self.filled).ok_or(GcodeErrorKind::ContourTooLong { limit })? = Block { s, ..block };
        self.filled = self.filled.saturating_add(1);
        Ok(())
    }

    fn ended(&mut self, run: Run) {
        self.count = self.count.saturating_add(1);
        match (self.options.part, self.found) {
            (Some(part), _) if part.run != run.number => {}
            (Some(_), _) | (None, None) => self.found = Some(run),
            (None, Some(_)) => self.second = self.second.or(Some(run)),
        }
    }

    fn contour(self, summary: ProgramSummary) -> Result<ContourProgram, GcodeError> {
        let nowhere = |kind| GcodeError { kind, file: 0, line: 1, column: 1, start: 0, len: 0 };
        let Some(run) = self.found else {
            return Err(nowhere(self.options.part.map_or(GcodeErrorKind::NoContour, RunPart::missing)));
        };
        if let Some(second) = self.second {
            let kind = GcodeErrorKind::SeveralContours { count: self.count, first: run.lines, second: second.lines };
            return Err(second.error(kind));
        }
        let blocks = self.buffer.get(..self.filled).unwrap_or_default();
        let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else {
            return Err(run.error(GcodeErrorKind::NoContour));
        };
        if let Some(part) = self.options.part
            && u32::try_from(blocks.len()) != Ok(part.blocks)
        {
            return Err(run.error(part.missing()));
        }
        if run.both_sides {
            return Err(run.error(GcodeErrorKind::BothSides));
        }
        let z = run.z.ok_or_else(|| run.error(GcodeErrorKind::HeightUnknown))?;
        let lines = || blocks.iter().map(|b| b.line);
        let feeds = || blocks.iter().map(|b| b.feed);
        Ok(ContourProgram {
            blocks: blocks.len(),
            length: last.s + last.curve.length(),
            z,
            lines: LineRange { first: lines().min().unwrap_or(0), last: lines().max().unwrap_or(0) },
            closed: first.curve.start() == last.curve.end(),
            wall: run.wall,
            lowest_feed: feeds().min().unwrap_or_default(),
            highest_feed: feeds().max().unwrap_or_default(),
            speed: run.setup.speed,
            spindle: run.setup.spindle,
            tool: run.setup.tool,
            units: run.units,
            path: run.path,
            summary,
        })
    }
}
