//! Why a path cannot be compensated.

use core::fmt;

use crate::GcodeErrorKind;
use truepath_units::Offset;

/// What the cutter cannot do, or the program must not ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompensationError {
    /// The first move is not longer than the cutter's radius.
    EntryTooShort {
        /// Its length in the plane.
        length: Offset,
        /// The cutter's radius.
        radius: Offset,
    },
    /// The arc from where the cutter stands to beside the end of the first arc is not larger than the cutter.
    EntryArcTooSmall {
        /// The radius of that arc.
        arc: Offset,
        /// The cutter's radius.
        radius: Offset,
    },
    /// The cutter does not fit inside an arc.
    ArcTooSmall {
        /// The radius of the arc.
        arc: Offset,
        /// The cutter's radius.
        radius: Offset,
    },
    /// The paths beside the two moves of an inside corner never meet.
    CornerUnreachable {
        /// The cutter's radius.
        radius: Offset,
    },
    /// Nothing is left of a move between its corners: the cutter would cut into the neighbouring walls.
    MoveUnreachable {
        /// The length of the move as programmed.
        length: Offset,
        /// The cutter's radius.
        radius: Offset,
    },
    /// An arc is met at an angle too large for a tangent joint, and too small for a corner.
    ArcDistorted {
        /// The radius of the arc.
        arc: Offset,
        /// The cutter's radius.
        radius: Offset,
    },
    /// The first move after G40 is an arc.
    ExitArc,
    /// A code that must not stand between G41 or G42 and G40.
    Forbidden,
    /// G41 or G42 in G19.
    Plane,
    /// G41 or G42 while it is on.
    AlreadyOn,
    /// A move in the plane from or to a place that is not known.
    PlaceUnknown,
    /// More steps between two moves than can wait.
    TooMuchBetween {
        /// How many can.
        limit: usize,
    },
    /// G41.1 or G42.1 without D.
    DiameterMissing,
    /// A tool that is not in the tool table.
    ToolUnknown {
        /// Its number.
        number: u32,
    },
    /// A radius beyond 100 m.
    RadiusTooLarge,
}

impl CompensationError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::EntryTooShort { .. } => "G120",
            Self::EntryArcTooSmall { .. } => "G121",
            Self::ArcTooSmall { .. } => "G122",
            Self::CornerUnreachable { .. } => "G123",
            Self::MoveUnreachable { .. } => "G124",
            Self::ArcDistorted { .. } => "G125",
            Self::ExitArc => "G126",
            Self::Forbidden => "G127",
            Self::Plane => "G128",
            Self::AlreadyOn => "G129",
            Self::PlaceUnknown => "G130",
            Self::TooMuchBetween { .. } => "G131",
            Self::DiameterMissing => "G132",
            Self::ToolUnknown { .. } => "G133",
            Self::RadiusTooLarge => "G134",
        }
    }
}

/// A length in millimetres, to the micrometre.
struct Mm(Offset);

impl fmt::Display for Mm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let um = truepath_units::div_rounded(i128::from(self.0.nm()), 1_000).unsigned_abs();
        write!(f, "{}.{:03} mm", um / 1_000, um % 1_000)
    }
}

impl fmt::Display for CompensationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EntryTooShort { length, radius } => write!(
                f,
                "the first move under G41/G42 is {} long in the plane and must be longer than the cutter's radius, {}; start farther away",
                Mm(length),
                Mm(radius)
            ),
            Self::EntryArcTooSmall { arc, radius } => write!(
                f,
                "the first move under G41/G42 would be an arc of {}, which must be larger than the cutter's radius, {}; enter along a line",
                Mm(arc),
                Mm(radius)
            ),
            Self::ArcTooSmall { arc, radius } => write!(
                f,
                "an inside arc of {} must be larger than the cutter's radius, {}; take a smaller cutter",
                Mm(arc),
                Mm(radius)
            ),
            Self::CornerUnreachable { radius } => write!(
                f,
                "the inside corner before this move is too tight for a cutter radius of {}; take a smaller cutter",
                Mm(radius)
            ),
            Self::MoveUnreachable { length, radius } => write!(
                f,
                "the move before this one is {} long, too short between its corners for a cutter radius of {}; it would be gouged: take a smaller cutter",
                Mm(length),
                Mm(radius)
            ),
            Self::ArcDistorted { arc, radius } => write!(
                f,
                "an arc of {} joins its neighbour neither tangentially nor at a corner, for a cutter radius of {}; make the joint tangent",
                Mm(arc),
                Mm(radius)
            ),
            Self::ExitArc => f.write_str("the first move after G40 must be a line, not an arc; leave along a line"),
            Self::Forbidden => {
                f.write_str("this code must not stand between G41/G42 and G40; turn compensation off before it")
            }
            Self::Plane => f.write_str("G41/G42 need the XY or the ZX plane; program G17 or G18 before it"),
            Self::AlreadyOn => f.write_str("G41/G42 while compensation is on; program G40 before it"),
            Self::PlaceUnknown => f.write_str(
                "a move under G41/G42 begins or ends at a place that is not known; give both axes in G90 before it",
            ),
            Self::TooMuchBetween { limit } => {
                write!(
                    f,
                    "more than {limit} steps between two moves under G41/G42; put them outside of the compensated contour"
                )
            }
            Self::DiameterMissing => f.write_str("G41.1 and G42.1 need D, the cutter's diameter; add it"),
            Self::ToolUnknown { number } => {
                write!(f, "tool {number} is not in the tool table; correct D, or add the tool with its diameter")
            }
            Self::RadiusTooLarge => f.write_str("a cutter radius beyond 100 m; correct D"),
        }
    }
}

impl From<CompensationError> for GcodeErrorKind {
    fn from(error: CompensationError) -> Self {
        Self::Compensation(error)
    }
}

impl core::error::Error for CompensationError {}
