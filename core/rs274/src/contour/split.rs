//! Leads: the moves that bring the cutter to a contour and away from it, told from the contour itself.
//!
//! Two signs are certain, and only they count:
//! * G41 or G42 takes its offset along one move and G40 gives it up along one; what lies before and behind is no wall;
//! * a run holds a closed loop with at most four blocks before and four behind it, and the loop is more than half of it.
//!
//! The line and the tangent quarter circle that lead to an open contour look exactly like a contour that begins with a
//! corner: there the caller names the lines.

use core::ops::Range;

use super::Candidate;
use truepath_units::Offset;
use truepath_units::geometry::Block;

/// The most blocks that lead to a loop, and away from it.
const LEAD_BLOCKS: usize = 4;

/// The blocks of a run that are its contour.
pub(super) fn without_leads(blocks: &[Block], run: &Candidate) -> Range<usize> {
    let end = blocks.len().saturating_sub(run.exit);
    let offset = if run.entry < end { run.entry..end } else { 0..blocks.len() };
    let within = blocks.get(offset.clone()).unwrap_or_default();
    match inner_loop(within) {
        Some(found) => offset.start.saturating_add(found.start)..offset.start.saturating_add(found.end),
        None => offset,
    }
}

/// The closed loop inside a run that has leads.
fn inner_loop(blocks: &[Block]) -> Option<Range<usize>> {
    let half = Offset::from_nm(length(blocks).nm() / 2);
    let mut best: Option<Range<usize>> = None;
    for lead_in in 0..=LEAD_BLOCKS {
        for lead_out in 0..=LEAD_BLOCKS {
            let found = lead_in..blocks.len().saturating_sub(lead_out);
            let Some(inner) = blocks.get(found.clone()).filter(|b| !b.is_empty()) else { continue };
            let shorter = best.as_ref().is_some_and(|b| b.len() >= found.len());
            if found.len() < blocks.len() && !shorter && closed(inner) && length(inner) > half {
                best = Some(found);
            }
        }
    }
    best
}

/// Whether blocks end where they start.
pub(super) fn closed(blocks: &[Block]) -> bool {
    match (blocks.first(), blocks.last()) {
        (Some(first), Some(last)) => first.curve.start() == last.curve.end(),
        _ => false,
    }
}

/// Their length together.
pub(super) fn length(blocks: &[Block]) -> Offset {
    match (blocks.first(), blocks.last()) {
        (Some(first), Some(last)) => last.s + last.curve.length() - first.s,
        _ => Offset::ZERO,
    }
}
