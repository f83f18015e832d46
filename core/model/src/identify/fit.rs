//! The fit: Gauss–Newton with priors and a robust loss, over one part or several.

use super::observation::{Observation, PredictionWorkspace, join_pairs, predict};
use super::parameters::{COUNT, Parameter, Parameters, Prior};
use super::part::EarlierPart;
use super::solve::{Information, Matrix};
use super::spread;
use super::tails;
use crate::cut::{ForceTable, Path};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// Gauss–Newton steps at most.
const MAX_STEPS: u32 = 12;
/// Residual, in standard deviations, from which a point is of something else: where at most a quarter of the points are,
/// the fit goes on without them.
const WILD: Real = Real::from_int(25);
/// Times the spread of the points is found anew.
const SPREADS: usize = 4;
/// Step of the difference quotients, in prior standard deviations.
const DIFFERENCE: Real = Real::ratio(1, 32);

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

/// The points of one contour of one part.
#[derive(Clone, Copy, Debug)]
pub struct Cut<'a> {
    /// The path along which it was cut; its setup names the wall law.
    pub path: Path<'a>,
    /// How many of the observations are of it; those of the cuts stand one behind the other.
    pub points: usize,
    /// The part, counted from 0; the cuts of a part stand together, in the order of the parts.
    pub part: usize,
}

/// Fits the parameters to the observations of the cuts that one machine made with one cutter, on one or several parts.
///
/// Both halves of a [pair](Observation::paired) are among the observations, each with those of its own cut, and no two pairs
/// of all parts have one number. The observations are those of the cuts in their order: those of the `earlier` parts, one part behind the other, then
/// those of the last. `commanded(cut, sample)` is the displacement that the program commanded at a sample of a cut, counted
/// from 0. Every part has a datum of its own, which all its contours share; that of [`Fit::parameters`] is the last one's,
/// the others are left in `earlier`. `observe` is told the share of the longest possible fit that is done, ‰, rising: a
/// fit that settles early ends before 1000. On return the observations hold predictions, weights and sensitivities at
/// the solution.
pub fn identify(
    cuts: &[Cut],
    prior: &Prior,
    earlier: &mut [EarlierPart],
    observations: &mut [Observation],
    commanded: impl Fn(usize, usize) -> Vector + Copy,
    workspace: &mut PredictionWorkspace,
    observe: &mut dyn FnMut(u16),
) -> Fit {
    Task { cuts, prior, commanded }.fit(earlier, observations, workspace, observe)
}

/// Share of the longest possible fit that is done after some steps and parameters of the next linearisation, ‰.
fn permille(steps: u32, parameters: usize) -> u16 {
    let done = steps.saturating_mul(COUNT as u32).saturating_add(parameters as u32).saturating_mul(1000);
    let whole = MAX_STEPS.saturating_add(1).saturating_mul(COUNT as u32);
    u16::try_from(done.checked_div(whole).unwrap_or(0)).unwrap_or(1000)
}

/// What is fitted: a machine believed in, on the paths of its cuts, at displacements that were commanded.
struct Task<'t, C> {
    cuts: &'t [Cut<'t>],
    prior: &'t Prior,
    commanded: C,
}

/// The points at which a fit looks, part by part, and the memory they are predicted in.
struct Points<'p, 'w> {
    earlier: &'p mut [EarlierPart],
    observations: &'p mut [Observation],
    workspace: &'p mut PredictionWorkspace<'w>,
}

impl<C: Fn(usize, usize) -> Vector + Copy> Task<'_, C> {
    #[inline(never)]
    fn fit(
        &self,
        earlier: &mut [EarlierPart],
        observations: &mut [Observation],
        workspace: &mut PredictionWorkspace,
        observe: &mut dyn FnMut(u16),
    ) -> Fit {
        let prior = self.prior;
        let mut table = ForceTable::BLANK;
        table.tabulate(prior.mean.coefficients.size_exponent);
        let mut theta = [Real::ZERO; COUNT];
        for part in earlier.iter_mut() {
            *part = EarlierPart::new(part.points);
        }
        let mut points = Points { earlier, observations, workspace };
        spread::set(points.observations, Real::ONE);
        let (mut information, mut cost, mut steps) =
            self.settle(&mut table, &mut theta, Real::MAX, &mut points, observe);
        let quiet = &mut |_| ();
        // A few points far off are of something else than this wall: they pull no more, and say nothing of the noise.
        let wild = points.observations.iter().filter(|o| o.residual().abs() > WILD).count();
        let gate = if wild.saturating_mul(4) <= points.observations.len() { WILD } else { Real::MAX };
        if wild > 0 && gate == WILD {
            let (again, its_cost, more) = self.settle(&mut table, &mut theta, gate, &mut points, quiet);
            (information, cost, steps) = (again, its_cost, steps.saturating_add(more));
        }
        // How far the points spread about the model is found from themselves, and weighs them.
        let mut factor = Real::ONE;
        for _ in 0..SPREADS {
            let found = spread::found(points.observations, &information.covariance());
            if (found - factor).abs() < factor * Real::ratio(1, 20) {
                break;
            }
            factor = found;
            spread::set(points.observations, factor);
            let (again, its_cost, more) = self.settle(&mut table, &mut theta, gate, &mut points, quiet);
            (information, cost, steps) = (again, its_cost, steps.saturating_add(more));
        }
        let taken_out = points.earlier.iter().fold(Real::ZERO, |sum, part| sum + part.eliminated.log2_determinant());
        let ln_determinant = (information.log2_determinant() + taken_out) * Real::ratio(693_147_181, 1_000_000_000);
        let evidence = -((cost + ln_determinant + spread::cost(points.observations, factor)) * Real::HALF);
        let covariance = information.covariance();
        let outliers = points.observations.iter().filter(|o| o.is_outlying()).count();
        Fit { parameters: prior.at(&theta), theta, covariance, cost, steps, outliers, evidence }
    }

    /// Goes downhill from `theta` until the cost settles. Returns information, cost and steps taken; points beyond
    /// `gate` have no weight.
    fn settle(
        &self,
        table: &mut ForceTable,
        theta: &mut [Real; COUNT],
        gate: Real,
        points: &mut Points,
        observe: &mut dyn FnMut(u16),
    ) -> (Information, Real, u32) {
        let mut cost = self.evaluate(table, theta, gate, points);
        let mut steps = 0;
        let mut information = self.linearise(table, theta, points, &mut |k| observe(permille(0, k)));
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
                for part in points.earlier.iter_mut() {
                    part.look(&step, share);
                }
                let trial_cost = self.evaluate(table, &trial, gate, points);
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
            for part in points.earlier.iter_mut() {
                part.datum = part.trial;
            }
            let settled = largest < Real::ratio(1, 2000) || cost - new_cost < Real::ratio(1, 100_000);
            cost = new_cost;
            information = self.linearise(table, theta, points, &mut |k| observe(permille(steps, k)));
            if settled {
                break;
            }
        }
        for part in points.earlier.iter_mut() {
            part.trial = part.datum;
        }
        cost = self.evaluate(table, theta, gate, points);
        (information, cost, steps)
    }

    /// Predicts the points of every cut with its own correction and the datum of its part.
    fn predict(&self, table: &ForceTable, parameters: &Parameters, points: &mut Points) {
        let mut rest = &mut *points.observations;
        for (k, cut) in self.cuts.iter().enumerate() {
            let datum = points.earlier.get(cut.part).map_or(parameters.datum, |part| part.trial_datum(self.prior));
            let (own, others) = rest.split_at_mut(cut.points.min(rest.len()));
            let parameters = Parameters { datum, ..*parameters };
            predict(&cut.path, table, &parameters, |i| (self.commanded)(k, i), own, points.workspace);
            rest = others;
        }
        join_pairs(points.observations);
    }

    /// Predicts all points and returns the robust cost; sets their weights.
    fn evaluate(&self, table: &mut ForceTable, theta: &[Real; COUNT], gate: Real, points: &mut Points) -> Real {
        let parameters = self.prior.at(theta);
        renew(table, &parameters);
        self.predict(table, &parameters, points);
        let datums = points.earlier.iter().flat_map(|part| &part.trial);
        let mut cost = datums.fold(tails::cost(theta), |sum, t| sum + *t * *t);
        for o in points.observations.iter_mut() {
            cost += o.weigh(gate);
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
        points: &mut Points,
        observe: &mut dyn FnMut(usize),
    ) -> Information {
        let mut changed = ForceTable::BLANK;
        for (k, (parameter, sigma)) in Parameter::ALL.iter().zip(&self.prior.sigma).enumerate() {
            observe(k);
            let direct = |o: &Observation| match parameter {
                Parameter::Undersize => Some(Real::ONE),
                Parameter::DatumX => Some(o.by_datum()[0]),
                Parameter::DatumY => Some(o.by_datum()[1]),
                _ => None,
            };
            for o in points.observations.iter_mut() {
                let value = direct(o).map(|d| Offset::from_mm(*sigma).over(o.deviation()) * d);
                set(o, k, value.unwrap_or(Real::ZERO));
            }
            if *sigma == Real::ZERO || points.observations.iter().any(|o| direct(o).is_some()) {
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
                for o in points.observations.iter_mut() {
                    o.base = o.predicted;
                }
                self.predict(table, &parameters, points);
                for o in points.observations.iter_mut() {
                    let change = (o.predicted - o.base).over(o.deviation()) / (side + side);
                    o.predicted = o.base;
                    let sum = o.sensitivity.get(k).copied().unwrap_or_default() + change;
                    set(o, k, sum);
                }
            }
        }
        let mut information = Information::prior(theta, &tails::weights(theta));
        let mut rest = &*points.observations;
        for part in points.earlier.iter_mut() {
            let (own, others) = rest.split_at(part.points.min(rest.len()));
            part.inform(&mut information, own);
            rest = others;
        }
        for o in rest {
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
