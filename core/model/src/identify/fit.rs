//! The fit: Gauss–Newton with priors and a robust loss, over one part or several.

use super::observation::{Observation, Predictor, Search, join_pairs};
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
const SPREADS: usize = 8;
/// Step of the difference quotients, in prior standard deviations.
const DIFFERENCE: Real = Real::ratio(1, 32);
/// Sensitivities are good for steps as far as this from where they were taken, in prior standard deviations: they cost twice as many
/// predictions as there are parameters, a step costs one.
const NEAR: Real = Real::ratio(1, 4);
/// As far as this they are those of the solution.
const THERE: Real = Real::ratio(1, 32);
/// A step that takes less than this off the cost, of which one standard deviation is 1, is the last.
const SETTLED: Real = Real::ratio(1, 1000);
/// The same while it is not settled what the points weigh.
const ROUGHLY: Real = Real::ratio(1, 20);

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
/// from 0. A fit may begin where another of the same points has ended that is of nearly the same machine and of the same prior: the
/// observations are those that it left. Every part has a datum and a level of force of its own, which all its contours share; those of
/// [`Fit::parameters`] are the last one's, the others are left in `earlier`, which say what is believed of the levels. `observe` is told the share of the longest possible fit that is done, ‰, rising: a
/// fit that settles early ends before 1000. On return the observations hold predictions, weights and sensitivities at
/// the solution.
pub fn identify(
    cuts: &[Cut],
    (prior, begin): (&Prior, Option<&Fit>),
    earlier: &mut [EarlierPart],
    observations: &mut [Observation],
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    predictor: &mut impl Predictor,
    observe: &mut dyn FnMut(u16),
) -> Fit {
    Task { cuts, prior, begin, commanded }.fit(earlier, observations, predictor, observe)
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
    begin: Option<&'t Fit>,
    commanded: C,
}

/// The points at which a fit looks, part by part, and who predicts them.
struct Points<'p, P> {
    earlier: &'p mut [EarlierPart],
    observations: &'p mut [Observation],
    predictor: &'p mut P,
    /// How far the fit has come at most from where the sensitivities were taken; `None` where there are none.
    come: Option<Real>,
    /// Whether the predictions are those at the place where the fit is.
    is_predicted: bool,
}

/// How far downhill a fit goes.
#[derive(Clone, Copy)]
struct Aim {
    /// Points beyond this have no weight.
    gate: Real,
    /// A step that takes less than this off the cost is the last.
    least: Real,
}

impl<C: Fn(usize, usize) -> Vector + Copy + Sync> Task<'_, C> {
    #[inline(never)]
    fn fit(
        &self,
        earlier: &mut [EarlierPart],
        observations: &mut [Observation],
        predictor: &mut impl Predictor,
        observe: &mut dyn FnMut(u16),
    ) -> Fit {
        let prior = self.prior;
        let mut table = ForceTable::BLANK;
        table.tabulate(prior.mean.coefficients.size_exponent);
        let (mut theta, come) = match self.begin {
            // Sensitivities of another machine are taken anew where the fit ends.
            Some(other) => (other.theta, Some(THERE)),
            None => ([Real::ZERO; COUNT], None),
        };
        for part in earlier.iter_mut() {
            *part = EarlierPart::new(part.points, part.believed);
        }
        let mut points = Points { earlier, observations, predictor, come, is_predicted: false };
        spread::set(points.observations, Real::ONE);
        let mut aim = Aim { gate: Real::MAX, least: ROUGHLY };
        let (mut information, _, mut steps) = self.settle(&mut table, &mut theta, aim, &mut points, observe);
        let quiet = &mut |_| ();
        // A few points far off are of something else than this wall: they pull no more, and say nothing of the noise.
        let wild = points.observations.iter().filter(|o| o.residual().abs() > WILD).count();
        aim.gate = if wild.saturating_mul(4) <= points.observations.len() { WILD } else { Real::MAX };
        if wild > 0 && aim.gate == WILD {
            let (again, _, more) = self.settle(&mut table, &mut theta, aim, &mut points, quiet);
            (information, steps) = (again, steps.saturating_add(more));
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
            let (again, _, more) = self.settle(&mut table, &mut theta, aim, &mut points, quiet);
            (information, steps) = (again, steps.saturating_add(more));
        }
        aim.least = SETTLED;
        let (information, cost, more) = self.settle(&mut table, &mut theta, aim, &mut points, quiet);
        steps = steps.saturating_add(more);
        let taken_out = points.earlier.iter().fold(Real::ZERO, |sum, part| sum + part.log2_determinant());
        let ln_determinant = (information.log2_determinant() + taken_out) * Real::ratio(693_147_181, 1_000_000_000);
        let evidence = -((cost + ln_determinant + spread::cost(points.observations, factor)) * Real::HALF);
        let covariance = information.covariance();
        let outliers = points.observations.iter().filter(|o| o.is_outlying()).count();
        Fit { parameters: prior.at(&theta), theta, covariance, cost, steps, outliers, evidence }
    }

    /// Goes downhill from `theta` until the cost settles. Returns information, cost and steps taken.
    fn settle(
        &self,
        table: &mut ForceTable,
        theta: &mut [Real; COUNT],
        Aim { gate, least }: Aim,
        points: &mut Points<impl Predictor>,
        observe: &mut dyn FnMut(u16),
    ) -> (Information, Real, u32) {
        let mut cost = self.cost(table, theta, gate, points);
        let mut steps = 0;
        let mut information = self.linearised(table, theta, points, &mut |k| observe(permille(0, k)));
        while steps < MAX_STEPS {
            steps = steps.saturating_add(1);
            let step = information.step();
            let largest = step.iter().map(|v| v.abs()).max().unwrap_or_default();
            // Backtracking: halve until the cost falls.
            let (mut share, mut is_lowest) = (Real::ONE, false);
            let (taken, new_cost) = loop {
                let mut trial = *theta;
                for (t, s) in trial.iter_mut().zip(&step) {
                    *t += *s * share;
                }
                for part in points.earlier.iter_mut() {
                    part.look(&step, share);
                }
                points.is_predicted = false;
                let trial_cost = self.evaluate(table, &trial, gate, points);
                if trial_cost <= cost {
                    points.is_predicted = true;
                    break (Some(trial), trial_cost);
                }
                // So near to the lowest cost a prediction is rounded by more than a step gains.
                if trial_cost - cost < least && largest * share <= THERE {
                    is_lowest = true;
                    break (None, cost);
                }
                share = share * Real::HALF;
                if share < Real::ratio(1, 40) {
                    break (None, cost);
                }
            };
            let Some(accepted) = taken else {
                let is_there = least > SETTLED || points.come.is_some_and(|come| come <= THERE);
                if points.come.is_none_or(|come| come == Real::ZERO) || is_lowest && is_there {
                    break;
                }
                // Sensitivities of another place may have led astray.
                points.come = None;
                for part in points.earlier.iter_mut() {
                    part.look_back();
                }
                cost = self.cost(table, theta, gate, points);
                information = self.linearised(table, theta, points, &mut |k| observe(permille(steps, k)));
                continue;
            };
            *theta = accepted;
            for part in points.earlier.iter_mut() {
                part.stay();
            }
            points.come = points.come.map(|come| come + largest * share);
            let settled = largest < Real::ratio(1, 2000) || cost - new_cost < least;
            cost = new_cost;
            let is_there = least > SETTLED || points.come.is_some_and(|come| come <= THERE);
            if settled && !is_there {
                points.come = None;
            }
            information = self.linearised(table, theta, points, &mut |k| observe(permille(steps, k)));
            if settled && is_there {
                break;
            }
        }
        for part in points.earlier.iter_mut() {
            part.look_back();
        }
        cost = self.cost(table, theta, gate, points);
        (information, cost, steps)
    }

    /// The robust cost where the fit is, whose predictions may be there; sets the weights of the points.
    fn cost(
        &self,
        table: &mut ForceTable,
        theta: &[Real; COUNT],
        gate: Real,
        points: &mut Points<impl Predictor>,
    ) -> Real {
        if points.is_predicted {
            return weighed(theta, gate, points);
        }
        points.is_predicted = true;
        self.evaluate(table, theta, gate, points)
    }

    /// Predicts the points of every cut with its own correction, and with what is its part's own. The table, which is large, is made anew
    /// where it is another machine's.
    fn predict(
        &self,
        table: &mut ForceTable,
        parameters: &Parameters,
        search: Search,
        points: &mut Points<impl Predictor>,
    ) {
        if table.size_exponent() != parameters.coefficients.size_exponent {
            table.tabulate(parameters.coefficients.size_exponent);
        }
        let mut rest = &mut *points.observations;
        for (k, cut) in self.cuts.iter().enumerate() {
            let (own, others) = rest.split_at_mut(cut.points.min(rest.len()));
            let parameters =
                points.earlier.get(cut.part).map_or(*parameters, |part| part.tried(self.prior, parameters));
            points.predictor.predict(&cut.path, table, &parameters, search, |i| (self.commanded)(k, i), own);
            rest = others;
        }
        join_pairs(points.observations);
    }

    /// Predicts all points and returns the robust cost; sets their weights.
    fn evaluate(
        &self,
        table: &mut ForceTable,
        theta: &[Real; COUNT],
        gate: Real,
        points: &mut Points<impl Predictor>,
    ) -> Real {
        self.predict(table, &self.prior.at(theta), Search::Everywhere, points);
        weighed(theta, gate, points)
    }

    /// The normal equations at a point just evaluated, with sensitivities taken anew where the last are too far; `observe` is told how
    /// many parameters are done.
    fn linearised(
        &self,
        table: &mut ForceTable,
        theta: &[Real; COUNT],
        points: &mut Points<impl Predictor>,
        observe: &mut dyn FnMut(usize),
    ) -> Information {
        if points.come.is_none_or(|come| come > NEAR) {
            self.differentiate(table, theta, points, observe);
            points.come = Some(Real::ZERO);
        }
        let mut information = Information::prior(theta, &tails::weights(theta));
        let mut rest = &*points.observations;
        for part in points.earlier.iter_mut() {
            let (own, others) = rest.split_at(part.points.min(rest.len()));
            part.inform(&mut information, self.prior, own);
            rest = others;
        }
        for o in rest {
            information.add(&o.sensitivity, o.residual(), o.weight);
        }
        information
    }

    /// Sensitivities at a point just evaluated; `observe` is told how many parameters are done.
    ///
    /// Radius and datum act on the measurement and are known; the others are central difference quotients, so that a
    /// parameter whose sign turns with the part has the same sensitivity with the other sign.
    fn differentiate(
        &self,
        table: &mut ForceTable,
        theta: &[Real; COUNT],
        points: &mut Points<impl Predictor>,
        observe: &mut dyn FnMut(usize),
    ) {
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
                // The prediction at the point itself is needed again: it is kept aside.
                for o in points.observations.iter_mut() {
                    o.keep();
                }
                self.predict(table, &self.prior.at(&moved), Search::Nearby, points);
                for o in points.observations.iter_mut() {
                    let change = (o.predicted - o.kept()).over(o.deviation()) / (side + side);
                    o.predicted = o.kept();
                    let sum = o.sensitivity.get(k).copied().unwrap_or_default() + change;
                    set(o, k, sum);
                }
            }
        }
    }
}

/// The robust cost of the points as they are predicted; sets their weights.
fn weighed<P>(theta: &[Real; COUNT], gate: Real, points: &mut Points<P>) -> Real {
    let mut cost = points.earlier.iter().fold(tails::cost(theta), |sum, part| sum + part.cost());
    for o in points.observations.iter_mut() {
        cost += o.weigh(gate);
    }
    cost
}

fn set(observation: &mut Observation, k: usize, value: Real) {
    if let Some(slot) = observation.sensitivity.get_mut(k) {
        *slot = value;
    }
}
