//! Errors of corner words.

use core::fmt;

use super::super::message::Millimetres;
use super::GcodeErrorKind;
use truepath_units::Offset;

/// What is wrong with `,R` or `,C`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerError {
    /// On a block that is no line (G1) in the plane.
    WithoutLine,
    /// Followed by something else than a line (G1) in the plane.
    NotFollowed {
        /// The line of what follows.
        line: u32,
    },
    /// What is cut off is longer than what is left of one of the two lines.
    TooLarge {
        /// What is cut off of each line.
        needed: Offset,
        /// How long the line is, less the corner at its other end.
        left: Offset,
        /// The line of its block.
        line: u32,
    },
    /// The second line goes back along the first.
    TurnsBack,
    /// `,A`.
    Angle,
    /// `,R` and `,C` in one block.
    Twice,
    /// A line that moves more than the two axes of the plane.
    OtherAxis,
    /// In inverse time (G93), where F is the time of the whole block.
    InverseTime,
    /// More steps between the two lines than can wait.
    TooMuchBetween {
        /// How many can.
        limit: u8,
    },
}

impl CornerError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::WithoutLine | Self::NotFollowed { .. } => "G058",
            Self::TooLarge { .. } => "G059",
            Self::TurnsBack => "G110",
            Self::Angle => "G111",
            Self::Twice => "G112",
            Self::OtherAxis => "G113",
            Self::InverseTime => "G114",
            Self::TooMuchBetween { .. } => "G115",
        }
    }
}

impl From<CornerError> for GcodeErrorKind {
    fn from(error: CornerError) -> Self {
        Self::Corner(error)
    }
}

impl fmt::Display for CornerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::WithoutLine => f.write_str(
                "`,R` and `,C` stand between two lines (G1) of the plane, and this block is none; remove the word or write the corner out",
            ),
            Self::NotFollowed { line } => write!(
                f,
                "`,R` and `,C` stand between two lines (G1) of the plane, and line {line} comes before the second; write the corner out, or put that block elsewhere"
            ),
            Self::TooLarge { needed, left, line } => write!(
                f,
                "the corner cuts {} off each of its two lines, and that of line {line} has {} left; give a smaller one",
                Millimetres(needed),
                Millimetres(left)
            ),
            Self::TurnsBack => {
                f.write_str("the second line goes back along the first, and nothing can be cut off there; remove the word")
            }
            Self::Angle => f.write_str("`,A` (the direction of a line) is not computed; write the end of the line with its axes"),
            Self::Twice => f.write_str("`,R` and `,C` stand in one block; keep one of them"),
            Self::OtherAxis => f.write_str(
                "a corner is cut between lines of the two axes of the plane, and another axis moves here; give that move a block of its own",
            ),
            Self::InverseTime => {
                f.write_str("a corner has no feed of its own in inverse time (G93); write G94 before it, or write the corner out")
            }
            Self::TooMuchBetween { limit } => write!(
                f,
                "more than {limit} steps stand between the two lines of a corner; put comments, M, F and S before or behind them"
            ),
        }
    }
}
