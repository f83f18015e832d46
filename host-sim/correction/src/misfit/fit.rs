//! A fit that is made many times, under one assumption after the other.
//!
//! The fit of the core ([`truepath_core::identify`]) finds the last nanometre and the noise of the points; where an
//! assumption is wrong it goes on for thousands of cuts. To tell right from wrong assumptions the bottom of the valley is
//! enough: Levenberg–Marquardt steps with one-sided differences, the noise as stated, chip-size effect and ratio of the edge
//! forces held.

use truepath_core::cut::{ForceTable, Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{COUNT, Observation, Parameter, PredictionWorkspace, Prior, predict};
use truepath_ground::units::{float, mm, real};

use super::score::{expected_mm, loss, prior_cost, residual_mm, weight};
use super::solve::solved;
use crate::force_tables::force_table;

/// Steps at most.
const STEPS: usize = 10;
/// A step that gains less is the last.
const LEAST_GAIN: f64 = 0.3;
/// Step of the difference quotients, prior standard deviations.
const DIFFERENCE: f64 = 1.0 / 16.0;

/// What is fitted.
pub(super) struct Fitting<'a> {
    pub(super) path: &'a Path<'a>,
    /// The same with more or less stock, and what that costs a place; none where the stock is even.
    pub(super) others: &'a [(Path<'a>, f64)],
    pub(super) prior: Prior,
    pub(super) observations: Vec<Observation>,
    /// Of which of them every place is; empty for the path itself.
    pub(super) stocks: Vec<usize>,
}

impl Fitting<'_> {
    /// Goes downhill; the observations then hold the predictions there. Returns the parameters in prior standard
    /// deviations, and the cost.
    pub(super) fn settle(&mut self) -> ([f64; COUNT], f64) {
        let needed = self.path.working().len() + 1;
        let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
        let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
        let table = force_table(&self.prior.mean);
        let sigma = self.prior.sigma.map(float);
        let mut theta = [0.0; COUNT];
        let mut cost = self.cost(&theta, &table, &mut workspace);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            if !self.others.is_empty() {
                cost = self.choose(&theta, &table, &mut workspace);
            }
            let (mut matrix, mut right) = self.linearised(&theta, &sigma, &table, &mut workspace);
            for (k, t) in theta.iter().enumerate() {
                let pull = pull(k, *t);
                matrix[k][k] += pull;
                right[k] -= pull * t;
            }
            let mut taken = None;
            for _ in 0..4 {
                let mut damped = matrix;
                for (k, row) in damped.iter_mut().enumerate() {
                    row[k] *= 1.0 + damping;
                }
                let step = solved(&damped, &right);
                let trial: [f64; COUNT] = std::array::from_fn(|k| (theta[k] + step[k]).clamp(-300.0, 300.0));
                let now = self.cost(&trial, &table, &mut workspace);
                if now < cost {
                    taken = Some((trial, now));
                    damping *= 0.2;
                    break;
                }
                damping *= 10.0;
            }
            let Some((next, now)) = taken else { break };
            let gain = cost - now;
            (theta, cost) = (next, now);
            if gain < LEAST_GAIN {
                break;
            }
        }
        self.predict(&theta, &table, &mut workspace);
        (theta, cost)
    }

    fn predict(&mut self, theta: &[f64; COUNT], table: &ForceTable, workspace: &mut PredictionWorkspace) {
        let parameters = self.prior.at(&theta.map(real));
        predict(self.path, table, &parameters, |_| Vector::ZERO, &mut self.observations, workspace);
        if self.stocks.iter().all(|stock| *stock == 0) {
            return;
        }
        for (k, (path, _)) in self.others.iter().enumerate() {
            let mut other = self.observations.clone();
            predict(path, table, &parameters, |_| Vector::ZERO, &mut other, workspace);
            let places = self.observations.chunk_by_mut(same_place).zip(other.chunk_by(same_place));
            for ((place, other), _) in places.zip(&self.stocks).filter(|(_, stock)| **stock == k + 1) {
                place.copy_from_slice(other);
            }
        }
    }

    fn cost(&mut self, theta: &[f64; COUNT], table: &ForceTable, workspace: &mut PredictionWorkspace) -> f64 {
        self.predict(theta, table, workspace);
        let stocks = self.stocks.iter().filter_map(|stock| self.others.get(stock.checked_sub(1)?));
        of_points(&self.observations) + stocks.map(|(_, cost)| cost).sum::<f64>() + prior_cost(theta)
    }

    /// Gives every place the stock that explains it best at these parameters; returns the cost.
    fn choose(&mut self, theta: &[f64; COUNT], table: &ForceTable, workspace: &mut PredictionWorkspace) -> f64 {
        self.stocks.clear();
        self.predict(theta, table, workspace);
        let mut best: Vec<(f64, usize)> =
            self.observations.chunk_by(same_place).map(|place| (of_points(place), 0)).collect();
        let parameters = self.prior.at(&theta.map(real));
        for (k, (path, cost)) in self.others.iter().enumerate() {
            let mut other = self.observations.clone();
            predict(path, table, &parameters, |_| Vector::ZERO, &mut other, workspace);
            for (best, place) in best.iter_mut().zip(other.chunk_by(same_place)) {
                let its = of_points(place) + cost;
                if its < best.0 {
                    *best = (its, k + 1);
                }
            }
        }
        self.stocks = best.iter().map(|(_, stock)| *stock).collect();
        self.cost(theta, table, workspace)
    }

    /// Normal equations of the points at parameters just predicted.
    fn linearised(
        &mut self,
        theta: &[f64; COUNT],
        sigma: &[f64; COUNT],
        table: &ForceTable,
        workspace: &mut PredictionWorkspace,
    ) -> ([[f64; COUNT]; COUNT], [f64; COUNT]) {
        let expected: Vec<f64> = self.observations.iter().map(expected_mm).collect();
        let at: Vec<f64> = self.observations.iter().map(|o| mm(o.predicted)).collect();
        let residuals: Vec<f64> = self.observations.iter().zip(&expected).map(|(o, e)| residual_mm(o) / e).collect();
        let mut rows = vec![[0.0; COUNT]; at.len()];
        for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
            if sigma[k] == 0.0 || matches!(parameter, Parameter::SizeExponent | Parameter::EdgeRatio) {
                continue;
            }
            let direct = |o: &Observation| match parameter {
                Parameter::Undersize => Some(1.0),
                Parameter::DatumX => Some(float(o.by_datum()[0])),
                Parameter::DatumY => Some(float(o.by_datum()[1])),
                _ => None,
            };
            if self.observations.iter().any(|o| direct(o).is_some()) {
                for ((row, o), e) in rows.iter_mut().zip(&self.observations).zip(&expected) {
                    row[k] = direct(o).unwrap_or(0.0) * sigma[k] / e;
                }
                continue;
            }
            let mut moved = *theta;
            moved[k] += DIFFERENCE;
            self.predict(&moved, table, workspace);
            for (((row, o), e), at) in rows.iter_mut().zip(&self.observations).zip(&expected).zip(&at) {
                row[k] = (mm(o.predicted) - at) / DIFFERENCE / e;
            }
        }
        let (mut matrix, mut right) = ([[0.0; COUNT]; COUNT], [0.0; COUNT]);
        for (row, residual) in rows.iter().zip(&residuals) {
            let w = weight(*residual);
            for i in 0..COUNT {
                right[i] += w * row[i] * residual;
                for j in 0..COUNT {
                    matrix[i][j] += w * row[i] * row[j];
                }
            }
        }
        (matrix, right)
    }
}

/// What points cost by their residuals.
fn of_points(points: &[Observation]) -> f64 {
    points.iter().map(|o| loss(residual_mm(o) / expected_mm(o))).sum()
}

/// Whether two points are of one place.
fn same_place(a: &Observation, b: &Observation) -> bool {
    a.s == b.s
}

/// By how much the prior draws a parameter back, per standard deviation of distance.
pub(super) fn pull(parameter: usize, theta: f64) -> f64 {
    let long = matches!(Parameter::ALL[parameter], Parameter::ComplianceCross | Parameter::Undersize);
    if long { 3.0 / (2.0 + theta * theta) } else { 1.0 }
}
