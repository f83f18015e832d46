//! The robust loss: a wrong point must not bend the fit of the others.
//!
//! Huber's loss is quadratic near zero and linear in the tails; beyond a gate it is level, and the point has no weight.

use super::observation::Observation;
use truepath_units::Real;

/// Residual, in standard deviations, from which a point loses weight (Huber's constant).
const HUBER: Real = Real::ratio(25, 10);

/// Sets the weight of a point for its residual and returns what it costs.
pub(super) fn weigh(o: &mut Observation, gate: Real) -> Real {
    let residual = o.residual().abs();
    let (weight, cost) = if residual <= HUBER {
        (Real::ONE, residual * residual)
    } else if residual > gate {
        (Real::ZERO, HUBER * (gate + gate - HUBER))
    } else {
        (HUBER / residual, HUBER * (residual + residual - HUBER))
    };
    o.weight = weight;
    cost
}
