//! Sharp corners of the path.
//!
//! At an outside corner cut with two lines the parallel curves of the legs cross: beyond the crossing there is neither
//! stock nor wall. At an inside corner the wall is formed by the normal turning on the spot; the load falls there the
//! moment the direction changes, which no machine follows, so the places around it are marked.

use super::sample::Sample;
use super::setup::CutSetup;
use truepath_units::geometry::{FACET_TURN_LIMIT, Point, Side};
use truepath_units::{Offset, Real};

/// How much nearer than the parallel curve the other leg must be to take stock away.
const MARGIN: Offset = Offset::from_um(-2);
/// How near the edge of an outside corner the wall is no longer looked at: a correction of one wall shifts the end of
/// the other, which along its own normal would look like a deep cut.
const EDGE: Offset = Offset::from_um(1_000);

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
                cut_away(
                    left,
                    right,
                    wall + EDGE,
                    |s| &mut s.on_wall,
                    |s, radius| s.point + s.normal.times(radius),
                    wall,
                );
                cut_away(left, right, stock + MARGIN, |s| &mut s.on_surface, |s, _| s.stock, stock);
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

/// Clears a mark of the samples on either side of a corner whose parallel point the other side of it cuts away, from
/// the corner outwards until the first that stands.
fn cut_away(
    left: &mut [Sample],
    right: &mut [Sample],
    limit: Offset,
    flag: fn(&mut Sample) -> &mut bool,
    parallel: fn(&Sample, Offset) -> Point,
    radius: Offset,
) {
    for sample in left.iter_mut().rev() {
        if !reaches(parallel(sample, radius), right.iter(), limit) {
            break;
        }
        *flag(sample) = false;
    }
    for sample in right.iter_mut() {
        if !reaches(parallel(sample, radius), left.iter().rev(), limit) {
            break;
        }
        *flag(sample) = false;
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
