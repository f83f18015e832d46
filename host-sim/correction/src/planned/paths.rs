//! Where a planned pass runs: the programmed path and its leads, displaced.

use truepath_core::cut::Path;
use truepath_ground::diagnostics::Failure;
use truepath_job::pass::Pass;
use truepath_program::BlockEdit;
use truepath_program::passes::RepeatedPass;

use super::plan::PlannedPass;
use crate::edits::carried_edits;

/// The path of a pass on the lines on which it was written out: leads are moved as they are, by what the contour is moved at
/// their end, so that they meet it as before.
pub(super) fn edits(
    pass: &Pass,
    path: &Path<'_>,
    planned: &PlannedPass,
    written: &RepeatedPass,
) -> Result<Vec<BlockEdit>, Failure> {
    let [lead_in, contour, lead_out] = &written.parts;
    let mut placed = pass.clone();
    if contour.len() != placed.blocks.len() {
        return Err(Failure::Internal("a pass that is not its contour".to_owned()));
    }
    for (block, line) in placed.blocks.iter_mut().zip(contour) {
        block.line = line.line;
    }
    let mut edits = carried_edits(&placed, [lead_in, lead_out], path, &planned.nodes);
    if planned.reversed {
        edits.reverse();
        edits.iter_mut().for_each(|edit| edit.samples.reverse());
    }
    Ok(edits)
}
