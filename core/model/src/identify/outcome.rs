//! What a fit found.

use super::parameters::{COUNT, Parameters};
use super::solve::Matrix;
use truepath_units::Real;

/// Result of an identification.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The identified parameters.
    pub parameters: Parameters,
    /// Distance from the prior, in its standard deviations.
    pub theta: [Real; COUNT],
    /// Covariance in units of the prior's standard deviations; its diagonal is 1 where the points say nothing.
    pub covariance: Matrix,
    /// Robust sum of squared residuals plus that of the prior, of all points.
    pub cost: Real,
    /// Gauss–Newton steps taken.
    pub steps: u32,
    /// Points that the robust loss set aside (weight below 0.3).
    pub outliers: usize,
    /// Evidence of the model, −½(cost + ln det), natural logarithm up to a constant; larger is better.
    pub evidence: Real,
}

impl Fit {
    /// Standard deviation of a parameter over that of its prior, 0…1: small where the points decide.
    pub fn remaining(&self, index: usize) -> Real {
        self.covariance.get(index).and_then(|row| row.get(index)).map_or(Real::ONE, |v| v.sqrt())
    }
}
