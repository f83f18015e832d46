//! How far the points really spread about the model, found from themselves.
//!
//! The stated noise of a probe is a guess: a worn stylus or a rough wall makes it twice as large, a good probe half.
//! Weighed with a wrong noise a fit follows the noise, or does not follow the points. So the
//! deviation of all points is multiplied by a factor κ with a scaled inverse χ² prior about 1, and its posterior mode goes with that of the parameters,
//! `κ² = (ν + Σ r²)/(ν + n − p)`: r the residuals in stated deviations, n the points, p the number of parameters that
//! they determine, `Σ (1 − variance left)`. Points set aside by the robust loss do not count.
//!
//! Limits: one factor for all points of a fit; κ is held to 1/3…4; two or three points leave it near 1.

use super::observation::Observation;
use super::parameters::COUNT;
use super::solve::Matrix;
use truepath_units::{Real, log2};

/// How many points the stated noise is worth, ν.
const STATED: Real = Real::from_int(4);
/// Residual, in deviations, above which a point says nothing about the noise of the others.
const FAR: Real = Real::ratio(35, 10);
const LEAST: Real = Real::ratio(1, 3);
const LARGEST: Real = Real::from_int(4);
/// ln 2
const LN_2: Real = Real::ratio(693_147_181, 1_000_000_000);

/// The factor κ on the stated noise after a fit with some factor, whose covariance is in units of the prior.
pub(super) fn found(observations: &[Observation], covariance: &Matrix) -> Real {
    let used = || observations.iter().filter(|o| o.residual().abs() <= FAR);
    let count = used().fold(Real::ZERO, |count, o| count + o.counts());
    let sum = used().fold(Real::ZERO, |sum, o| {
        // In deviations of the stated noise.
        let residual = o.residual() * o.spread;
        sum + residual * residual
    });
    let determined = (0..COUNT).fold(Real::ZERO, |sum, k| {
        let left = covariance.get(k).and_then(|row| row.get(k)).copied().unwrap_or(Real::ONE);
        sum + (Real::ONE - left).max(Real::ZERO)
    });
    let freedom = (count - determined).max(Real::ZERO);
    let square = (STATED + sum) / (STATED + freedom);
    square.sqrt().max(LEAST).min(LARGEST)
}

/// Gives all points the factor κ; their sensitivities are then in the new deviations.
pub(super) fn set(observations: &mut [Observation], factor: Real) {
    for o in observations {
        let before = o.deviation();
        o.spread = factor;
        let ratio = before.over(o.deviation());
        for sensitivity in &mut o.sensitivity {
            *sensitivity = *sensitivity * ratio;
        }
    }
}

/// What κ costs in −2 ln(probability): its prior and the width of the points' distribution.
pub(super) fn cost(observations: &[Observation], factor: Real) -> Real {
    let ln_square = log2(factor) * LN_2 * Real::from_int(2);
    let count = observations.iter().fold(Real::ZERO, |count, o| count + o.counts());
    (count + STATED) * ln_square + STATED * (Real::ONE / (factor * factor) - Real::ONE)
}
