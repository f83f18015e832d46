//! A part whose points were taken in another frame than it was cut in, or with another ball.
//!
//! The parts before have fixed machine and material: what all points of the new part are off beside that is its datum and
//! its size. A fit over all parts would take it for what the parts have in common.

use truepath_core::cut::Path;

use super::holdout::{predicted, seen_alone};
use super::joint::{Joint, PartPoints};
use crate::codes::Q009;
use crate::misfit::Rigid;

/// What is said of a part whose points are shifted as a whole; `before` is what the parts before it say. Nothing is lost by
/// going on: a part that came out worse for no reason of the machine is set aside.
pub fn moved(path: &Path, part: &PartPoints, before: &Joint) -> Option<String> {
    let mut points = seen_alone(&part.observations);
    predicted(path, part, before, &mut points);
    let rigid = Rigid::of(&points).filter(Rigid::is_wrong)?;
    let beside = format!("beside what the parts before promise of part {}", part.number);
    Some(format!("{}: {}, {beside}: {}", Q009.code, rigid.words(), rigid.help()))
}
