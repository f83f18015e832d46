//! Plane geometry: points, directions, lines, arcs and the contour made of them.
//!
//! Everything here turns by 90° and mirrors with its input to the last bit; see [`crate::units`].

mod contour;
mod curve;
mod nearest;
mod side;
mod vector;

pub use contour::{Block, Contour, FACET_TURN_LIMIT, Place};
pub use curve::{ArcError, Curve, Shape};
pub use nearest::Nearest;
pub use side::Side;
pub use vector::{Direction, Point, Vector};
