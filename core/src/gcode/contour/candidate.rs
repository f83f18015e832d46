//! What is told of a run that may be a finishing contour.

use super::ContourOptions;
use super::run::{Run, RunReader};
use crate::gcode::{GcodeError, Interpreter, LineRange, ProgramSummary};
use crate::geometry::Side;
use crate::units::{Offset, Position};

/// A contour that a program holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
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
}

/// Gives every contour of a program to `visit`, in order, for a list from which to choose.
///
/// # Errors
/// Whatever is not understood, or a cutting move from an unknown place.
pub fn find_contours(
    program: &[u8],
    options: &ContourOptions,
    mut visit: impl FnMut(&Candidate),
) -> Result<ProgramSummary, GcodeError> {
    let mut reader = RunReader::new(options.within);
    let summary = Interpreter::new(options.program).run(program, &mut |event| {
        if let Some(run) = reader.step(event)?.ended {
            visit(&run.candidate());
        }
        Ok(())
    })?;
    if let Some(run) = reader.finish() {
        visit(&run.candidate());
    }
    Ok(summary)
}

impl Run {
    /// What is told of it.
    pub(super) fn candidate(&self) -> Candidate {
        Candidate {
            lines: self.lines,
            blocks: self.blocks,
            length: self.length,
            z: self.z,
            tool: self.setup.tool,
            wall: self.wall,
            closed: self.start == self.end,
        }
    }
}
