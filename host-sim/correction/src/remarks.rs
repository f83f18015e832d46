//! What is to be said of a measurement in the summary of a correction.

use truepath_job::measurement::Measurement;

/// The part that was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredPart {
    /// Cut by the pass that is corrected, without a correction.
    Uncorrected,
    /// Cut by that pass with a correction.
    Corrected,
    /// Cut by the pass before it only.
    FirstPass,
}

/// What a measurement leaves to be said.
#[derive(Clone, Copy, Debug)]
pub struct Remarks<'a> {
    /// Readings set aside.
    pub set_aside: usize,
    /// Sentences for the summary.
    pub texts: &'a [String],
    /// CRC-32 of the probe file.
    pub probe: u32,
    /// The measurement.
    pub measurement: &'a Measurement,
    /// What it is of.
    pub part: MeasuredPart,
}

impl<'a> Remarks<'a> {
    /// Of the measurement of a part, with sentences about it.
    pub const fn of(measurement: &'a Measurement, texts: &'a [String], part: MeasuredPart) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc, measurement, part }
    }
}
