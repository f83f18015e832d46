//! The walk along a contour that gives the samples of a path.

use super::sample::Sample;
use super::setup::CutSetup;
use truepath_units::geometry::{Contour, Direction, FACET_TURN_LIMIT, Point, Side};
use truepath_units::{Offset, Real};

/// A turn of the normal at a sharp inside corner is sampled this finely, rad.
const PIVOT_STEP: Real = Real::ratio(1, 100);

/// How far beyond the contour's ends the cutter positions still shape its wall: the reach of the envelope.
pub(super) fn margin(setup: &CutSetup) -> Offset {
    Offset::from_nm(setup.radius.nm() / 2)
}

/// Length of the straight run before and behind the contour: the margin, and from there the look-ahead of the
/// engagement (2.2 radii).
fn run_out(setup: &CutSetup) -> Offset {
    margin(setup) + setup.radius.scaled(Real::ratio(23, 10))
}

/// Produces the samples in order: even steps on every block, so that the ends of blocks, where the engagement has its
/// kinks, are samples; at a sharp inside corner the normal turns on the spot, which is how the wall there is formed.
pub(super) fn walk(contour: &Contour, setup: &CutSetup, step: Offset, mut emit: impl FnMut(Sample)) {
    let blocks = contour.blocks();
    let (Some(start), Some(end)) = (blocks.first(), blocks.last()) else { return };
    let mut give = |s: Offset, point: Point, heading: Direction, block: usize| {
        let normal = setup.wall.normal(heading);
        let feed = blocks.get(block).map_or(Real::ZERO, |b| b.feed);
        let stock = point + normal.times(setup.radius - setup.allowance);
        emit(Sample { s, point, normal, stock, feed, block: block as u32, ..Sample::BLANK });
    };
    let beyond = run_out(setup);
    let steps = pieces(beyond, step);
    let closed = closes_smoothly(contour, setup);
    let length = contour.length();
    let (point, heading) = (start.curve.start(), start.curve.start_heading());
    let mut hint = blocks.len();
    for k in 0..steps {
        let back = beyond.scaled(Real::ratio(steps.saturating_sub(k), steps));
        match contour.at(length - back, hint).filter(|_| closed) {
            Some(place) => {
                hint = place.block;
                give(-back, place.point, place.heading, place.block);
            }
            None => give(-back, point - heading.times(back), heading, 0),
        }
    }
    let mut last = -Offset::MAX;
    for (index, block) in blocks.iter().enumerate() {
        let mut facet = false;
        if let Some(before) = index.checked_sub(1).and_then(|i| blocks.get(i)) {
            let (from, to) = (before.curve.end_heading(), block.curve.start_heading());
            facet = from.dot(to) >= FACET_TURN_LIMIT && before.feed == block.feed;
            pivot(from, to, setup, |heading| give(block.s - start.s, block.curve.start(), heading, index));
        }
        let steps = pieces(block.curve.length(), step);
        for k in 0..steps {
            let s = block.s - start.s + block.curve.length().scaled(Real::ratio(k, steps));
            // On a curve made of very short lines not every line needs a sample.
            if facet && k == 0 && (s - last).nm() < step.nm() / 2 {
                continue;
            }
            if let Some(place) = contour.at(s, index) {
                give(s, place.point, place.heading, index);
                last = s;
            }
        }
    }
    if let Some(place) = contour.at(length, blocks.len()) {
        give(length, place.point, place.heading, place.block);
    }
    let steps = pieces(beyond, step);
    let (point, heading) = (end.curve.end(), end.curve.end_heading());
    let mut hint = 0;
    for k in 1..=steps {
        let ahead = beyond.scaled(Real::ratio(k, steps));
        match contour.at(ahead, hint).filter(|_| closed) {
            Some(place) => {
                hint = place.block;
                give(length + ahead, place.point, place.heading, place.block);
            }
            None => give(length + ahead, point + heading.times(ahead), heading, blocks.len().saturating_sub(1)),
        }
    }
}

/// Whether the contour ends where and as it starts, and is long enough to run on into itself.
pub(super) fn closes_smoothly(contour: &Contour, setup: &CutSetup) -> bool {
    match (contour.blocks().first(), contour.blocks().last()) {
        (Some(first), Some(last)) => {
            let smooth = last.curve.end_heading().dot(first.curve.start_heading()) >= FACET_TURN_LIMIT;
            contour.is_closed() && smooth && contour.length() > run_out(setup)
        }
        _ => false,
    }
}

fn pieces(length: Offset, step: Offset) -> i64 {
    let step = step.nm().max(1);
    length.nm().saturating_add(step.saturating_sub(1)).checked_div(step).unwrap_or(1).max(1)
}

/// Headings between two, when the corner opens towards the wall (an inside corner of the part).
fn pivot(from: Direction, to: Direction, setup: &CutSetup, mut emit: impl FnMut(Direction)) {
    let turn = from.angle_to(to);
    let inside = (turn > Real::ZERO) == (setup.wall == Side::Right);
    if !inside || from.dot(to) >= FACET_TURN_LIMIT {
        return;
    }
    let steps = (turn.abs() / PIVOT_STEP).floor().max(1);
    for k in 0..steps {
        emit(from.turned(turn * Real::ratio(k, steps)));
    }
}
