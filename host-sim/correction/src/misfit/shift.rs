//! What a free datum, or a free size of the cutter, would change: a step of the normal equations at the fit that is there.
//!
//! The fit holds the datum to 1.5 µm and the size to what runout and wear leave. Both act on the measurement in a straight
//! line, so that letting them go takes no new fit: its sensitivities tell what the points would say. It costs some hundred
//! products a point, where a fit cuts the contour some hundred times.

use truepath_core::identify::{COUNT, Fit, Observation, Parameter, Prior};
use truepath_ground::hypotenuse::hypot;
use truepath_ground::units::{float, mm};

use super::fit::pull;
use super::score::{expected_mm, loss, prior_cost, residual_mm, weight};
use super::solve::solved;

/// What is let go.
const FREE_MM: f64 = 0.5;
/// Rounds in which the weights of the points settle.
const ROUNDS: usize = 8;

/// A datum that the points would have, were it free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// What the readings have too much in x and y, mm.
    pub datum_mm: [f64; 2],
    /// Its standard deviations, mm.
    pub sigma_mm: [f64; 2],
    /// By how much it lowers the cost of points and parameters.
    pub gain: f64,
    /// The cost that is left.
    pub left: f64,
}

impl Shift {
    /// Of a fit and its points.
    pub fn of(prior: &Prior, fit: &Fit, observations: &[Observation]) -> Self {
        let sigma = prior.sigma.map(float);
        let theta = fit.theta.map(float);
        let is_datum = |k: usize| matches!(Parameter::ALL[k], Parameter::DatumX | Parameter::DatumY);
        let rows: Vec<([f64; COUNT], f64)> = observations
            .iter()
            .map(|o| {
                let expected = expected_mm(o);
                let scale = mm(o.deviation()) / expected;
                (o.sensitivity.map(|s| float(s) * scale), residual_mm(o) / expected)
            })
            .collect();
        let held: [f64; COUNT] = std::array::from_fn(|k| if is_datum(k) { (sigma[k] / FREE_MM).powi(2) } else { 1.0 });
        let mut step = [0.0; COUNT];
        let mut matrix = [[0.0; COUNT]; COUNT];
        for _ in 0..ROUNDS {
            let at: [f64; COUNT] = std::array::from_fn(|k| theta[k] + step[k]);
            let mut right = [0.0; COUNT];
            for k in 0..COUNT {
                let pull = held[k] * pull(k, at[k]);
                matrix[k] = [0.0; COUNT];
                matrix[k][k] = pull;
                right[k] = -pull * theta[k];
            }
            for (row, residual) in &rows {
                let w = weight(left(row, &step, *residual));
                for i in 0..COUNT {
                    right[i] += w * row[i] * residual;
                    for j in 0..COUNT {
                        matrix[i][j] += w * row[i] * row[j];
                    }
                }
            }
            step = solved(&matrix, &right);
        }
        let at: [f64; COUNT] = std::array::from_fn(|k| theta[k] + step[k]);
        let before = rows.iter().map(|(_, r)| loss(*r)).sum::<f64>() + prior_cost(&theta);
        let own: [f64; COUNT] = std::array::from_fn(|k| if is_datum(k) { at[k] * held[k].sqrt() } else { at[k] });
        let after = rows.iter().map(|(row, r)| loss(left(row, &step, *r))).sum::<f64>() + prior_cost(&own);
        let deviation = |k: usize| {
            let mut unit = [0.0; COUNT];
            unit[k] = 1.0;
            solved(&matrix, &unit)[k].max(0.0).sqrt() * sigma[k]
        };
        let [x, y] = [COUNT - 2, COUNT - 1];
        Self {
            datum_mm: [at[x] * sigma[x], at[y] * sigma[y]],
            sigma_mm: [deviation(x), deviation(y)],
            gain: before - after,
            left: after,
        }
    }

    /// How far, mm.
    pub fn length_mm(&self) -> f64 {
        hypot(self.datum_mm[0], self.datum_mm[1])
    }
}

fn left(row: &[f64; COUNT], step: &[f64; COUNT], residual: f64) -> f64 {
    residual - row.iter().zip(step).map(|(s, t)| s * t).sum::<f64>()
}
