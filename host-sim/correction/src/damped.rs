//! Where the points say too little about the wall, so that only a share of the correction is applied.

use truepath_core::cut::Path;
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};

use crate::correction::Correction;

/// The stretch of the contour whose wall is known least.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DampedSummary {
    /// The least share of the correction that is applied, 0...1.
    pub least_share: f64,
    /// Standard deviation of the wall there, mm.
    pub sigma_mm: f64,
    /// Start of the stretch around that place, mm along the contour.
    pub from_s_mm: f64,
    /// Its end, mm along the contour.
    pub to_s_mm: f64,
}

impl DampedSummary {
    /// A sentence for the user.
    pub fn text(&self, unit: Unit) -> String {
        format!(
            "the points leave the wall at s = {:.1}..{:.1} {name} uncertain by up to {:.4} {name} (one sigma), nearly as much as it is wrong: only {:.0} % of the correction is applied there; probe a place there (truepath probe --next)",
            unit.of(self.from_s_mm),
            unit.of(self.to_s_mm),
            unit.of(self.sigma_mm),
            100.0 * self.least_share,
            name = unit.name()
        )
    }
}

/// Where a correction is applied in part, if anywhere.
pub fn damped_summary(path: &Path, correction: &Correction) -> Option<DampedSummary> {
    let damped = correction.damped?;
    let s = |at: usize| path.samples().get(path.first() + at).map_or(0.0, |sample| mm(sample.s));
    Some(DampedSummary {
        least_share: float(damped.least),
        sigma_mm: mm(damped.sigma),
        from_s_mm: s(damped.from),
        to_s_mm: s(damped.to),
    })
}
