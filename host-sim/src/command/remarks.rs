//! What is to be said of a measurement in the summary of a correction.

use crate::measurement::Measurement;

/// What a measurement leaves to be said.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remarks<'a> {
    /// Readings set aside.
    pub(super) set_aside: usize,
    /// Sentences for the summary.
    pub(super) texts: &'a [String],
    /// CRC-32 of the probe file.
    pub(super) probe: u32,
    /// Whether it is of the pass that is corrected, and not of one before it.
    pub(super) of_this_pass: bool,
}

impl<'a> Remarks<'a> {
    /// Of a measurement, with sentences about it.
    pub(super) const fn of(measurement: &Measurement, texts: &'a [String]) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc, of_this_pass: true }
    }
}
