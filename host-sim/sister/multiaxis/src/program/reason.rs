//! Why a move with rotary axes is left as it is.

use std::fmt;

use serde::{Serialize, Serializer};

/// What keeps a move from being checked, or divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The program has not said where this axis stands before the move.
    StartUnknown(u8),
    /// G41 or G42 of this line is in force.
    Compensation(u32),
    /// A code of this line gives XYZ another meaning.
    Transform(u32),
    /// G2, G3 with a rotary axis.
    Arc,
    /// A spline, a cycle, tapping or probing with a rotary axis.
    Curve,
    /// G53 with a rotary axis, at a feed.
    Elsewhere,
    /// Since this line another work offset is in force, or one was written.
    Offsets(u32),
    /// Since this line another tool is in the spindle, and the machine file has one length.
    Tool(u32),
    /// A location to be inserted lies beyond the travel of this axis.
    Travel(char),
    /// A corner word.
    Corner,
    /// It needs more pieces than allowed.
    Pieces,
    /// The digits of the program are too coarse for the tolerance.
    Digits,
    /// A code that is not known here.
    UnknownCode,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::StartUnknown(axis) => {
                write!(f, "where {} stands before it has not been said in G90 coordinates", char::from(axis))
            }
            Self::Compensation(line) => write!(f, "the cutter compensation of line {line} is in force"),
            Self::Transform(line) => write!(f, "line {line} gives X, Y and Z another meaning"),
            Self::Arc => f.write_str("it is an arc"),
            Self::Curve => f.write_str("it is a spline, a cycle, a thread or a probing move"),
            Self::Elsewhere => f.write_str("it is given in machine coordinates"),
            Self::Offsets(line) => {
                write!(f, "since line {line} the coordinates are not those in which the machine file gives its axes")
            }
            Self::Tool(line) => {
                write!(f, "since line {line} another tool is in the spindle than the machine file's")
            }
            Self::Travel(axis) => write!(f, "a point to be inserted lies beyond the travel of {axis}"),
            Self::Corner => f.write_str("its corner is rounded"),
            Self::Pieces => f.write_str("it needs more pieces than --max-pieces allows"),
            Self::Digits => f.write_str("it cannot be divided within the tolerance with the digits written"),
            Self::UnknownCode => f.write_str("its block has a code that is not known here"),
        }
    }
}

impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
