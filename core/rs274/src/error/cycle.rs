//! Errors of canned cycles, splines, probing and tapping.

use core::fmt;

use super::super::message::{Letter, Millimetres};
use super::super::{GCode, Spindle};
use super::GcodeErrorKind;
use truepath_units::Position;

/// What is wrong with a cycle, a spline or a probing move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleError {
    /// A word that the code needs is missing.
    WordMissing {
        /// The code.
        code: GCode,
        /// The letter.
        letter: u8,
    },
    /// R lies below the bottom of the hole.
    BelowBottom {
        /// The height of R.
        clearance: Position,
        /// The bottom.
        bottom: Position,
    },
    /// K of a back boring cycle lies outside the hole.
    BackBoreTop {
        /// Where K leads.
        top: Position,
        /// The bottom.
        bottom: Position,
        /// The height of R.
        clearance: Position,
    },
    /// L0.
    NoRepetition,
    /// Q is so small that a hole has more pecks than are executed.
    TooManyPecks {
        /// How many are executed.
        limit: u32,
    },
    /// The spindle does not turn as the code needs it.
    Spindle {
        /// The code.
        code: GCode,
        /// How it must turn.
        needed: Spindle,
    },
    /// A spline outside the XY plane, or with a move of another axis.
    SplinePlane(GCode),
    /// G5.3 without G5.2 before it.
    SplineNotBegun,
    /// A spline that is still open when another code comes.
    SplineOpen,
    /// Fewer control points than the order needs.
    SplinePoints {
        /// How many there are.
        found: u8,
        /// The order (L).
        order: u8,
    },
    /// More control points than are kept.
    SplineTooLong {
        /// How many are kept.
        limit: u8,
    },
    /// A probing move without length.
    ProbeTooShort,
    /// A canned cycle in G93: its moves would each take the time that F gives.
    InverseTime,
}

impl CycleError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::WordMissing { .. } => "G090",
            Self::BelowBottom { .. } => "G091",
            Self::BackBoreTop { .. } => "G092",
            Self::NoRepetition => "G093",
            Self::TooManyPecks { .. } => "G094",
            Self::Spindle { .. } => "G095",
            Self::SplinePlane(_) => "G096",
            Self::SplineNotBegun => "G097",
            Self::SplineOpen => "G098",
            Self::SplinePoints { .. } => "G099",
            Self::SplineTooLong { .. } => "G100",
            Self::ProbeTooShort => "G101",
            Self::InverseTime => "G102",
        }
    }
}

impl From<CycleError> for GcodeErrorKind {
    fn from(error: CycleError) -> Self {
        Self::Cycle(error)
    }
}

/// A coordinate in millimetres.
const fn coordinate(place: Position) -> Millimetres {
    Millimetres(truepath_units::Offset::from_nm(place.nm()))
}

impl fmt::Display for CycleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::WordMissing { code, letter } => {
                write!(f, "{code} has no {}; add it to this block", Letter(letter))
            }
            Self::BelowBottom { clearance, bottom } => write!(
                f,
                "R at {} is below the bottom of the hole at {}; correct R or the depth",
                coordinate(clearance),
                coordinate(bottom)
            ),
            Self::BackBoreTop { top, bottom, clearance } => write!(
                f,
                "K leads to {}, which is not between the bottom at {} and R at {}; correct K",
                coordinate(top),
                coordinate(bottom),
                coordinate(clearance)
            ),
            Self::NoRepetition => f.write_str("L0 repeats the cycle no times; remove L or give at least 1"),
            Self::TooManyPecks { limit } => {
                write!(f, "Q asks for more than {limit} pecks in one hole; is it too small?")
            }
            Self::Spindle { code, needed } => {
                let word = if needed == Spindle::CounterClockwise { "M4" } else { "M3" };
                write!(f, "{code} needs a turning spindle; give S and {word} before it")
            }
            Self::SplinePlane(code) => {
                write!(f, "{code} is a spline in X and Y only; select G17 and remove the words of other axes")
            }
            Self::SplineNotBegun => f.write_str("G5.3 ends a spline, but G5.2 has not begun one; add G5.2 before it"),
            Self::SplineOpen => f.write_str("the spline begun by G5.2 is not ended; write G5.3 before this block"),
            Self::SplinePoints { found, order } => {
                write!(
                    f,
                    "the spline has {found} control points with its start, but L{order} needs at least {order}; add points or give a lower L (2 to 8)"
                )
            }
            Self::SplineTooLong { limit } => {
                write!(f, "the spline has more than {limit} control points; end it with G5.3 and begin another")
            }
            Self::InverseTime => {
                f.write_str("canned cycles have no time of their own in G93; select G94 or G95 before")
            }
            Self::ProbeTooShort => {
                f.write_str("the probing move has no length; give a target away from the present place")
            }
        }
    }
}
