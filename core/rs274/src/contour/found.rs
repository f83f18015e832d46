//! A run in the list of the search, and what it is found to be.

use core::ops::Range;

use super::Candidate;
use super::split::{closed, length};
use crate::LineRange;
use truepath_units::geometry::{Block, Extent, Side};
use truepath_units::{Offset, Position};

/// Why a run makes no wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// A move between cuts.
    Travel,
    /// It takes a face off.
    Facing,
}

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Cut with another tool.
    OtherTool,
    /// It makes no wall.
    Idle(Idle),
    /// Another run takes its wall away.
    Rough {
        /// Its index in the list.
        nearer: usize,
        /// The smallest distance between the two.
        gap: Offset,
        /// Whether the distance is the same nearly everywhere.
        parallel: bool,
    },
    /// It makes a wall.
    Finish {
        /// Number of the contour, from 1.
        contour: u32,
        /// Number of the level, from 1 in the order of execution.
        level: u32,
    },
    /// It goes over a finished wall again.
    Spring {
        /// Number of the contour, from 1.
        contour: u32,
        /// Number of the level.
        level: u32,
    },
}

/// A run with its place among all blocks and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// What is told of it; after the search without its leads.
    pub run: Candidate,
    /// Index of its first block among the blocks of all runs.
    pub first: usize,
    /// Blocks of the run before the first one that is left: leads, or what the caller did not name.
    pub skipped: usize,
    /// What it is for.
    pub role: Role,
    /// Index of the first run along the same path.
    pub(super) like: usize,
    /// Why it makes no wall.
    pub(super) idle: Option<Idle>,
    /// A rectangle that holds it.
    pub(super) extent: Extent,
    /// Of the first run along a path: the greatest depth of all that follow it.
    pub(super) deepest: Option<Position>,
}

impl Found {
    /// A run that was read, whose first block is at `first` among the blocks of all runs.
    pub const fn new(run: Candidate, first: usize) -> Self {
        let (extent, deepest) = (Extent::EMPTY, None);
        Self { run, first, skipped: 0, role: Role::OtherTool, like: 0, idle: None, extent, deepest }
    }
    /// The same run with only some of its blocks, counted within it; `None` when there is none of them.
    pub fn narrowed(&self, kept: Range<usize>, blocks: &[Block]) -> Option<Self> {
        let contour = self.blocks(blocks).get(kept.clone())?;
        let lines = || contour.iter().map(|b| b.line);
        let (first, last) = (lines().min()?, lines().max()?);
        let behind = self.run.blocks.saturating_sub(kept.end);
        let run = Candidate {
            blocks: contour.len(),
            length: length(contour),
            lines: LineRange { first, last },
            closed: closed(contour),
            entry: self.run.entry.saturating_sub(kept.start),
            exit: self.run.exit.saturating_sub(behind),
            ..self.run
        };
        let skipped = self.skipped.saturating_add(kept.start);
        Some(Self { run, first: self.first.saturating_add(kept.start), skipped, ..*self })
    }
    /// Its blocks.
    pub fn blocks<'b>(&self, all: &'b [Block]) -> &'b [Block] {
        all.get(self.first..self.first.saturating_add(self.run.blocks)).unwrap_or_default()
    }
}

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Criteria {
    /// The tool; `None` for any.
    pub tool: Option<u32>,
    /// Side of travel of the finished wall; `None` leaves it to G41 and G42.
    pub wall: Option<Side>,
    /// The cutter's diameter.
    pub diameter: Offset,
    /// Whether the caller named the lines: the only run on them is taken as it is, but for what G41, G42 and G40 show.
    pub named: bool,
}
