//! What an inspection notices: a datum or a size that is wrong, whether or not the part was cut with a correction.

use truepath_core::cut::WallLaw;
use truepath_core::units::Offset;
use truepath_ground::length::Remark;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::cause::Cause;
use super::rigid::Rigid;
use super::trial::Trial;
use crate::identification::asked;

/// A datum or a size that explains the points by far better, both where the machine deflects as the job says and where a
/// correction has cancelled that; `None` where there is none.
pub fn noticed(pass: &Pass, measurement: &Measurement) -> Option<Remark> {
    // A width sees no shift of the datum.
    if measurement.dimensions.is_some() {
        return None;
    }
    let law = asked(pass.core.job.force.model).unwrap_or(WallLaw::Helical);
    let deflected = Trial::of(Cause::Nothing, pass, measurement, law)?;
    let mut corrected = deflected.observations.clone();
    for o in &mut corrected {
        o.predicted = Offset::ZERO;
    }
    let corrected = Rigid::of(&corrected).filter(Rigid::is_wrong)?;
    let shifted = Trial::of(Cause::Datum([0.0; 2]), pass, measurement, law)?;
    let Cause::Datum(datum_mm) = shifted.cause else { return None };
    let [as_is, left] = [deflected.score.cost, shifted.cost()];
    let moved = Rigid { datum_mm, level_mm: 0.0, cost: [as_is, left, left] };
    let which = if moved.is_wrong() { moved } else { Rigid::of(&deflected.observations).filter(Rigid::is_wrong)? };
    // A part that a correction has cut shows the shift by itself.
    let best = if corrected.cost[2] < left { corrected } else { which };
    let said = |unit| format!("the points do not fit the job: {}; {}", best.words(unit), best.help());
    Some(pass.unit().remark(said))
}
