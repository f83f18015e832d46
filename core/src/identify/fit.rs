//! The fit: Gauss–Newton with priors and a robust loss, and the evidence for a wall law.

use super::observation::{Observation, PredictionWorkspace, predict};
use super::parameters::{COUNT, Parameter, Parameters, Prior};
use super::solve::{Information, Matrix};
use crate::cut::{ForceTable, Path, WallLaw};
use crate::geometry::Vector;
use crate::units::{Offset, Real};

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

/// Gauss–Newton steps at most.
const MAX_STEPS: u32 = 12;
/// Residual, in standard deviations, from which a point loses weight (Huber's constant).
const HUBER: Real = Real::ratio(25, 10);
/// Residual, in standard deviations, from which a point is of something else: where at most a quarter of the points are,
/// the fit goes on without them.
const WILD: Real = Real::from_int(25);
/// Step of the difference quotients, in prior standard deviations.
const DIFFERENCE: Real = Real::ratio(1, 32);

impl Fit {
    /// Standard deviation of a parameter over that of its prior, 0…1: small where the points decide.
    pub fn remaining(&self, index: usize) -> Real {
        self.covariance.get(index).and_then(|row| row.get(index)).map_or(Real::ONE, |v| v.sqrt())
    }
}

/// Fits the parameters to the observations.
///
/// `commanded` is the displacement the program commanded at each sample when the probed part was cut. The path's
/// setup names the wall law. On return the observations hold predictions, weights and sensitivities at the solution.
pub fn identify(
    path: &Path,
    prior: &Prior,
    observations: &mut [Observation],
    commanded: impl Fn(usize) -> Vector + Copy,
    workspace: &mut PredictionWorkspace,
) -> Fit {
    identify_observed(path, prior, observations, commanded, workspace, &mut |_| ())
}

/// As [`identify`]; `observe` is told the share of the longest possible fit that is done, ‰, rising: a fit that settles
/// early ends before 1000.
pub fn identify_observed(
    path: &Path,
    prior: &Prior,
    observations: &mut [Observation],
    commanded: impl Fn(usize) -> Vector + Copy,
    workspace: &mut PredictionWorkspace,
    observe: &mut dyn FnMut(u16),
) -> Fit {
    let task = Task { path, prior, commanded };
    let mut table = ForceTable::BLANK;
    table.tabulate(prior.mean.coefficients.size_exponent);
    let mut theta = [Real::ZERO; COUNT];
    let (information, cost, mut steps) =
        task.settle(&mut table, &mut theta, Real::MAX, observations, workspace, observe);
    let ln_determinant = information.log2_determinant() * Real::ratio(693_147_181, 1_000_000_000);
    let evidence = -((cost + ln_determinant) * Real::HALF);
    let mut covariance = information.covariance();
    // A few points far off are of something else than this wall: they pull no more.
    let wild = observations.iter().filter(|o| o.residual().abs() > WILD).count();
    if wild > 0 && wild.saturating_mul(4) <= observations.len() {
        let quiet = &mut |_| ();
        let (information, _, more) = task.settle(&mut table, &mut theta, WILD, observations, workspace, quiet);
        covariance = information.covariance();
        steps = steps.saturating_add(more);
    }
    let outliers = observations.iter().filter(|o| o.weight < Real::ratio(3, 10)).count();
    Fit { parameters: prior.at(&theta), theta, covariance, cost, steps, outliers, evidence }
}

/// By how much the evidence for the mean law must exceed that for the helical one before it is believed (20 : 1).
const DECISIVE: Real = Real::from_int(3);

/// Identifies under both wall laws and takes the mean law only where the points speak decisively for it: on a
/// helical cutter it is the wrong one, and a few points at one height cannot tell.
///
/// `around` gives the prior for a law. Returns the law with its prior and fit; the observations hold its predictions.
pub fn identify_law(
    path: &Path,
    around: impl Fn(WallLaw) -> Prior,
    observations: &mut [Observation],
    commanded: impl Fn(usize) -> Vector + Copy,
    workspace: &mut PredictionWorkspace,
) -> (WallLaw, Prior, Fit) {
    identify_law_observed(path, around, observations, commanded, workspace, &mut |_| ())
}

/// As [`identify_law`], observed as [`identify_observed`].
pub fn identify_law_observed(
    path: &Path,
    around: impl Fn(WallLaw) -> Prior,
    observations: &mut [Observation],
    commanded: impl Fn(usize) -> Vector + Copy,
    workspace: &mut PredictionWorkspace,
    observe: &mut dyn FnMut(u16),
) -> (WallLaw, Prior, Fit) {
    let mut under = |law, observations: &mut [Observation], fits: u16| {
        let prior = around(law);
        let third = &mut |permille: u16| observe(fits.saturating_mul(1000).saturating_add(permille) / 3);
        let fit = identify_observed(&path.with_law(law), &prior, observations, commanded, workspace, third);
        (law, prior, fit)
    };
    let mean = under(WallLaw::Mean, observations, 0);
    let helical = under(WallLaw::Helical, observations, 1);
    if mean.2.evidence > helical.2.evidence + DECISIVE { under(WallLaw::Mean, observations, 2) } else { helical }
}

/// Share of the longest possible fit that is done after some steps and parameters of the next linearisation, ‰.
fn permille(steps: u32, parameters: usize) -> u16 {
    let done = steps.saturating_mul(COUNT as u32).saturating_add(parameters as u32).saturating_mul(1000);
    let whole = MAX_STEPS.saturating_add(1).saturating_mul(COUNT as u32);
    u16::try_from(done.checked_div(whole).unwrap_or(0)).unwrap_or(1000)
}

/// What is fitted: a machine believed in, on a path, at displacements that were commanded.
struct Task<'t, C> {
    path: &'t Path<'t>,
    prior: &'t Prior,
    commanded: C,
}

impl<C: Fn(usize) -> Vector + Copy> Task<'_, C> {
    /// Goes downhill from `theta` until the cost settles. Returns information, cost and steps taken; points beyond
    /// `gate` have no weight.
    fn settle(
        &self,
        table: &mut ForceTable,
        theta: &mut [Real; COUNT],
        gate: Real,
        observations: &mut [Observation],
        workspace: &mut PredictionWorkspace,
        observe: &mut dyn FnMut(u16),
    ) -> (Information, Real, u32) {
        let mut cost = self.evaluate(table, theta, gate, observations, workspace);
        let mut steps = 0;
        let mut information = self.linearise(table, theta, observations, workspace, &mut |k| observe(permille(0, k)));
        while steps < MAX_STEPS {
            steps = steps.saturating_add(1);
            let step = information.step();
            let largest = step.iter().map(|v| v.abs()).max().unwrap_or_default();
            // Backtracking: halve until the cost falls.
            let mut share = Real::ONE;
            let (taken, new_cost) = loop {
                let mut trial = *theta;
                for (t, s) in trial.iter_mut().zip(&step) {
                    *t += *s * share;
                }
                let trial_cost = self.evaluate(table, &trial, gate, observations, workspace);
                if trial_cost <= cost {
                    break (Some(trial), trial_cost);
                }
                share = share * Real::HALF;
                if share < Real::ratio(1, 40) {
                    break (None, cost);
                }
            };
            let Some(accepted) = taken else { break };
            *theta = accepted;
            let settled = largest < Real::ratio(1, 2000) || cost - new_cost < Real::ratio(1, 100_000);
            cost = new_cost;
            let tell = &mut |k| observe(permille(steps, k));
            information = self.linearise(table, theta, observations, workspace, tell);
            if settled {
                break;
            }
        }
        cost = self.evaluate(table, theta, gate, observations, workspace);
        (information, cost, steps)
    }

    /// Predicts all points and returns the robust cost; sets their weights.
    fn evaluate(
        &self,
        table: &mut ForceTable,
        theta: &[Real; COUNT],
        gate: Real,
        observations: &mut [Observation],
        workspace: &mut PredictionWorkspace,
    ) -> Real {
        let parameters = self.prior.at(theta);
        renew(table, &parameters);
        predict(self.path, table, &parameters, self.commanded, observations, workspace);
        let mut cost = theta.iter().fold(Real::ZERO, |sum, t| sum + *t * *t);
        for o in observations.iter_mut() {
            let residual = o.residual().abs();
            // Huber: quadratic near zero, linear in the tails, level beyond the gate.
            (o.weight, cost) = if residual <= HUBER {
                (Real::ONE, cost + residual * residual)
            } else if residual > gate {
                (Real::ZERO, cost + HUBER * (gate + gate - HUBER))
            } else {
                (HUBER / residual, cost + HUBER * (residual + residual - HUBER))
            };
        }
        cost
    }

    /// Sensitivities and the normal equations at a point just evaluated; `observe` is told how many parameters are done.
    ///
    /// Radius and datum act on the measurement and are known; the others are central difference quotients, so that a
    /// parameter whose sign turns with the part has the same sensitivity with the other sign.
    fn linearise(
        &self,
        table: &ForceTable,
        theta: &[Real; COUNT],
        observations: &mut [Observation],
        workspace: &mut PredictionWorkspace,
        observe: &mut dyn FnMut(usize),
    ) -> Information {
        let mut changed = ForceTable::BLANK;
        for (k, (parameter, sigma)) in Parameter::ALL.iter().zip(&self.prior.sigma).enumerate() {
            observe(k);
            let direct = |o: &Observation| match parameter {
                Parameter::Radius => Some(Real::ONE),
                Parameter::DatumX => Some(-o.normal.x),
                Parameter::DatumY => Some(-o.normal.y),
                _ => None,
            };
            for o in observations.iter_mut() {
                let value = direct(o).map(|d| Offset::from_mm(*sigma).over(o.deviation()) * d);
                set(o, k, value.unwrap_or(Real::ZERO));
            }
            if *sigma == Real::ZERO || observations.iter().any(|o| direct(o).is_some()) {
                continue;
            }
            for side in [DIFFERENCE, -DIFFERENCE] {
                let mut moved = *theta;
                if let Some(t) = moved.get_mut(k) {
                    *t += side;
                }
                let parameters = self.prior.at(&moved);
                let table = if parameters.coefficients.size_exponent == table.size_exponent() {
                    table
                } else {
                    changed.tabulate(parameters.coefficients.size_exponent);
                    &changed
                };
                // The prediction at the point itself is needed again: it is kept aside.
                for o in observations.iter_mut() {
                    o.base = o.predicted;
                }
                predict(self.path, table, &parameters, self.commanded, observations, workspace);
                for o in observations.iter_mut() {
                    let change = (o.predicted - o.base).over(o.deviation()) / (side + side);
                    o.predicted = o.base;
                    let sum = o.sensitivity.get(k).copied().unwrap_or_default() + change;
                    set(o, k, sum);
                }
            }
        }
        let mut information = Information::prior(theta);
        for o in observations.iter() {
            information.add(&o.sensitivity, o.residual(), o.weight);
        }
        information
    }
}

fn set(observation: &mut Observation, k: usize, value: Real) {
    if let Some(slot) = observation.sensitivity.get_mut(k) {
        *slot = value;
    }
}

fn renew(table: &mut ForceTable, parameters: &Parameters) {
    if table.size_exponent() != parameters.coefficients.size_exponent {
        table.tabulate(parameters.coefficients.size_exponent);
    }
}
