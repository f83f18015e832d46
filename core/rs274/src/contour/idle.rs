//! Runs that make no wall: moves between cuts, written as cutting moves, and facing.
//!
//! A real contour must never be taken for one, so that every sign has to be there. Either is above everything else that is
//! cut.
//!
//! A **move between cuts** is open, has at most four blocks, all straight, without G41 or G42, and no other run follows its
//! path; and
//! * the tool came up to it from where it had cut, and goes down behind it (a link between two cuts); or
//! * the tool came up to it, and no move of the program ended higher (the way home); or
//! * it lies at Z 0 or above while others are below 0, the tool goes down behind it, and it is no longer than two diameters
//!   (the step to a helix).
//!
//! **Facing** is open and goes to and fro along straight moves, at least three of them, and all but the two outermost have
//! another one beside them on either hand: nearer than the cutter is wide, so that no wall is left between them; or, with a
//! cutter that the job does not describe, equally far, at Z 0 or above while others are below 0.

use super::Candidate;
use super::found::{Criteria, Found, Idle};
use super::split::{closed, length};
use truepath_units::geometry::{Block, Shape};
use truepath_units::{Offset, Position, Real};

/// The most blocks of a move between cuts.
const TRAVEL_BLOCKS: usize = 4;
/// The most blocks of a run that is looked at for facing: every straight one is compared with every other.
const FACING_BLOCKS: usize = 1_000;
/// Gaps that differ by less are the same.
const SAME: Offset = Offset::from_um(2);
/// Cosine of one degree.
const PARALLEL: Real = Real::from_bits(4_294_313_152);

/// Marks the runs that make no wall, from the highest down to the first that does.
pub(super) fn mark(runs: &mut [Found], blocks: &[Block], criteria: &Criteria) {
    let heights = || runs.iter().filter_map(|f| f.run.z);
    let Some(lowest) = heights().min() else { return };
    let top = runs.iter().filter_map(|f| f.run.between.top).max();
    let mut below: Option<Position> = None;
    // Each turn looks at one height; the first that holds a cut ends it.
    for _ in 0..runs.len() {
        let Some(z) = runs.iter().filter_map(|f| f.run.z).filter(|z| below.is_none_or(|b| *z < b)).max() else {
            return;
        };
        let heights = Heights { z, lowest, top };
        let here = || runs.iter().enumerate().filter(|(_, f)| f.run.z == Some(z));
        if z == lowest || here().any(|(_, found)| why(found, runs, blocks, criteria, &heights).is_none()) {
            return;
        }
        for index in 0..runs.len() {
            let Some(found) = runs.get(index).filter(|f| f.run.z == Some(z)) else { continue };
            let idle = why(found, runs, blocks, criteria, &heights);
            if let Some(found) = runs.get_mut(index) {
                found.idle = idle;
            }
        }
        below = Some(z);
    }
}

/// Heights that tell.
struct Heights {
    /// Of the run.
    z: Position,
    /// Of the lowest run.
    lowest: Position,
    /// To which any move goes up.
    top: Option<Position>,
}

impl Heights {
    /// Whether Z 0 is the top of the part, as far as that can be seen, and the run not below it.
    fn above_part(&self) -> bool {
        self.z >= Position::ZERO && self.lowest < Position::ZERO
    }
}

fn why(found: &Found, runs: &[Found], blocks: &[Block], criteria: &Criteria, heights: &Heights) -> Option<Idle> {
    let own = found.blocks(blocks);
    if found.run.wall.is_some() || closed(own) {
        return None;
    }
    let again = |other: &Found| other.first != found.first && other.like == found.like;
    if is_travel(&found.run, own, criteria.diameter, heights) && !runs.iter().any(again) {
        return Some(Idle::Travel);
    }
    is_facing(own, criteria.diameter, heights.above_part()).then_some(Idle::Facing)
}

fn is_travel(run: &Candidate, own: &[Block], diameter: Offset, heights: &Heights) -> bool {
    if own.len() > TRAVEL_BLOCKS || own.iter().any(|block| block.curve.shape() != Shape::Line) {
        return false;
    }
    let between = run.between;
    let at_the_top = heights.top.is_some_and(|top| heights.z >= top);
    let short = length(own) <= diameter + diameter;
    (between.came_up && (between.goes_down || at_the_top)) || (heights.above_part() && between.goes_down && short)
}

fn is_facing(own: &[Block], diameter: Offset, above_part: bool) -> bool {
    if own.len() > FACING_BLOCKS || own.iter().any(|block| block.curve.shape() != Shape::Line) {
        return false;
    }
    let longest = own.iter().map(|block| block.curve.length()).max().unwrap_or_default();
    let long = || own.iter().filter(|block| block.curve.length() + block.curve.length() >= longest);
    let swept = |block: &&Block| {
        let gap = |left: bool| long().filter_map(|other| gap(block, other, left)).min();
        match (gap(true), gap(false)) {
            (Some(a), Some(b)) => (a < diameter && b < diameter) || (above_part && (a - b).abs() <= SAME),
            _ => false,
        }
    };
    let along = long().fold(Offset::ZERO, |sum, block| sum + block.curve.length());
    let count = long().count();
    count >= 3
        && long().filter(swept).count().saturating_add(2) >= count
        && along.nm().saturating_mul(3) >= length(own).nm().saturating_mul(2)
}

/// How far another straight move runs to the left or to the right of one, where it runs along it.
fn gap(block: &Block, other: &Block, left: bool) -> Option<Offset> {
    let (start, heading) = (block.curve.start(), block.curve.start_heading());
    if heading.dot(other.curve.start_heading()).abs() < PARALLEL {
        return None;
    }
    let place = other.curve.point(Real::HALF).from(start);
    let (along, aside) = (place.along(heading), place.along(if left { heading.left() } else { heading.right() }));
    let beside = aside > Offset::ZERO && along > Offset::ZERO && along < block.curve.length();
    beside.then_some(aside)
}
