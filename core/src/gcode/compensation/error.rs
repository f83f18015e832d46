//! Why a path cannot be compensated.

use crate::units::Offset;

/// What the cutter cannot do.
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
}
