//! What one block does, as far as it concerns five-axis moves.

use std::ops::Range;

use super::block::Word;
use super::reason::Reason;
use super::state::Place;

/// What a block turned out to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Nothing that cuts with a rotary axis.
    Nothing,
    /// A G1 of X, Y, Z alone: straight by itself.
    Straight,
    /// A G1 that turns a rotary axis.
    Move(Box<Move>),
    /// One that cannot be checked.
    Unchecked(Reason),
    /// The order of the lines is not that of the text, or a place is an expression: bytes of the line.
    Steered(Range<usize>),
}

/// A G1 that turns a rotary axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Before, program coordinates; what the move needs is known.
    pub from: Place,
    /// After.
    pub to: Place,
    /// Before, in the frame of the machine file: mm and degrees.
    pub start: [f64; 6],
    /// After.
    pub end: [f64; 6],
    /// Whether X, Y or Z changes too.
    pub travels: bool,
}

/// What makes a block an error.
#[derive(Clone, Copy, Debug)]
pub enum Trouble {
    /// A letter stands twice.
    Twice(Word),
    /// The machine has no such axis.
    NoAxis(Word),
    /// Axis words without a motion.
    NoMotion(Word),
    /// Beyond the farthest coordinate.
    TooFar(Word),
    /// G93 wants an F in every block that cuts.
    FeedMissing,
}
