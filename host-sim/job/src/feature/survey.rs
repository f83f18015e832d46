//! The runs of cutting moves of a program, with their geometry.

use truepath_core::gcode::{
    Candidate, ContourOptions, Criteria, Found, HostMemory, LineRange, Program, search, visit_runs,
};
use truepath_core::geometry::Block;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{InputError, Source};

use crate::job::JobFile;

/// Different runs that are compared with each other at most; the time grows with the square of their number.
pub(crate) const LARGEST_SEARCH: usize = 1_000;

/// The length along which a correction comes and goes.
const LEAD: Offset = Offset::from_um(2_000);

/// All runs of a program.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The runs, in the order of execution.
    pub runs: Vec<Found>,
    /// Blocks of all runs, in the same order.
    pub blocks: Vec<Block>,
}

impl Survey {
    /// Reads a program as the job says that its control does.
    ///
    /// # Errors
    /// What is wrong with the program.
    pub fn read(job: &JobFile, program: &Source) -> Result<Self, InputError> {
        let mut blocks: Vec<Block> = Vec::new();
        let mut read: Vec<Candidate> = Vec::new();
        let mut memory = Box::new(HostMemory::new());
        let (text, options) = (
            Program::new(program.bytes()),
            ContourOptions { program: job.numbers.program_options(), ..ContourOptions::default() },
        );
        let (on_block, on_run) = (|block: &Block| blocks.push(*block), |run: &Candidate| read.push(*run));
        visit_runs(&text, &mut memory.lend(), &options, on_block, on_run)
            .map_err(|error| InputError::of_program(program, &error))?;
        let mut first = 0;
        let mut runs = Vec::with_capacity(read.len());
        for run in read {
            runs.push(Found::new(run, first));
            first += run.blocks;
        }
        Ok(Self { runs, blocks })
    }

    /// The runs on some lines. A run that leaves the lines and comes back to them, as in a loop, is one each time.
    pub(super) fn within(&self, lines: LineRange) -> Vec<Found> {
        let mut list = Vec::new();
        for run in &self.runs {
            let blocks = run.blocks(&self.blocks);
            let mut at = 0;
            for stretch in blocks.chunk_by(|a, b| lines.contains(a.line) == lines.contains(b.line)) {
                if lines.contains(stretch[0].line) {
                    list.extend(run.narrowed(at..at + stretch.len(), &self.blocks));
                }
                at += stretch.len();
            }
        }
        list
    }

    /// The blocks of the same run before and behind a contour, in their order: at least 2 mm where there are as many.
    pub(crate) fn leads(&self, found: &Found) -> [Vec<Block>; 2] {
        let index = usize::try_from(found.run.number).unwrap_or_default().wrapping_sub(1);
        let Some(run) = self.runs.get(index) else { return [Vec::new(), Vec::new()] };
        let all = run.blocks(&self.blocks);
        let end = found.skipped + found.run.blocks;
        let mut before = enough(all[..found.skipped].iter().rev());
        before.reverse();
        [before, enough(all.get(end..).unwrap_or_default().iter())]
    }

    /// Gives the runs of a list their roles and returns the number of finishing contours.
    pub(crate) fn sort(&self, runs: &mut [Found], criteria: &Criteria) -> u32 {
        search(runs, &self.blocks, criteria)
    }
}

/// Blocks from a contour outward, until they are long enough for the correction to come and go.
fn enough<'b>(blocks: impl Iterator<Item = &'b Block>) -> Vec<Block> {
    let mut length = Offset::ZERO;
    let mut kept = Vec::new();
    for block in blocks {
        if length >= LEAD {
            break;
        }
        length += block.curve.length();
        kept.push(*block);
    }
    kept
}
