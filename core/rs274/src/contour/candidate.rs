//! What is told of a run that may be a finishing contour, and the list of all of them.

use super::ContourOptions;
use super::run::{Between, Run, RunReader};
use crate::{GcodeError, Interpreter, LineRange, Memory, Program, ProgramSummary};
use truepath_units::geometry::{Block, Side};
use truepath_units::{Offset, Position, Real};

/// A contour that a program holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// Its place among the runs looked at, in the order of execution, counted from 1.
    pub number: u32,
    /// Lines of its first and last block.
    pub lines: LineRange,
    /// Number of lines and arcs.
    pub blocks: usize,
    /// Its length.
    pub length: Offset,
    /// Its height; `None` when the program never gives it.
    pub z: Option<Position>,
    /// The tool in the spindle; `None` without M6.
    pub tool: Option<u32>,
    /// The side of the wall by G41 or G42.
    pub wall: Option<Side>,
    /// Whether it ends where it starts.
    pub closed: bool,
    /// Blocks at its start up to the one along which G41 or G42 takes its offset, that one included.
    pub entry: usize,
    /// Blocks at its end from the one along which G40 gives the offset up.
    pub exit: usize,
    /// S, revolutions per minute; `None` when the program has none.
    pub speed: Option<Real>,
    /// How the cutter came to it and left it.
    pub between: Between,
}

/// Gives every run of cutting moves of a program to `visit`, in order, for a list from which to choose.
///
/// # Errors
/// Whatever is not understood, or a cutting move from an unknown place.
pub fn find_contours(
    program: &Program<'_>,
    memory: &mut Memory<'_>,
    options: &ContourOptions,
    visit: impl FnMut(&Candidate),
) -> Result<ProgramSummary, GcodeError> {
    visit_runs(program, memory, options, |_| {}, visit)
}

/// The same with the geometry: every block of a run is given to `on_block` before the run itself to `on_run`. Arc
/// length counts from the start of the run.
///
/// # Errors
/// Whatever is not understood, or a cutting move from an unknown place.
pub fn visit_runs(
    program: &Program<'_>,
    memory: &mut Memory<'_>,
    options: &ContourOptions,
    mut on_block: impl FnMut(&Block),
    mut on_run: impl FnMut(&Candidate),
) -> Result<ProgramSummary, GcodeError> {
    let mut reader = RunReader::new(options.within);
    let summary = Interpreter::new(options.program).run(*program, memory, &mut |event| {
        let progress = reader.step(event)?;
        if let Some(run) = progress.ended {
            on_run(&run.candidate());
        }
        if let Some(block) = progress.block {
            on_block(&block);
        }
        Ok(())
    })?;
    if let Some(run) = reader.finish() {
        on_run(&run.candidate());
    }
    Ok(summary)
}

impl Run {
    /// What is told of it.
    pub(super) fn candidate(&self) -> Candidate {
        Candidate {
            number: self.number,
            lines: self.lines,
            blocks: self.blocks,
            length: self.length,
            z: self.z,
            tool: self.setup.tool,
            wall: self.wall,
            closed: self.start == self.end,
            entry: self.entry,
            exit: self.exit,
            speed: self.setup.speed,
            between: self.between,
        }
    }
}
