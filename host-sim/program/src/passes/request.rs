//! What is asked for: which depths of a contour are cut in which passes.

use truepath_core::geometry::Block;
use truepath_core::units::Offset;

/// One depth of a contour, and the passes that take the place of its own.
#[derive(Clone, Debug)]
pub struct Depth {
    /// The contour as the program cuts it, without leads.
    pub contour: Vec<Block>,
    /// The passes along it that follow at once and go as well: each without leads.
    pub springs: Vec<Vec<Block>>,
    /// Stock on the wall before the first pass: what is farther away from the contour is free.
    pub allowance: Offset,
    /// The passes, in the order of cutting; at least one.
    pub turns: Vec<Turn>,
    /// Whether something has to be said to the control before the way down to every pass, the first one included.
    pub announced: bool,
    /// The cutter of the passes where it is not that of the program.
    pub cutter: Option<Cutter>,
}

/// A cutter in place of the program's own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cutter {
    /// Its number at the machine.
    pub number: u32,
    /// Number of the program's own, where the program does not say it and the job does.
    pub own: Option<u32>,
    /// What it is, for a comment.
    pub words: String,
}

/// One pass along a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// How far it stays above the programmed depth, 0 or more.
    pub raise: Offset,
    /// Whether it runs against the programmed direction.
    pub reversed: bool,
    /// Its feed, as a factor of the programmed one.
    pub feed: f64,
}
