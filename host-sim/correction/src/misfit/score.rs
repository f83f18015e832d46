//! How well a fit explains the points, by the noise that the job states.
//!
//! The fit finds the spread of the points from themselves and grows up to fourfold with them: points of another job look
//! like noisy ones. Here the stated noise counts, with what an honest wall adds to it.

use truepath_core::identify::{COUNT, Observation, Parameter};
use truepath_ground::hypotenuse::hypot;
use truepath_ground::rows::ascending;
use truepath_ground::units::mm;

/// What a wall is off beside the model: blanks that vary, runout, wear, the ball on a rough wall.
const ROUGH_MM: f64 = 0.004;
/// The share of an error that the model may miss.
const MODEL_SHARE: f64 = 0.03;
/// Residual, in deviations, from which it costs in proportion.
const HUBER: f64 = 2.5;
/// Residual, in deviations, from which it costs no more: whatever the point is of, it is not this wall.
const FAR: f64 = 25.0;

/// What a reading near the wall costs that is no point of it: as much as one that is far off.
pub const LOST: f64 = HUBER * (2.0 * FAR - HUBER);

/// Standard deviation that is expected of measured − predicted, mm.
pub fn expected_mm(o: &Observation) -> f64 {
    hypot(hypot(mm(o.noise), ROUGH_MM), MODEL_SHARE * mm(o.error))
}

/// Measured − predicted, mm.
pub fn residual_mm(o: &Observation) -> f64 {
    mm(o.error) - mm(o.predicted)
}

/// What a residual of so many deviations costs.
pub fn loss(residual: f64) -> f64 {
    let r = residual.abs().min(FAR);
    if r <= HUBER { r * r } else { HUBER * (2.0 * r - HUBER) }
}

/// Weight of a residual of so many deviations.
pub fn weight(residual: f64) -> f64 {
    (HUBER / residual.abs().max(1e-9)).min(1.0)
}

/// What it costs that parameters are so many prior standard deviations from what the job says: as in the fit, long tails
/// for the cross compliance and the undersize.
pub fn prior_cost(theta: &[f64; COUNT]) -> f64 {
    let long = |p: Parameter| matches!(p, Parameter::ComplianceCross | Parameter::Undersize);
    let each = theta.iter().zip(Parameter::ALL);
    each.map(|(t, p)| if long(p) { 3.0 * (1.0 + t * t / 2.0).ln() } else { t * t }).sum()
}

/// How well a fit explains the points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    /// Points.
    pub points: usize,
    /// Readings near the wall that were no point under these assumptions.
    pub lost: usize,
    /// What all of them and the parameters cost: near the number of points where everything is right.
    pub cost: f64,
    /// Root mean square of measured − predicted, mm.
    pub rms_mm: f64,
    /// Median of |measured − predicted| over its expected deviation.
    pub median: f64,
}

impl Score {
    /// Of points with predictions at parameters so many prior standard deviations from what the job says.
    pub fn of(theta: &[f64; COUNT], observations: &[Observation], lost: usize) -> Self {
        let mut residuals: Vec<f64> = observations.iter().map(|o| residual_mm(o).abs() / expected_mm(o)).collect();
        ascending(&mut residuals);
        let points = residuals.len();
        let square: f64 = observations.iter().map(|o| residual_mm(o).powi(2)).sum();
        let cost: f64 = residuals.iter().copied().map(loss).sum();
        Self {
            points,
            lost,
            cost: cost + lost as f64 * LOST + prior_cost(theta),
            rms_mm: (square / points.max(1) as f64).sqrt(),
            median: residuals.get(points / 2).copied().unwrap_or_default(),
        }
    }
}
