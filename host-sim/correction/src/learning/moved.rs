//! A part whose points were taken in another frame than it was cut in, or with another ball.
//!
//! The parts before have fixed machine and material: what all points of the new part are off beside that is its datum and
//! its size. A fit over all parts would take it for what the parts have in common.

use truepath_core::cut::Path;
use truepath_ground::diagnostics::InputError;

use super::holdout::predicted;
use super::joint::{Joint, PartPoints};
use crate::codes::Q009;
use crate::misfit::Rigid;

/// Refuses a part whose points are shifted as a whole; `before` is what the parts before it say.
///
/// # Errors
/// `Q009` with the shift.
pub fn refuse_moved(path: &Path, part: &PartPoints, before: &Joint) -> Result<(), InputError> {
    let mut points = part.observations.clone();
    predicted(path, part, before, &mut points);
    let Some(rigid) = Rigid::of(&points).filter(Rigid::is_wrong) else { return Ok(()) };
    let found = format!("{}, beside what the parts before promise of part {}", rigid.words(), part.number);
    let help = format!("{}; --force-data goes on with the points as they are", rigid.help());
    Err(InputError::new(Q009, found, "points taken in the frame that the part was cut in", help))
}
