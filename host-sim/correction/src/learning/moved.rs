//! A part whose points were taken in another frame than it was cut in, or with another ball.
//!
//! The parts before have fixed machine and material, at the level of force of the new part: what all its points are off beside
//! that is its datum and its size. A fit over all parts would take it for what the parts have in common.

use truepath_core::cut::Path;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::real;

use super::holdout::{predicted, seen_alone};
use super::joint::{Joint, PartPoints};
use crate::codes::Q009;
use crate::misfit::Rigid;

/// What is said of a part whose points are shifted as a whole; `before` is what the parts before it say, `level` its level of force
/// over that of the last of them, natural logarithm. Nothing is lost by going on: a part that came out worse for no reason of the
/// machine is set aside.
pub fn moved(path: &Path, part: &PartPoints, before: &Joint, (level, unit): (f64, Unit)) -> Option<Remark> {
    let mut points = seen_alone(&part.observations);
    let at_its_force = before.core.fit.parameters.with_force(real(level));
    predicted(path, part, before, &at_its_force, &mut points);
    let rigid = Rigid::of(&points).filter(Rigid::is_wrong)?;
    let beside = format!("beside what the parts before promise of part {}", part.number);
    Some(unit.remark(|unit| format!("{}: {}, {beside}: {}", Q009.code, rigid.words(unit), rigid.help())))
}
