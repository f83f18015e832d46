//! Cutter radius compensation: from the programmed contour to the path of the cutter's centre.
//!
//! G41 keeps the cutter on the left of travel, G42 on the right, at the distance of its radius. Outside corners get an
//! arc of the radius about the corner, inside corners end where the two neighbouring paths meet, arcs change their
//! radius and keep their centre. What the cutter cannot reach without cutting into a neighbouring wall is an error.
//! Which joints count as corners, how the first move enters, and what is refused, follow what LinuxCNC 2.9 was
//! observed to do; the geometry is derived here.
//!
//! Where LinuxCNC cuts into a wall without a word this is stricter: a line used up between its corners is refused also
//! before an outside corner with an arc, and a full circle met at a small angle stays a full circle (one turn and a
//! little) where LinuxCNC's numbers leave the little alone.
//!
//! Everything is computed in whole numbers: places are within 1 nm of the exact ones for corners of more than
//! 0.05 rad, and a program that is shifted, turned by 90° or mirrored gives the shifted, turned or mirrored path to
//! the last bit.

mod corner;
mod leg;
mod path;
mod remains;
mod stage;
#[cfg(test)]
mod tests;
pub(crate) mod unit;

pub use super::error::CompensationError;
pub use leg::{Cutter, Piece, Shape};
pub use path::{CutterPath, StartUp, Step};
pub use stage::WAITING;
pub(crate) use stage::{CompensationStage, Waiting, in_plane, moved, put};
use unit::FINE_BITS;
