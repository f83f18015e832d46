//! What became of a job of the shop: one line of the table.

use serde::{Deserialize, Serialize};

/// One line. Lengths are in mm; what was not reached is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShopOutcome {
    /// Name of the job, `machine-1/job-1`.
    pub case: String,
    /// Why it failed; empty when it did not.
    pub failure: String,
    /// What is milled.
    pub family: String,
    /// The material.
    pub material: String,
    /// Touches.
    pub points: Option<u64>,
    /// Largest wall error of the first part, mean over ten heights.
    pub before_mm: Option<f64>,
    /// After a correction with what the job states.
    pub alone_mm: Option<f64>,
    /// Share of the contour within 2 sigma of it.
    pub alone_coverage: Option<f64>,
    /// After a correction with what the jobs of other machines say as well.
    pub others_mm: Option<f64>,
    /// Share of the contour within 2 sigma of it.
    pub others_coverage: Option<f64>,
    /// Whether the points agreed with what others say.
    pub others_kept: Option<bool>,
    /// What the points contradicted most, in the words of the correction; empty for nothing.
    pub others_contradicted: String,
    /// After a correction with what all other jobs say, those of the same machine among them.
    pub all_mm: Option<f64>,
    /// Share of the contour within 2 sigma of it.
    pub all_coverage: Option<f64>,
    /// Whether the points agreed with what all others say.
    pub all_kept: Option<bool>,
    /// What the points contradicted most, in the words of the correction; empty for nothing.
    pub all_contradicted: String,
}
