//! What it costs to be away from the prior.
//!
//! Most quantities are believed in with a Gaussian. Two are next to nothing on most machines and large on a few: the cross
//! compliance (a machine with straight guides, and a soft one whose guides stand askew) and the undersize of the cutter (a
//! good holder, and one with runout). They follow Student's t with two degrees of freedom, −2 ln p = 3 ln(1 + θ²/2): held
//! firmly near zero where the points hardly tell, let go where they do. Fitted by the weights 3/(2 + θ²) of the
//! distances (iteratively reweighted least squares).

use super::parameters::{COUNT, Parameter};
use truepath_units::{Real, log2};

/// 3·ln 2
const THREE_LN_2: Real = Real::ratio(2_079_441_542, 1_000_000_000);
const TWO: Real = Real::from_int(2);
const THREE: Real = Real::from_int(3);

const fn is_long_tailed(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::ComplianceCross | Parameter::Undersize)
}

/// −2 ln(probability) of parameters `theta` standard deviations from their expected values, up to a constant.
pub(super) fn cost(theta: &[Real; COUNT]) -> Real {
    theta.iter().zip(Parameter::ALL).fold(Real::ZERO, |sum, (t, parameter)| {
        let square = *t * *t;
        sum + if is_long_tailed(parameter) { THREE_LN_2 * log2(Real::ONE + square * Real::HALF) } else { square }
    })
}

/// By how much the prior draws each parameter back, per standard deviation of distance.
pub fn weights(theta: &[Real; COUNT]) -> [Real; COUNT] {
    let mut weights = [Real::ONE; COUNT];
    for ((weight, t), parameter) in weights.iter_mut().zip(theta).zip(Parameter::ALL) {
        if is_long_tailed(parameter) {
            *weight = THREE / (TWO + *t * *t);
        }
    }
    weights
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests index what they have made")]
mod tests {
    use super::*;

    #[test]
    fn the_weights_are_the_slopes_of_the_cost() {
        for millis in [-4000i64, -700, 0, 300, 2000, 9000] {
            let theta = [Real::ratio(millis, 1000); COUNT];
            for k in 0..COUNT {
                let step = Real::ratio(1, 1000);
                let cost_at = |by: Real| {
                    let mut moved = [Real::ZERO; COUNT];
                    moved[k] = theta[k] + by;
                    cost(&moved)
                };
                let slope = (cost_at(step) - cost_at(-step)) / (step + step);
                // Half the slope of −2 ln p is what the normal equations take.
                let taken = weights(&theta)[k] * theta[k];
                assert!(
                    (slope * Real::HALF - taken).abs() < Real::ratio(1, 100),
                    "{k} at {millis}: {slope:?} {taken:?}"
                );
            }
        }
    }
}
