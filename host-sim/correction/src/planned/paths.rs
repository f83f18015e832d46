//! Where a planned pass runs: the programmed path and its leads, displaced.

use truepath_core::cut::Path;
use truepath_core::geometry::{Block, Shape};
use truepath_ground::diagnostics::Failure;
use truepath_job::pass::Pass;
use truepath_program::BlockEdit;
use truepath_program::passes::RepeatedPass;

use super::plan::PlannedPass;
use crate::edits::{carried_edits, tapered_edits};

/// A lead-in takes up what it is this many times longer than.
const LEAST_LEAD: i64 = 5;

/// What becomes of the leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leads {
    /// They are moved as they are, by what the contour is moved at their end, so that they meet it as before.
    Carried,
    /// They begin and end where they did, and the displacement comes and goes along them.
    Kept,
}

/// The path of a pass on the lines on which it was written out.
pub(super) fn edits(
    pass: &Pass,
    path: &Path<'_>,
    planned: &PlannedPass,
    written: &RepeatedPass,
    leads: Leads,
) -> Result<Vec<BlockEdit>, Failure> {
    let [lead_in, contour, lead_out] = &written.parts;
    let mut placed = pass.clone();
    if contour.len() != placed.blocks.len() {
        return Err(Failure::Internal("a pass that is not its contour".to_owned()));
    }
    for (block, line) in placed.blocks.iter_mut().zip(contour) {
        block.line = line.line;
    }
    let moved = match leads {
        Leads::Carried => carried_edits,
        Leads::Kept => tapered_edits,
    };
    let mut edits = moved(&placed, [lead_in, lead_out], path, &planned.nodes);
    if planned.reversed {
        edits.reverse();
        edits.iter_mut().for_each(|edit| edit.samples.reverse());
    }
    Ok(edits)
}

/// Where a pass begins where the one before has ended, it comes down there as well: what the two are moved apart by lies along a
/// straight lead-in. Without one the writer puts a step there, which leads to the path where nothing is left to be cut.
pub(super) fn meet(
    before: &RepeatedPass,
    after: &RepeatedPass,
    reversed: [bool; 2],
    end: Option<[i64; 2]>,
    edits: &mut [BlockEdit],
) {
    let blocks = |pass: &RepeatedPass| pass.parts.iter().flatten().copied().collect::<Vec<Block>>();
    let (earlier, later) = (blocks(before), blocks(after));
    let outer = |blocks: &[Block], last: bool| if last { blocks.last().copied() } else { blocks.first().copied() };
    let left = outer(&earlier, !reversed[0]).map(|b| if reversed[0] { b.curve.start() } else { b.curve.end() });
    let lead = &after.parts[if reversed[1] { 2 } else { 0 }];
    let begun = outer(&later, reversed[1]).map(|b| if reversed[1] { b.curve.end() } else { b.curve.start() });
    let first = outer(lead, reversed[1]).filter(|b| b.curve.shape() == Shape::Line && left == begun);
    let (Some(first), Some(end)) = (first, end) else { return };
    let Some(edit) = edits.first_mut().filter(|edit| edit.line == first.line) else { return };
    let (Some(&start), count) = (edit.samples.first(), edit.samples.len() as i64 - 1) else { return };
    let apart = [end[0] - start[0], end[1] - start[1]];
    let far = apart[0].abs().max(apart[1].abs()) * LEAST_LEAD > first.curve.length().nm();
    if count < 1 || far {
        return;
    }
    for (k, sample) in (0..).zip(&mut edit.samples) {
        for (axis, by) in sample.iter_mut().zip(apart) {
            *axis += by * (count - k) / count;
        }
    }
}
