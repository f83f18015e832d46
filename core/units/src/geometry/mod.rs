//! Plane geometry: points, directions, lines, arcs and the contour made of them.
//!
//! Everything here turns by 90° and mirrors with its input to the last bit; see [`crate`].
//!
//! ```
//! use truepath_units::geometry::{Block, Contour, Curve, Point};
//! use truepath_units::{Offset, Real};
//!
//! let line = Curve::line(Point::from_nm(0, 0), Point::from_nm(10_000_000, 0)).unwrap();
//! let blocks = [Block { curve: line, s: Offset::ZERO, feed: Real::from_int(400), line: 1 }];
//! let contour = Contour::new(&blocks).unwrap();
//! assert_eq!(contour.length(), Offset::from_um(10_000));
//! ```

mod contour;
mod curve;
mod extent;
mod nearest;
mod side;
mod vector;

pub use contour::{Block, Contour, FACET_TURN_LIMIT, Place};
pub use curve::{ARC_TOLERANCE, ArcError, Curve, Shape};
pub use extent::Extent;
pub use nearest::{Nearby, Nearest};
pub use side::Side;
pub use vector::{Direction, Point, Vector};
