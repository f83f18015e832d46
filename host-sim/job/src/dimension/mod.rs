//! Dimensions as readings: widths, diameters, distances and wall thicknesses, taken by hand or on a measuring machine.
//!
//! | step | where |
//! |---|---|
//! | the file with its `[[dimension]]` tables, checked | `file` |
//! | the values of a measuring machine, in Q-DAS format, that it names | `aqdef` |
//! | where the finished walls cross a line of measurement | `walls` |
//! | which of them a dimension is between, and what it says of them | `placed` |
//!
//! A width sees two walls: it is off by the sum of their errors, and half of that, the mean error, is one reading of the
//! pair ([`Observation::with_across`](truepath_core::identify::Observation::with_across)). A distance from a face sees
//! one wall, as a probe does, and the datum with it.
//!
//! Limits: walls square to X or Y, and round ones across their middle; both walls of a width belong to one contour. Z is
//! the machine's own: the depth of a step is not of this model.

mod aqdef;
mod file;
mod placed;
mod walls;

pub(crate) use file::read;
pub use file::{Across, Dimension, INSTRUMENTS, Instrument, KINDS, Kind, Level};
pub(crate) use placed::placed;
pub use placed::{Dimensions, Placed};
pub use walls::{Axis, Crossing, Walls};
