//! Dimensions as readings: widths, diameters, distances and wall thicknesses, taken by hand or on a measuring machine.
//!
//! | step | where |
//! |---|---|
//! | the file with its `[[dimension]]` tables, checked | `file` |
//! | the values of a measuring machine that it names | `results`, in Q-DAS format `aqdef` |
//! | a QIF document in its place, which says itself where it was measured | `measured` |
//! | what is kept of it beside a correction | `kept` |
//! | where the finished walls cross a line of measurement | `walls` |
//! | which of them a dimension is between, and what it says of them | `placed` |
//!
//! A width sees two walls: it is off by the sum of their errors, and half of that, the mean error, is one reading of the
//! pair ([`Observation::with_across`](truepath_core::identify::Observation::with_across)). A distance from a face sees
//! one wall, as a probe does, and the datum with it. A width between two contours is a reading of both: one half of it on
//! either ([`Observation::paired`](truepath_core::identify::Observation::paired)).
//!
//! Limits: walls square to X or Y, and round ones across their middle. Z is the machine's own: the depth of a step is not of
//! this model.

mod aqdef;
mod file;
mod kept;
mod measured;
mod placed;
mod results;
mod walls;

use truepath_ground::diagnostics::{InputError, Source};

use crate::qif::is_qif;

pub use file::{Across, Dimension, INSTRUMENTS, Instrument, KINDS, Kind, Level};
pub use kept::kept;
pub(crate) use placed::placed;
pub use placed::{Dimensions, Half, Placed};
pub use walls::{Axis, Crossing, Walls};

/// Reads dimensions: the file with `[[dimension]]` tables, or a QIF document.
///
/// # Errors
/// What is wrong with either, with its place.
pub(crate) fn read(source: &Source) -> Result<Vec<Dimension>, InputError> {
    let is_document = source.name().to_lowercase().ends_with(".qif") || is_qif(source.bytes());
    if is_document { measured::read(source) } else { file::read(source) }
}
