//! What is to be said of a measurement in the summary of a correction.

use truepath_ground::length::Remark;
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
    pub texts: &'a [Remark],
    /// CRC-32 of the probe file.
    pub probe: u32,
    /// The measurement.
    pub measurement: &'a Measurement,
    /// What it is of.
    pub part: MeasuredPart,
}

impl<'a> Remarks<'a> {
    /// Of the measurement of a part, with sentences about it.
    pub const fn of(measurement: &'a Measurement, texts: &'a [Remark], part: MeasuredPart) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc, measurement, part }
    }
}

/// What is said of several contours, each with its name: what is said of the program, or of several of them in the same words,
/// is said once and without a name.
pub fn said_of_every<'a>(contours: impl IntoIterator<Item = (&'a str, &'a [Remark])>) -> Vec<Remark> {
    let contours: Vec<(&str, &[Remark])> = contours.into_iter().collect();
    let mut said: Vec<Remark> = Vec::new();
    for (at, (name, own)) in contours.iter().enumerate() {
        for text in *own {
            let others = contours.iter().enumerate().filter(|(other, _)| *other != at);
            let is_common = others.into_iter().any(|(_, (_, theirs))| theirs.contains(text));
            let text = if is_common { text.clone() } else { text.map(|text| format!("{name}: {text}")) };
            if !said.contains(&text) {
                said.push(text);
            }
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::{Remark, said_of_every};

    #[test]
    fn what_several_contours_say_is_said_once() {
        let [a, b] = [["no %", "a wild point"], ["no %", "a sharp corner"]].map(|said| said.map(Remark::from));
        let said = said_of_every([("contour-1", &a[..]), ("contour-2", &b[..])]);
        assert_eq!(
            said.iter().map(|said| &**said).collect::<Vec<_>>(),
            ["no %", "contour-1: a wild point", "contour-2: a sharp corner"]
        );
    }
}
