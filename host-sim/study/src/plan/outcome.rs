//! What became of a case: one line of the table.

use serde::{Deserialize, Serialize};

use crate::case_table::Line;

/// One line. Lengths are in mm; what was not reached is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanOutcome {
    /// Name of the case, `plan/1001`.
    pub case: String,
    /// Why it failed; empty when it did not.
    pub failure: String,
    /// What is milled.
    pub kind: String,
    /// Law of bending of the machine.
    pub bend_law: String,
    /// Cutter diameter.
    pub diameter_mm: Option<f64>,
    /// Teeth.
    pub teeth: Option<u64>,
    /// Helix angle, degrees.
    pub helix_deg: Option<f64>,
    /// Wall height over the depth of an axial contact ratio of one.
    pub contact_ratio: Option<f64>,
    /// Stock on the wall.
    pub allowance_mm: Option<f64>,
    /// Mean stiffness of the machine with its cutter, N/mm.
    pub stiffness_n_per_mm: Option<f64>,
    /// Standard deviation of a touch, um.
    pub noise_um: Option<f64>,
    /// Length of the contour.
    pub length_mm: Option<f64>,
    /// Largest error at any height, as programmed.
    pub before_mm: Option<f64>,
    /// Half the width of the tolerance.
    pub tolerance_mm: Option<f64>,
    /// Whether a choice was expected to hold it.
    pub recommended: Option<bool>,
    /// The process that was cut, in words.
    pub process: String,
    /// Its passes.
    pub passes: Option<u64>,
    /// Its machining time over that of the program.
    pub time_ratio: Option<f64>,
    /// The profile error that was predicted.
    pub predicted_mm: Option<f64>,
    /// Its standard deviation.
    pub sigma_mm: Option<f64>,
    /// What 95 % of the wall were expected to be within.
    pub p95_predicted_mm: Option<f64>,
    /// Standard deviation of that.
    pub p95_sigma_mm: Option<f64>,
    /// What the mean over the height was expected to make of the largest error.
    pub cause_mean_mm: Option<f64>,
    /// What the helix was.
    pub cause_height_mm: Option<f64>,
    /// What bending of the cutter was.
    pub cause_bending_mm: Option<f64>,
    /// What the points leave open of it, one standard deviation.
    pub cause_noise_mm: Option<f64>,
    /// What the model lacks, one standard deviation.
    pub cause_not_modelled_mm: Option<f64>,
    /// Largest error at any height, as cut.
    pub after_mm: Option<f64>,
    /// What 95 % of the wall are within.
    pub p95_mm: Option<f64>,
    /// Deepest gouge.
    pub gouge_mm: Option<f64>,
    /// Largest mean over the height.
    pub mean_mm: Option<f64>,
    /// before/after.
    pub factor: Option<f64>,
    /// Time of the plan, s.
    pub plan_s: Option<f64>,
}

impl Line for PlanOutcome {
    fn case(&self) -> &str {
        &self.case
    }
}

impl PlanOutcome {
    /// Whether the wall is within the tolerance.
    pub fn holds(&self) -> Option<bool> {
        Some(self.after_mm? <= self.tolerance_mm?)
    }

    /// By how many standard deviations the wall is worse than predicted.
    pub fn off_by_sigma(&self) -> Option<f64> {
        Some((self.after_mm? - self.predicted_mm?) / self.sigma_mm?)
    }
}
