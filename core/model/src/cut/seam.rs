//! Where the end of a contour comes back to its start.
//!
//! What the cutter took away where it began is gone when it comes round again: its load falls over the last
//! `2·√(r² − (r − h)²)` of the way to nothing, and a correction that stayed as it is on the rest of the wall would cut by its
//! full amount too deep there. At an outside corner that both ends run out beyond, the stock of either leg ends at
//! the other one.
//!
//! Limits: a contour that runs on into itself without a corner has no seam here; see [`closes_smoothly`]. What a lead
//! took away before the contour began is not known, and legs that cross are straight.

use super::corner::{self, EDGE};
use super::sample::Sample;
use super::setup::CutSetup;
use super::walk::closes_smoothly;
use truepath_units::geometry::{Block, Contour, Direction, FACET_TURN_LIMIT, Point, Side};
use truepath_units::{Offset, Real, isqrt_rounded};

/// How far beyond the end of a leg its wall may end: what programs round.
const ROUNDED: Offset = Offset::from_um(10);
/// Legs that meet at less than this sine do not make a corner.
const LEAST_SINE: Real = Real::ratio(1, 5);

/// How the end of a contour meets its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seam {
    /// It comes back to the place where the cut began, and may run on over it.
    Met {
        /// Where the cut began.
        start: Point,
        /// From here on the wall is finished and no stock is left.
        finished: Offset,
    },
    /// Both legs run out beyond an outside corner of the part.
    Corner {
        /// Where the stock of the first leg begins and that of the last one ends.
        stock: [Offset; 2],
        /// Where their walls do.
        wall: [Offset; 2],
    },
}

impl Seam {
    /// The seam of a contour; `None` where its end is away from its start, or runs on into it.
    pub(super) fn of(contour: &Contour, setup: &CutSetup) -> Option<Self> {
        if closes_smoothly(contour, setup) {
            return None;
        }
        if let Some(corner) = crossing(contour, setup) {
            return Some(corner);
        }
        let start = contour.blocks().first()?.curve.start();
        let overlap = contour.overlap().or(contour.is_closed().then_some(Offset::ZERO))?;
        Some(Self::Met { start, finished: contour.length() - overlap })
    }

    /// Takes away of stock and wall what is not there.
    pub(super) fn mark(self, samples: &mut [Sample], setup: &CutSetup) {
        match self {
            Self::Met { start, finished } => meet(samples, setup, start, finished),
            Self::Corner { stock, wall } => {
                let beyond = |s: Offset, [from, to]: [Offset; 2]| s < from || s > to;
                for sample in samples {
                    sample.on_surface &= !beyond(sample.s, stock);
                    sample.on_wall &= !beyond(sample.s, [wall[0] + EDGE, wall[1] - EDGE]);
                    sample.rounds_corner |= beyond(sample.s, wall);
                }
            }
        }
    }
}

/// Of the stock before the finished wall stands what is outside the circle of the cutter where the cut began.
fn meet(samples: &mut [Sample], setup: &CutSetup, start: Point, finished: Offset) {
    let radius = setup.radius;
    let from = samples.partition_point(|sample| sample.s <= finished - radius);
    for sample in samples.iter_mut().skip(from) {
        if sample.s >= finished {
            sample.stock = sample.point + sample.normal.times(radius);
        } else if sample.stock.distance(start) < radius {
            let back = start.from(sample.point);
            let (beside, along) = (back.along(sample.normal), back.along(setup.wall.heading(sample.normal)).nm());
            let square = radius.nm().saturating_mul(radius.nm()).saturating_sub(along.saturating_mul(along));
            let reach = beside + Offset::from_nm(isqrt_rounded(square.max(0).unsigned_abs().into()) as i64);
            sample.stock = sample.point + sample.normal.times(reach.min(radius));
        }
    }
}

/// The corner at which the straight first and last leg of a contour cross on the far side of the wall. Behind the last leg
/// the cutter may roll round the corner, onto the first one.
fn crossing(contour: &Contour, setup: &CutSetup) -> Option<Seam> {
    let rolls = |block: &&Block| {
        let towards_wall = |radius: Offset| (radius > Offset::ZERO) == (setup.wall == Side::Left);
        block.curve.signed_radius().is_some_and(|r| towards_wall(r) && r.abs() < setup.radius + corner::ROLLED)
    };
    let first = contour.blocks().first()?;
    let last = contour.blocks().iter().rev().find(|block| !rolls(block))?;
    if first.curve.signed_radius().is_some() || last.curve.signed_radius().is_some() {
        return None;
    }
    let (on, out) = (first.curve.start_heading(), last.curve.end_heading());
    let sine = out.cross(on);
    let towards_wall = (sine > Real::ZERO) == (setup.wall == Side::Left);
    if !towards_wall || sine.abs() < LEAST_SINE || out.dot(on) >= FACET_TURN_LIMIT {
        return None;
    }
    let length = last.s + last.curve.length() - first.s;
    // Where a line beside the first leg and one beside the last cross: arc lengths on either.
    let cross = |beside_first: Offset, beside_last: Offset| {
        let a = first.curve.start() + setup.wall.normal(on).times(beside_first);
        let b = last.curve.end() + setup.wall.normal(out).times(beside_last);
        let along = |other: Direction| b.from(a).along(other.right()).scaled(Real::ONE / on.cross(out));
        [along(out), length + along(on)]
    };
    let (wall, stock) = (setup.radius, setup.radius - setup.allowance);
    let [wall_from, wall_to] = cross(wall, wall);
    let on_first = wall_from >= -ROUNDED && wall_from <= first.curve.length();
    let on_last = wall_to <= length + ROUNDED && wall_to >= length - last.curve.length();
    // Both raw surfaces end where they cross; when the last leg comes, the first one's wall stands.
    let ends = [cross(stock, stock)[0], cross(wall, stock)[1]];
    (on_first && on_last && wall_from < wall_to).then_some(Seam::Corner { stock: ends, wall: [wall_from, wall_to] })
}
