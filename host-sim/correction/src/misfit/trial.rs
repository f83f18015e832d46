//! A fit under a cause.

use rayon::prelude::*;
use truepath_core::cut::{Sample, WallLaw};
use truepath_core::geometry::Direction;
use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_core::probe::{Contact, Contacts, Outcome, Rejected};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{mm, nm, real};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::cause::{Altered, Cause};
use super::fit::Fitting;
use super::look::{NEAR_MM, is_of_one_depth};
use super::score::{LOST, Score, residual_mm};
use crate::discrepancy::{PartCut, ln_evidence, ln_probability_elsewhere, plain};
use crate::identification::asked;

/// Points that a trial takes at most.
const MOST: usize = 48;

/// Points that are taken out in turn.
const MOST_STRAYS: usize = 12;
/// What a number that may be anything costs: about 2 ln (0.5 mm / 5 µm).
const FREEDOM: f64 = 9.0;
/// Rounds in which a free datum is found.
const DATUM_ROUNDS: usize = 8;

/// What a cause does to the fit.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The cause, with what it came out as.
    pub cause: Cause,
    /// How well the points fit.
    pub score: Score,
    /// The points with predictions.
    pub observations: Vec<Observation>,
    /// Their lines in the file.
    pub lines: Vec<u32>,
}

impl Trial {
    /// The job as stated, as a fit has left its points.
    pub fn as_fitted(score: Score, observations: &[Observation], lines: Vec<u32>) -> Self {
        Self { cause: Cause::Nothing, score, observations: observations.to_vec(), lines }
    }

    /// Fits under a cause; `None` where nothing can be fitted. A free datum is found in several rounds: points beyond the
    /// reach of the wall, and places along it, come right once most of the shift is known.
    pub fn of(cause: Cause, pass: &Pass, measurement: &Measurement, law: WallLaw) -> Option<Self> {
        let mut best = Self::once(cause, pass, measurement, law)?;
        let mut last = best.cause;
        for _ in 1..DATUM_ROUNDS {
            let Cause::Datum([x, y]) = last else { break };
            let Some(again) = Self::once(last, pass, measurement, law).filter(|_| x.hypot(y) < NEAR_MM) else { break };
            let moved = matches!(again.cause, Cause::Datum([u, v]) if (u - x).hypot(v - y) > 0.01);
            last = again.cause;
            if again.score.cost < best.score.cost {
                best = again;
            }
            if !moved {
                break;
            }
        }
        Some(best)
    }

    fn once(cause: Cause, pass: &Pass, measurement: &Measurement, law: WallLaw) -> Option<Self> {
        let altered = cause.altered(pass, measurement).ok()?;
        let (contacts, lost) = altered.contacts(cause);
        altered.fitted(cause, &contacts, lost, measurement, law).ok()?
    }

    /// The best fit without one or two of the points that are farthest off, one after the other.
    pub fn without_strays(&self, pass: &Pass, measurement: &Measurement, laws: &[WallLaw]) -> Option<Self> {
        let mut best: Option<Self> = None;
        for _ in 0..2 {
            let out = best.as_ref().map_or(0, |trial| match trial.cause {
                Cause::Stray([one, _]) => one,
                _ => 0,
            });
            let causes: Vec<Cause> =
                self.worst().iter().take(MOST_STRAYS).map(|k| Cause::Stray([self.lines[*k], out])).collect();
            let each = Self::each(&causes, pass, measurement, laws);
            // What is left counts: the points taken out cost the same whichever they are.
            let next = each.into_iter().min_by(|a, b| a.rest().total_cmp(&b.rest()))?;
            let enough = next.rest() < 2.0 * next.score.points as f64;
            best = Some(next);
            if enough {
                break;
            }
        }
        best
    }

    /// What the points cost under the job as stated, where the stock may differ by so much from place to place, as shares of the
    /// allowance of one `deviation`; with what is lost. `None` where nothing can be fitted.
    pub(super) fn beside_stock(
        pass: &Pass,
        measurement: &Measurement,
        law: WallLaw,
        (shares, deviation): (&[f64], f64),
    ) -> Option<f64> {
        let altered = Cause::Nothing.altered(pass, measurement).ok()?;
        let (contacts, lost) = altered.contacts(Cause::Nothing);
        let observations = altered.observations(&contacts, measurement).ok()?;
        let mut buffer = PathBuffer::default();
        let path = pass.sample(&mut buffer).ok()?.with_law(law);
        let mut buffers: Vec<Vec<Sample>> = shares.iter().map(|_| vec![Sample::BLANK; path.samples().len()]).collect();
        let allowance = mm(path.setup().allowance);
        let mut others = Vec::new();
        for (buffer, share) in buffers.iter_mut().zip(shares) {
            let path = path.with_stock_moved(buffer, |_| nm(-share * allowance));
            others.push((path, (share / deviation).powi(2)));
        }
        let prior = pass.core.prior(law);
        let (_, cost) = Fitting { path: &path, others: &others, prior, observations, stocks: Vec::new() }.settle();
        Some(cost + lost as f64 * LOST)
    }

    /// How probable the points are under the cause, whatever the machine and what is beside the model: natural logarithm, with the
    /// freedom of the cause paid. `None` where nothing can be fitted.
    pub(super) fn ln_evidence(&self, pass: &Pass, measurement: &Measurement) -> Option<f64> {
        let altered = self.cause.altered(pass, measurement).ok()?;
        let (contacts, lost) = altered.contacts(self.cause);
        let mut observations = altered.observations(&contacts, measurement).ok()?;
        if let Cause::Level(off) = self.cause {
            observations.iter_mut().for_each(|o| o.error -= nm(off));
        }
        let (pass, mut buffer) = (&altered.pass, PathBuffer::default());
        let path = pass.sample(&mut buffer).ok()?;
        let cut = PartCut::uncorrected(path, 0, &observations);
        let found = plain(pass, asked(pass.core.job.force.model), &[cut], &mut |_| ());
        let elsewhere = lost as f64 * ln_probability_elsewhere();
        Some(ln_evidence(&found, &[cut])? + elsewhere - 0.5 * FREEDOM * self.cause.freedom())
    }

    /// What the points cost that are some.
    pub fn rest(&self) -> f64 {
        self.score.cost - self.score.lost as f64 * LOST
    }

    /// Points as places in the list, the worst first.
    pub(super) fn worst(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.observations.len()).collect();
        let off = |k: usize| residual_mm(&self.observations[k]).abs();
        order.sort_by(|a, b| off(*b).total_cmp(&off(*a)));
        order
    }

    /// Fits under many causes.
    pub fn each(causes: &[Cause], pass: &Pass, measurement: &Measurement, laws: &[WallLaw]) -> Vec<Self> {
        let all: Vec<(Cause, WallLaw)> =
            laws.iter().flat_map(|law| causes.iter().map(|cause| (*cause, *law))).collect();
        all.into_par_iter().filter_map(|(cause, law)| Self::of(cause, pass, measurement, law)).collect()
    }

    /// The cost with what the freedom of the cause costs.
    pub fn cost(&self) -> f64 {
        self.score.cost + FREEDOM * self.cause.freedom()
    }
}

impl Altered {
    /// The contacts, thinned, and how many readings near the wall are none or are taken out by the cause.
    fn contacts(&self, cause: Cause) -> (Vec<Contact>, usize) {
        let on_wall = Contacts::new(self.pass.path_contour(), self.setting);
        let one_depth = is_of_one_depth(&self.pass);
        let (mut contacts, mut lost) = (Vec::new(), 0);
        let touched = self.readings.iter().filter(|r| r.outcome == Outcome::Touched);
        let every = touched.clone().count().div_ceil(MOST).max(1);
        for reading in touched.step_by(every) {
            match on_wall.contact(reading) {
                Ok(contact) => contacts.push(contact),
                Err(Rejected::OffTheWall { distance }) if mm(distance).abs() > NEAR_MM => {}
                Err(Rejected::OffHeight { .. }) if !one_depth => {}
                Err(Rejected::OffTheWall { .. } | Rejected::OffHeight { .. } | Rejected::Normal { .. }) => lost += 1,
                Err(_) => {}
            }
        }
        contacts.sort_unstable_by_key(|c| (c.s, c.height, c.error, c.line));
        contacts.dedup_by(|b, a| Contact { line: a.line, ..*b } == *a);
        if let Cause::Stray(lines) = cause {
            lost += lines.iter().filter(|line| **line > 0).count();
        }
        (contacts, lost)
    }

    /// The contacts as a fit takes them.
    fn observations(&self, contacts: &[Contact], measurement: &Measurement) -> Result<Vec<Observation>, Failure> {
        let blank = Observation::new(Offset::ZERO, Real::ZERO, Offset::ZERO, Offset::ZERO, Direction::X);
        let mut observations = vec![blank; contacts.len()];
        job::observations(contacts, measurement.noise, &mut observations).map_err(|error| self.pass.refused(&error))?;
        if self.turned {
            for o in &mut observations {
                o.error = -o.error;
            }
        }
        Ok(observations)
    }

    fn fitted(
        &self,
        cause: Cause,
        contacts: &[Contact],
        lost: usize,
        measurement: &Measurement,
        law: WallLaw,
    ) -> Result<Option<Trial>, Failure> {
        if contacts.is_empty() {
            return Ok(None);
        }
        let observations = self.observations(contacts, measurement)?;
        let mut buffer = PathBuffer::default();
        let path = self.pass.sample(&mut buffer)?.with_law(law);
        let prior = self.free.of(self.pass.core.prior(law));
        let mut fitting = Fitting { path: &path, others: &[], prior, observations, stocks: Vec::new() };
        let (theta, _) = fitting.settle();
        let p = &prior.at(&theta.map(real));
        let cause = match cause {
            Cause::Datum([x, y]) => Cause::Datum([x + mm(p.datum.x), y + mm(p.datum.y)]),
            Cause::Level(_) => Cause::Level(mm(p.undersize)),
            cause => cause,
        };
        let score = Score::of(&theta, &fitting.observations, lost);
        let lines = contacts.iter().map(|c| c.line).collect();
        Ok(Some(Trial { cause, score, observations: fitting.observations, lines }))
    }
}
