//! Whether points fit a job: the reasons to doubt it, and the reasons to stop.

use truepath_core::identify::{Observation, Parameter};
use truepath_core::job;
use truepath_core::probe::Rejected;
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::score::{LOST, Score, expected_mm, residual_mm};
use super::shift::Shift;
use crate::plausible::{FARTHEST, WORN_MM, farthest, level_mm};

/// Residual in expected deviations from which a point does not fit.
const UNFIT: f64 = 8.0;
/// A point nearer to the model than this fits, mm.
const FITS_MM: f64 = 0.02;
/// A reading nearer to the wall than this may be of it, mm.
pub(super) const NEAR_MM: f64 = 3.0;
/// From so many points on a third is more than bad touches.
const MOST_BAD_TOUCHES: usize = 4;
/// Points that fit cost less than this each, with what the parameters cost.
const WELL: f64 = 4.0;
/// A datum moves by less than this when the part stays in its vice, mm.
pub(super) const CLAMPED_MM: f64 = 0.03;

/// What the fit of the job as stated shows.
#[derive(Clone, Debug)]
pub struct Look {
    /// How well the points fit.
    pub score: Score,
    /// Points that do not, as places in the list of observations, the worst first.
    pub unfit: Vec<usize>,
    /// Readings beside the wall above or below the cut, where no other pass can have made what they touched.
    pub off_height: usize,
    /// A free datum.
    pub shift: Shift,
    /// What all points are off, mm, and its standard deviation.
    pub level_mm: [f64; 2],
    /// The parameter farthest from what the job says, size and datum aside, and how far in standard deviations.
    pub farthest: (Parameter, f64),
}

/// A reason to stop without any cause being known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// Too many points do not fit.
    Points,
    /// All points are off by more than wear.
    Level,
    /// A parameter cannot be.
    Parameter(Parameter, f64),
}

impl Look {
    /// At a fit of the job as stated.
    pub fn of(pass: &Pass, measurement: &Measurement, core: &job::Identified, observations: &[Observation]) -> Self {
        let aside = |near: &dyn Fn(&Rejected) -> bool| measurement.rejected.iter().filter(|r| near(&r.reason)).count();
        let lost = aside(&|reason| match reason {
            Rejected::OffTheWall { distance } => mm(*distance).abs() < NEAR_MM,
            Rejected::Normal { .. } => true,
            _ => false,
        });
        let off_height = aside(&|reason| is_of_one_depth(pass) && matches!(reason, Rejected::OffHeight { .. }));
        let off = |k: &usize| residual_mm(&observations[*k]).abs();
        let mut unfit: Vec<usize> = (0..observations.len())
            .filter(|k| off(k) > FITS_MM && off(k) > UNFIT * expected_mm(&observations[*k]))
            .collect();
        unfit.sort_by(|a, b| off(b).total_cmp(&off(a)));
        Self {
            score: Score::of(&core.fit.theta.map(float), observations, lost),
            unfit,
            off_height,
            shift: Shift::of(&core.prior, &core.fit, observations),
            level_mm: level_mm(core),
            farthest: farthest(core),
        }
    }

    /// Points that do not fit, of how many.
    pub fn count(&self) -> (usize, usize) {
        (self.unfit.len() + self.score.lost, self.score.points + self.score.lost)
    }

    /// Whether other assumptions are worth a try.
    pub fn is_doubtful(&self) -> bool {
        let (unfit, all) = self.count();
        let fitting = self.score.cost - (self.unfit.len() + self.score.lost) as f64 * LOST;
        4 * (unfit + self.off_height) >= (all + self.off_height).max(4)
            || fitting > WELL * self.score.points as f64
            || self.score.median > 3.0
            || (self.shift.gain > 25.0 && self.shift.length_mm() > 0.5 * CLAMPED_MM)
            || self.level_mm[0].abs() > WORN_MM
            || self.farthest.1 > 0.6 * FARTHEST
    }

    /// Whether the points fit on the whole, those that do not among them.
    pub fn fits_well(&self) -> bool {
        self.score.cost <= WELL * self.score.points as f64
    }

    /// What forbids to go on whatever the cause is.
    pub fn reason(&self) -> Option<Reason> {
        let (unfit, all) = self.count();
        // Of a few points two or three may be bad touches: they are set aside, and named.
        if all > 2 && 3 * unfit >= all && (unfit >= MOST_BAD_TOUCHES || 2 * unfit >= all) {
            return Some(Reason::Points);
        }
        let [level, sigma] = self.level_mm;
        if level.abs() > WORN_MM + 3.0 * sigma {
            return Some(Reason::Level);
        }
        let (parameter, far) = self.farthest;
        (far > FARTHEST).then_some(Reason::Parameter(parameter, far))
    }
}

/// Whether readings above or below the pass cannot be of another pass along the same wall.
pub(super) fn is_of_one_depth(pass: &Pass) -> bool {
    pass.plan.as_ref().is_none_or(|plan| plan.levels().len() < 2)
}
