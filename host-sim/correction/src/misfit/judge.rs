//! The judgement: the job as stated against what else may be, all tried.

use truepath_core::cut::WallLaw;
use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::beside::explains;
use super::cause::Cause;
use super::look::{CLAMPED_MM, Look, Reason};
use super::score::LOST;
use super::stop::Misfit;
use super::trial::Trial;
use crate::identification::asked;

/// By how much a cause must lower the cost, its own freedom paid, to be believed.
const DECISIVE: f64 = 30.0;
/// To what share it must lower it.
const BY_FAR: f64 = 1.0 / 3.0;
/// Causes whose costs differ by less explain the points alike.
const ALIKE: f64 = 6.0;
/// Points that fit cost less than this each.
const FLAWLESS: f64 = 2.5;
/// A probe's length is right to this, mm: a smaller change of height is what bending and helix are taken for.
const SAME_HEIGHT_MM: f64 = 1.0;
/// Of fewer points none is a stray one.
const LEAST_WITH_STRAYS: usize = 6;
/// Fewer points cannot tell one cause from another.
const LEAST_POINTS: usize = 5;

/// Judges the points of a part that was cut as programmed, after a fit; `None` where they fit the job.
pub fn judged(
    pass: &Pass,
    measurement: &Measurement,
    core: &job::Identified,
    observations: &[Observation],
) -> Option<Misfit> {
    let look = Look::of(pass, measurement, core, observations);
    if !look.is_doubtful() {
        return None;
    }
    let reason = look.reason();
    // Of a width neither a shift nor a mirrored axis makes another one: there is nothing to try.
    if measurement.dimensions.is_some() {
        let lines = measurement.contacts.iter().map(|contact| contact.line).collect();
        let stated = Trial::as_fitted(look.score, observations, lines);
        return reason.map(|_| Misfit { look, reason, stated, causes: Vec::new() });
    }
    let stated = Trial::of(Cause::Nothing, pass, measurement, core.law)?;
    if stated.score.points + stated.score.lost < LEAST_POINTS {
        return reason.map(|_| Misfit { look, reason, stated, causes: Vec::new() });
    }
    // The law that the points speak for may be the wrong one where they are of something else.
    let auto = asked(pass.core.job.force.model).is_none() && core.law == WallLaw::Mean;
    let laws: &[WallLaw] = if auto { &[WallLaw::Mean, WallLaw::Helical] } else { &[core.law] };
    let each = |causes: &[Cause]| Trial::each(causes, pass, measurement, laws);
    let mut tried = each(&[Cause::Datum([0.0; 2]), Cause::Datum(look.shift.datum_mm), Cause::Level(0.0)]);
    // A shift that explains all leaves nothing to try.
    if !tried.iter().any(|trial| trial.is_flawless()) {
        tried.extend(each(&Cause::others(pass, laws.contains(&WallLaw::Helical))));
        let best = tried.iter().min_by(|a, b| a.cost().total_cmp(&b.cost())).map(|t| t.cause);
        tried.extend(each(&best.map(Cause::nearby).unwrap_or_default()));
    }
    tried.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    let best = tried.first()?;
    // Few wild touches may bend the fit as well: they are named where the others fit without them. Where the fit has put
    // just them aside, it has done what is to be done.
    let flawless = |trial: &Trial| trial.rest() < FLAWLESS * trial.score.points as f64;
    if !(flawless(best) && best.score.lost <= stated.score.lost) && stated.score.points >= LEAST_WITH_STRAYS {
        let strays = stated.without_strays(pass, measurement, laws).filter(|trial| flawless(trial));
        if let Some(strays) = strays {
            let Cause::Stray(lines) = strays.cause else { return None };
            let line = |k: &usize| measurement.contacts.get(*k).map_or(0, |contact| contact.line);
            let known = reason.is_none() && look.unfit.iter().all(|k| lines.contains(&line(k)));
            return (!known).then(|| Misfit { look, reason, stated, causes: vec![strays] });
        }
    }
    // Readings that are none of this wall under either assumption say nothing.
    let neither = stated.score.lost.min(best.score.lost) as f64 * LOST;
    let cost = stated.score.cost - neither;
    let left = best.score.cost - neither;
    let by_far = stated.score.cost - best.cost() > DECISIVE && left < BY_FAR * cost && best.is_large();
    if !by_far && reason.is_none() {
        return None;
    }
    // Where something must be wrong, what halves the cost is worth naming. The level is part of the fit as stated: there
    // it has no lower cost to show.
    let named = by_far || left < 0.5 * cost || (reason == Some(Reason::Level) && left < cost);
    let limit = if named { best.cost() + ALIKE } else { f64::MIN };
    tried.retain(|trial| trial.cost() <= limit && trial.is_large());
    let mut causes: Vec<Trial> = Vec::new();
    for trial in tried {
        if causes.len() < 3 && !causes.iter().any(|t| t.cause.is_kind_of(trial.cause)) {
            causes.push(trial);
        }
    }
    let misfit = Misfit { look, reason, stated, causes };
    (!explains(&misfit, (pass, measurement), core, observations)).then_some(misfit)
}

impl Trial {
    /// Whether a shift leaves nothing but noise.
    fn is_flawless(&self) -> bool {
        matches!(self.cause, Cause::Datum(_))
            && self.is_large()
            && self.score.lost == 0
            && self.score.cost < 2.0 * self.score.points as f64
    }

    /// Whether the cause is more than what happens to every part.
    fn is_large(&self) -> bool {
        match self.cause {
            Cause::Nothing => false,
            Cause::Datum([x, y]) => x.hypot(y) > CLAMPED_MM,
            Cause::Level(mm) => mm.abs() > CLAMPED_MM,
            Cause::Height(mm) => mm.abs() > SAME_HEIGHT_MM,
            _ => true,
        }
    }
}
