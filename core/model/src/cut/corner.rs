//! Sharp corners of the path.
//!
//! At an outside corner cut with two lines the parallel curves of the legs cross: beyond the crossing there is neither
//! stock nor wall. At an inside corner the wall is formed by the normal turning on the spot; the load falls there the
//! moment the direction changes, which no machine follows, so the places around it are marked.

use super::sample::Sample;
use super::setup::CutSetup;
use truepath_units::geometry::{Block, Contour, FACET_TURN_LIMIT, Point, Side};
use truepath_units::{Offset, Real};

/// How much nearer than the parallel curve the other leg must be to take stock away.
const MARGIN: Offset = Offset::from_um(-2);
/// How near the edge of an outside corner the wall is no longer looked at: a correction of one wall shifts the end of
/// the other, which along its own normal would look like a deep cut.
pub(super) const EDGE: Offset = Offset::from_um(1_000);
/// A wall of a smaller radius than this is an edge that the cutter rolls round.
pub(super) const ROLLED: Offset = Offset::from_um(100);
/// How much of a path made of short lines is looked at to see how it turns, as a share of the cutter's radius, and how
/// many lines at most to either side.
const TURN_WINDOW: Real = Real::ratio(1, 5);
const TURN_LINES: usize = 32;
/// A turn of short lines by less is none to speak of, rad.
const LEAST_TURN: Real = Real::ratio(3, 20);

/// Marks stock and wall that an outside corner cuts away, and the surroundings of inside corners.
pub(super) fn mark(samples: &mut [Sample], setup: &CutSetup) {
    for corner in 1..samples.len() {
        let (left, right) = samples.split_at_mut(corner);
        let (Some(before), Some(behind)) = (left.last(), right.first()) else { continue };
        let spread = before.point.distance(behind.point);
        if before.normal.dot(behind.normal) < FACET_TURN_LIMIT {
            let towards_wall = (before.normal.cross(behind.normal) > Real::ZERO) == (setup.wall == Side::Left);
            if towards_wall {
                let (wall, stock) = (setup.radius, setup.radius - setup.allowance);
                let parallel = |s: &Sample, radius| s.point + s.normal.times(radius);
                cut_away([left, right], wall + EDGE, |s| s.on_wall = false, parallel, wall);
                cut_away([left, right], wall + MARGIN, |s| s.rounds_corner = true, parallel, wall);
                cut_away([left, right], stock + MARGIN, |s| s.on_surface = false, |s, _| s.stock, stock);
            }
        } else if spread == Offset::ZERO {
            let reach = setup.radius + Offset::from_nm(setup.radius.nm() / 5);
            let at = behind.s;
            for sample in left.iter_mut().rev().take_while(|s| at - s.s <= reach) {
                sample.near_corner = true;
            }
            for sample in right.iter_mut().take_while(|s| s.s - at <= reach) {
                sample.near_corner = true;
            }
        }
    }
}

/// Marks the edges of the wall that the path rolls round, and what lies beside them.
pub(super) fn mark_rolled(samples: &mut [Sample], contour: &Contour, setup: &CutSetup) {
    let blocks = contour.blocks();
    let mut known: Option<(u32, bool)> = None;
    let mut is_rolled = |sample: &Sample| match known {
        Some((block, rolled)) if block == sample.block => rolled,
        _ => {
            let rolled = rolls(blocks, sample.block as usize, setup);
            known = Some((sample.block, rolled));
            rolled
        }
    };
    let mut clear = |sample: &mut Sample, last: &mut Option<Offset>| {
        if is_rolled(sample) {
            *last = Some(sample.s);
            sample.rounds_corner = true;
        }
        if last.is_some_and(|s| (sample.s - s).abs() <= EDGE) {
            sample.on_wall = false;
        }
    };
    let (mut ahead, mut back) = (None, None);
    samples.iter_mut().for_each(|sample| clear(sample, &mut ahead));
    samples.iter_mut().rev().for_each(|sample| clear(sample, &mut back));
}

/// Whether the path beside a block rolls round an edge of the wall: it turns, on an arc or on short lines, with the wall
/// inside the turn and hardly wider than the cutter.
fn rolls(blocks: &[Block], index: usize, setup: &CutSetup) -> bool {
    let sense = if setup.wall == Side::Left { Real::ONE } else { -Real::ONE };
    let Some(block) = blocks.get(index) else { return false };
    if let Some(radius) = block.curve.signed_radius() {
        let towards_wall = radius.scaled(sense);
        return towards_wall > Offset::ZERO && towards_wall < setup.radius + ROLLED;
    }
    // Of short lines: the sum of the turns at their joints (the sine will do) over the way between their middles; a long
    // line beside them only ends the turn.
    let window = setup.radius.scaled(TURN_WINDOW);
    if block.curve.length() > window + window {
        return false;
    }
    let (head, tail) = blocks.split_at_checked(index).unwrap_or_default();
    let behind = turned(tail.iter().zip(tail.iter().skip(1)), window, sense);
    let before = turned(head.iter().rev().zip(core::iter::once(block).chain(head.iter().rev())), window, sense);
    let (way, turn) = (behind.0 + before.0, behind.1 + before.1);
    turn > LEAST_TURN && way < (setup.radius + ROLLED).scaled(turn)
}

/// Way over the joints on one side of a block and what the path turns there, up to where it no longer rolls: of facets no longer
/// than `window`.
fn turned<'b>(joints: impl Iterator<Item = (&'b Block, &'b Block)>, window: Offset, sense: Real) -> (Offset, Real) {
    let half = |b: &Block| {
        let length = b.curve.length();
        if length > window + window { Offset::ZERO } else { Offset::from_nm(length.nm() / 2) }
    };
    let (mut way, mut turn) = (Offset::ZERO, Real::ZERO);
    for (a, b) in joints.take(TURN_LINES) {
        let (from, to) = (a.curve.end_heading(), b.curve.start_heading());
        let bend = from.cross(to) * sense;
        let is_line = |b: &Block| b.curve.signed_radius().is_none();
        let goes_on = is_line(a) && is_line(b) && bend > Real::ZERO && from.dot(to) >= FACET_TURN_LIMIT;
        if !goes_on || way >= window {
            break;
        }
        (way, turn) = (way + half(a) + half(b), turn + bend);
    }
    (way, turn)
}

/// Marks the samples on either side of a corner whose parallel point the other side of it cuts away, from
/// the corner outwards until the first that stands.
fn cut_away(
    [left, right]: [&mut [Sample]; 2],
    limit: Offset,
    mark: impl Fn(&mut Sample),
    parallel: impl Fn(&Sample, Offset) -> Point,
    radius: Offset,
) {
    for sample in left.iter_mut().rev() {
        if !reaches(parallel(sample, radius), right.iter(), limit) {
            break;
        }
        mark(sample);
    }
    for sample in right.iter_mut() {
        if !reaches(parallel(sample, radius), left.iter().rev(), limit) {
            break;
        }
        mark(sample);
    }
}

/// Whether the path, followed from the corner for two radii, comes nearer to a point than a limit. Samples that cannot
/// do so, by their distance, are stepped over.
fn reaches<'s>(point: Point, path: impl Iterator<Item = &'s Sample>, limit: Offset) -> bool {
    let mut start: Option<Offset> = None;
    let mut clear_until = Offset::ZERO;
    for sample in path {
        let way = (sample.s - *start.get_or_insert(sample.s)).abs();
        if way > limit + limit {
            return false;
        }
        if way < clear_until {
            continue;
        }
        let distance = point.distance(sample.point);
        if distance < limit {
            return true;
        }
        clear_until = way + distance - limit;
    }
    false
}
