//! One contour in a line: what the table of a page of several contours says of each of them.

use serde::Serialize;
use truepath_ground::units::{mm, rounded};
use truepath_job::pass::Pass;

/// Where a contour lies in the program and how it came out. A command gives what it knows; a value that is not finite is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Outcome {
    /// First and last line of the pass that is shown, leads left out; absent in a program with one cut and no names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<[u32; 2]>,
    /// Its height, program coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    /// Its length.
    pub length_mm: f64,
    /// Largest magnitude of the wall error without the correction, or of the only pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before_mm: Option<f64>,
    /// Of the part that was measured, at its points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_mm: Option<f64>,
    /// With the correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after_mm: Option<f64>,
    /// Largest error at any height of the wall that the page is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile_mm: Option<f64>,
    /// Standard deviation of the error where that is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_mm: Option<f64>,
    /// Deepest cut below the wall, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gouge_mm: Option<f64>,
}

impl Outcome {
    /// Of a pass of which only the place is known.
    pub fn of(pass: &Pass) -> Self {
        let shown =
            pass.feature(&[]).and_then(|feature| feature.passes.into_iter().find(|row| row.pass == feature.pass));
        Self {
            lines: shown.as_ref().map(|row| [row.first_line, row.last_line]),
            z_mm: shown.and_then(|row| row.z_mm),
            length_mm: mm(pass.core.contour.length),
            ..Self::default()
        }
    }
}

/// A length to a nanometre; `None` for a value that is not finite.
pub(crate) fn known(value_mm: f64) -> Option<f64> {
    value_mm.is_finite().then(|| rounded(value_mm, 6))
}
