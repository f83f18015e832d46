//! What is to be said of a measurement in the summary of a correction.

use truepath_job::measurement::Measurement;

/// What a measurement leaves to be said.
#[derive(Clone, Copy, Debug)]
pub struct Remarks<'a> {
    /// Readings set aside.
    pub set_aside: usize,
    /// Sentences for the summary.
    pub texts: &'a [String],
    /// CRC-32 of the probe file.
    pub probe: u32,
    /// Whether it is of the pass that is corrected, and not of one before it.
    pub of_this_pass: bool,
}

impl<'a> Remarks<'a> {
    /// Of a measurement, with sentences about it.
    pub const fn of(measurement: &Measurement, texts: &'a [String]) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc, of_this_pass: true }
    }
}
