//! A fit under a cause.

use rayon::prelude::*;
use truepath_core::cut::WallLaw;
use truepath_core::geometry::{Direction, Vector};
use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_core::probe::{Contact, Contacts, Outcome, Rejected};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::cause::{Altered, Cause};
use super::score::Score;
use crate::identification::{Found, Points, found_around};

/// Points that a trial takes at most.
const MOST: usize = 48;
/// A reading nearer to the wall than this may be of it, mm.
const NEAR_MM: f64 = 3.0;

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
    /// Machine and material.
    pub core: job::Identified,
}

impl Trial {
    /// Fits under a cause; `None` where nothing can be fitted.
    pub fn of(cause: Cause, pass: &Pass, measurement: &Measurement, law: WallLaw) -> Option<Self> {
        let altered = cause.altered(pass, measurement).ok()?;
        let (contacts, lost) = altered.contacts();
        let trial = altered.fitted(cause, &contacts, lost, measurement, law).ok()??;
        match cause {
            // Points beyond the reach of the wall come into it once most of the shift is known.
            Cause::Datum([0.0, 0.0]) if trial.is_moved() => {
                Self::of(trial.cause, pass, measurement, law).filter(|t| t.score.cost <= trial.score.cost).or(Some(trial))
            }
            _ => Some(trial),
        }
    }

    /// Fits under many causes.
    pub fn each(causes: Vec<Cause>, pass: &Pass, measurement: &Measurement, law: WallLaw) -> Vec<Self> {
        causes.into_par_iter().filter_map(|cause| Self::of(cause, pass, measurement, law)).collect()
    }

    fn is_moved(&self) -> bool {
        matches!(self.cause, Cause::Datum([x, y]) if x.hypot(y) > 0.02)
    }

    /// The cost with what the freedom of the cause costs.
    pub fn cost(&self) -> f64 {
        // About 2 ln (0.5 mm / 5 µm) for a number that may be anything.
        self.score.cost + 9.0 * self.cause.freedom()
    }
}

impl Altered {
    /// The contacts, thinned, and how many readings near the wall are none.
    fn contacts(&self) -> (Vec<Contact>, usize) {
        let on_wall = Contacts::new(self.pass.path_contour(), self.setting);
        let (mut contacts, mut lost) = (Vec::new(), 0);
        let touched = self.readings.iter().filter(|r| r.outcome == Outcome::Touched);
        let every = touched.clone().count().div_ceil(MOST).max(1);
        for reading in touched.step_by(every) {
            match on_wall.contact(reading) {
                Ok(contact) => contacts.push(contact),
                Err(Rejected::OffTheWall { distance }) if mm(distance).abs() > NEAR_MM => {}
                Err(Rejected::OffTheWall { .. } | Rejected::Normal { .. }) => lost += 1,
                Err(_) => {}
            }
        }
        contacts.sort_unstable_by_key(|c| (c.s, c.height, c.error, c.line));
        contacts.dedup_by(|b, a| Contact { line: a.line, ..*b } == *a);
        (contacts, lost)
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
        let blank = Observation::new(Offset::ZERO, Real::ZERO, Offset::ZERO, Offset::ZERO, Direction::X);
        let mut observations = vec![blank; contacts.len()];
        job::observations(contacts, measurement.noise, &mut observations).map_err(|error| self.pass.refused(&error))?;
        if self.turned {
            for o in &mut observations {
                o.error = -o.error;
            }
        }
        let mut buffer = PathBuffer::default();
        let path = self.pass.sample(&mut buffer)?;
        let points = Points { earlier: &[], observations: &observations };
        let around = |law| self.free.of(self.pass.core.prior(law));
        let as_programmed = |_, _| Vector::ZERO;
        let Found { core, observations, .. } =
            found_around(around, &path, Some(law), points, as_programmed, &mut |_| ());
        let p = &core.fit.parameters;
        let cause = match cause {
            Cause::Datum([x, y]) => Cause::Datum([x + mm(p.datum.x), y + mm(p.datum.y)]),
            Cause::Level(_) => Cause::Level(mm(p.undersize)),
            cause => cause,
        };
        let score = Score::of(&core.fit, &observations, lost);
        let lines = contacts.iter().map(|c| c.line).collect();
        Ok(Some(Trial { cause, score, observations, lines, core }))
    }
}
