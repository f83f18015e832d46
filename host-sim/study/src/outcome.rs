//! What became of a case: one line of `cases.csv`.

use serde::{Deserialize, Serialize};

use super::case_table::Line;
use super::id::CaseId;

/// One line of the table. Lengths are in mm; what was not reached is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Name of the case.
    pub case: String,
    /// Why it failed; empty when it did not.
    pub failure: String,
    /// Why the second correction failed; empty when it did not, or was not asked for.
    pub learn_failure: String,
    /// Length of the contour.
    pub length_mm: Option<f64>,
    /// Touches of the first part.
    pub points: Option<u64>,
    /// Mean stiffness of the machine with its cutter, N/mm.
    pub stiffness_n_per_mm: Option<f64>,
    /// Largest wall error of the first part, mean over ten heights.
    pub before_mm: Option<f64>,
    /// The same after the first correction.
    pub after_mm: Option<f64>,
    /// before/after.
    pub factor: Option<f64>,
    /// What the model expected to remain.
    pub predicted_mm: Option<f64>,
    /// Largest sigma of the correction.
    pub sigma_mm: Option<f64>,
    /// Share of the contour where the error after lies within 2 sigma.
    pub coverage: Option<f64>,
    /// Root mean square before.
    pub rms_before_mm: Option<f64>,
    /// Root mean square after.
    pub rms_after_mm: Option<f64>,
    /// Deepest gouge after, of the mean over the heights; negative when material is left everywhere.
    pub gouge_mm: Option<f64>,
    /// Largest error at any height before.
    pub worst_height_before_mm: Option<f64>,
    /// Largest error at any height after.
    pub worst_height_mm: Option<f64>,
    /// worst_height_before/worst_height: the factor of the profile error.
    pub worst_height_factor: Option<f64>,
    /// What was expected of the largest error at any height after.
    pub worst_height_predicted_mm: Option<f64>,
    /// Standard deviation of that.
    pub worst_height_sigma_mm: Option<f64>,
    /// What 95 of 100 errors at any height are within before.
    pub p95_before_mm: Option<f64>,
    /// The same after.
    pub p95_mm: Option<f64>,
    /// What was expected of it.
    pub p95_predicted_mm: Option<f64>,
    /// Standard deviation of that.
    pub p95_sigma_mm: Option<f64>,
    /// What the mean over the height was expected to make of the largest error at any height after.
    pub cause_mean_mm: Option<f64>,
    /// What the helix was.
    pub cause_height_mm: Option<f64>,
    /// What bending of the cutter was.
    pub cause_bending_mm: Option<f64>,
    /// What the points leave open of it, one standard deviation.
    pub cause_noise_mm: Option<f64>,
    /// What the model lacks, one standard deviation.
    pub cause_not_modelled_mm: Option<f64>,
    /// Largest spread over the height after.
    pub axial_form_mm: Option<f64>,
    /// Wall law found.
    pub law: String,
    /// Parameters that the points decided.
    pub identified: String,
    /// Time of the correction, s.
    pub correct_s: Option<f64>,
    /// Largest wall error after one more part was probed and learned from.
    pub learned_mm: Option<f64>,
    /// before/learned.
    pub learned_factor: Option<f64>,
    /// What was expected to remain.
    pub learned_predicted_mm: Option<f64>,
    /// Share of the contour where the error after learning lies within 2 sigma.
    pub learned_coverage: Option<f64>,
    /// Largest error at any height after learning.
    pub learned_worst_height_mm: Option<f64>,
    /// worst_height_before/learned_worst_height.
    pub learned_worst_height_factor: Option<f64>,
    /// What was expected of it.
    pub learned_worst_height_predicted_mm: Option<f64>,
    /// Standard deviation of that.
    pub learned_worst_height_sigma_mm: Option<f64>,
    /// What 95 of 100 errors at any height are within after learning.
    pub learned_p95_mm: Option<f64>,
    /// What was expected of it.
    pub learned_p95_predicted_mm: Option<f64>,
    /// Standard deviation of that.
    pub learned_p95_sigma_mm: Option<f64>,
    /// Deepest gouge after learning, of the mean over the heights.
    pub learned_gouge_mm: Option<f64>,
    /// Largest wall error of the second part, cut with what exact knowledge of the first would have made of it.
    pub limit_mm: Option<f64>,
    /// before/limit.
    pub limit_factor: Option<f64>,
    /// The same of the third part with exact knowledge of the second.
    pub learned_limit_mm: Option<f64>,
    /// before/learned_limit.
    pub learned_limit_factor: Option<f64>,
    /// Whether learning went back to an earlier correction.
    pub rolled_back: Option<bool>,
    /// Time of learning, s.
    pub learn_s: Option<f64>,
}

impl Outcome {
    /// A case that could not be carried through.
    pub fn failed(case: &CaseId, why: impl Into<String>) -> Self {
        Self { case: case.to_string(), failure: one_line(&why.into()), ..Self::default() }
    }

    /// The name, read back.
    pub fn id(&self) -> Option<CaseId> {
        self.case.parse().ok()
    }

    /// Whether the largest error at any height came out within 2 sigma of what had been expected, after the first correction.
    pub fn worst_height_held(&self) -> Option<bool> {
        held(self.worst_height_mm, self.worst_height_predicted_mm, self.worst_height_sigma_mm)
    }

    /// The same after learning.
    pub fn learned_worst_height_held(&self) -> Option<bool> {
        held(self.learned_worst_height_mm, self.learned_worst_height_predicted_mm, self.learned_worst_height_sigma_mm)
    }

    /// Whether what 95 of 100 errors at any height are within came out within 2 sigma of what had been expected.
    pub fn p95_held(&self) -> Option<bool> {
        held(self.p95_mm, self.p95_predicted_mm, self.p95_sigma_mm)
    }

    /// The same after learning.
    pub fn learned_p95_held(&self) -> Option<bool> {
        held(self.learned_p95_mm, self.learned_p95_predicted_mm, self.learned_p95_sigma_mm)
    }

    /// Whether a correction made the part worse.
    pub fn worse(&self) -> bool {
        let worse = |after: Option<f64>| matches!((self.before_mm, after), (Some(b), Some(a)) if a > b);
        worse(self.after_mm) || worse(self.learned_mm)
    }
}

/// Whether a value lies within 2 sigma of what was expected.
fn held(value: Option<f64>, predicted: Option<f64>, sigma: Option<f64>) -> Option<bool> {
    Some((value? - predicted?).abs() <= 2.0 * sigma?)
}

impl Line for Outcome {
    fn case(&self) -> &str {
        &self.case
    }
}

/// Text on one line, for the table.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sigma_hold_from_both_sides_and_nothing_is_said_of_what_is_not_known() {
        let of = |value| Outcome {
            worst_height_mm: Some(value),
            worst_height_predicted_mm: Some(0.040),
            worst_height_sigma_mm: Some(0.005),
            ..Outcome::default()
        };
        let held: Vec<_> = [0.029, 0.031, 0.049, 0.051].map(|value| of(value).worst_height_held()).to_vec();
        assert_eq!(held, [Some(false), Some(true), Some(true), Some(false)]);
        assert_eq!(of(0.04).learned_worst_height_held(), None);
    }
}
