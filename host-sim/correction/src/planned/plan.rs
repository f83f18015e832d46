//! What is to be cut along a wall, and where it came to stand.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_job::job::PlanCutter;
use truepath_job::pass::Pass;
use truepath_program::passes::Turn;

/// One pass of a planned process.
#[derive(Clone, Debug)]
pub struct PlannedPass {
    /// Commanded displacement of every sample of the contour, in the order of the program even if the pass runs the other way.
    pub nodes: Vec<Node>,
    /// How far the tip stays above that of the pass of the program, 0 or more; 0 for the last pass.
    pub raise: Offset,
    /// Whether it runs against the direction of the program: the lead-out becomes its lead-in.
    pub reversed: bool,
    /// Its feed, as a factor of the programmed one, above 0.
    pub feed: f64,
}

impl PlannedPass {
    /// What of it the program writer repeats.
    pub(super) const fn turn(&self) -> Turn {
        Turn { raise: self.raise, reversed: self.reversed, feed: self.feed }
    }
}

/// A wall with its plan.
#[derive(Clone, Copy, Debug)]
pub struct PlannedWall<'a> {
    /// The pass of the program that finishes it.
    pub pass: &'a Pass,
    /// Its path.
    pub path: &'a Path<'a>,
    /// The passes in its place, in the order of cutting.
    pub passes: &'a [PlannedPass],
    /// The cutter that cuts them where it is not that of the program; as wide as that.
    pub cutter: Option<&'a PlanCutter>,
}

/// The passes of one depth of a wall.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlannedDepth {
    /// Which of the walls, from 0.
    pub wall: usize,
    /// The depth, from 1.
    pub level: u32,
    /// Lines of the original that were replaced.
    pub replaced: [u32; 2],
    /// Lines of every pass in the written program, the finishing one last.
    pub passes: Vec<[u32; 2]>,
    /// Heights of the passes, mm.
    pub z_mm: Vec<f64>,
}
