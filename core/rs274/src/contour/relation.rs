//! How two paths lie to each other: the same, or one farther from the wall.
//!
//! A path is looked at from up to 64 places evenly along it and from its block ends (up to 256 of them, evenly chosen).
//! Beside the end of an open path nothing can be said; such places do not count.

use truepath_units::Offset;
use truepath_units::geometry::{Block, Contour, Curve, Nearby, Point, Shape, Side};

/// Two places nearer than this are one: rounding of incremental programs and of arc centres.
pub(super) const SAME: Offset = Offset::from_um(2);
/// Places looked at evenly along a path.
const EVEN: i64 = 64;
/// Block ends looked at.
const ENDS: usize = 256;

/// How far a path lies from another one's wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gap {
    /// The smallest distance between the two.
    pub(super) distance: Offset,
    /// Whether the distance is the same nearly everywhere.
    pub(super) parallel: bool,
}

/// Whether two paths are the same blocks in the same order.
pub(super) fn same(a: &[Block], b: &[Block]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_curve(&a.curve, &b.curve))
}

fn same_curve(a: &Curve, b: &Curve) -> bool {
    let near = |a: Point, b: Point| a.distance(b) <= SAME;
    let shapes = match (a.shape(), b.shape()) {
        (Shape::Line, Shape::Line) => true,
        (Shape::Arc { sweep: a, .. }, Shape::Arc { sweep: b, .. }) => a.bits().signum() == b.bits().signum(),
        _ => false,
    };
    let half = truepath_units::Real::HALF;
    shapes && near(a.start(), b.start()) && near(a.end(), b.end()) && near(a.point(half), b.point(half))
}

/// Whether two paths run over the same places, from wherever and in whichever direction. Not if the rectangles that hold them are
/// farther apart than [`SAME`].
pub(super) fn coincide(a: &[Block], b: &[Block]) -> bool {
    let (Some(a), Some(b)) = (Contour::new(a), Contour::new(b)) else { return false };
    let on = |a: &Contour, b: &Contour| {
        look(a, &mut Nearby::new(*b), &mut |left| (left.abs() <= SAME).then_some(left.abs())).is_some()
    };
    on(&a, &b) && on(&b, &a)
}

/// How much farther from the wall of `other` a path lies: all of it on the free side of `other`, which in turn is not
/// all on the free side of the path. Two paths that have each other on the free side are two walls.
pub(super) fn farther(path: &[Block], other: &[Block], wall: Side, reach: Offset) -> Option<Gap> {
    let path = Contour::new(path)?;
    let mut other = Nearby::new(Contour::new(other)?);
    if far(&path, &mut other, reach) {
        return None;
    }
    let seen = view_free(&path, &mut other, wall)?;
    if seen.lowest > reach || seen.highest <= SAME || view_free(other.contour(), &mut Nearby::new(path), wall).is_some()
    {
        return None;
    }
    let band = Offset::from_um(20).max(Offset::from_nm(seen.lowest.nm() / 20));
    let even = count_even(&path, &mut other, |d| d.abs() <= seen.lowest + band);
    let parallel = even.1 > 0 && even.0.saturating_mul(5) >= even.1.saturating_mul(4);
    Some(Gap { distance: seen.lowest.max(Offset::ZERO), parallel })
}

/// The least and the greatest distance.
struct View {
    lowest: Offset,
    highest: Offset,
}

/// Distances into the free side; `None` when a place lies on the wall's side.
fn view_free(path: &Contour, other: &mut Nearby, wall: Side) -> Option<View> {
    look(path, other, &mut |left| {
        let free = if wall == Side::Right { left } else { -left };
        (free >= -SAME).then_some(free)
    })
}

/// Looks at another path from every place; `judge` turns the distance to the left into what counts, or ends it.
/// `None` as well when fewer than half of the places lie beside the other path.
fn look(path: &Contour, other: &mut Nearby, judge: &mut dyn FnMut(Offset) -> Option<Offset>) -> Option<View> {
    let mut view = View { lowest: Offset::MAX, highest: Offset::ZERO };
    let (mut seen, mut beside) = (0u32, 0u32);
    let mut place = |point: Point| {
        seen = seen.saturating_add(1);
        let Some(left) = nearest(other, point) else { return true };
        let Some(distance) = judge(left) else { return false };
        beside = beside.saturating_add(1);
        view.lowest = view.lowest.min(distance);
        view.highest = view.highest.max(distance);
        true
    };
    let all = along(path, &mut place) && ends(path, &mut place);
    (all && beside > 0 && beside.saturating_mul(2) >= seen).then_some(view)
}

/// How many of the places evenly along a path hold, and how many lie beside the other one.
fn count_even(path: &Contour, other: &mut Nearby, holds: impl Fn(Offset) -> bool) -> (u32, u32) {
    let mut count = (0u32, 0u32);
    along(path, &mut |point| {
        if let Some(left) = nearest(other, point) {
            count = (count.0.saturating_add(holds(left).into()), count.1.saturating_add(1));
        }
        true
    });
    count
}

/// Whether a path is certainly farther from another one than `reach`, seen from eight places: no place of the path is
/// farther from the nearest of them than an eighth of its length.
fn far(path: &Contour, other: &mut Nearby, reach: Offset) -> bool {
    let limit = reach + Offset::from_nm(path.length().nm() / 8);
    let mut hint = 0;
    (0..8).all(|k| {
        let s = Offset::from_nm((path.length().nm() / 8).saturating_mul(k));
        path.at(s, hint).is_none_or(|place| {
            hint = place.block;
            other.nearest(place.point).is_none_or(|foot| foot.left.abs() > limit)
        })
    })
}

/// Gives places evenly along a path, until `visit` says no.
fn along(path: &Contour, visit: &mut dyn FnMut(Point) -> bool) -> bool {
    let length = path.length().nm();
    let mut hint = 0;
    (0..EVEN).all(|k| {
        let s = Offset::from_nm((length / EVEN).saturating_mul(k));
        path.at(s, hint).is_none_or(|place| {
            hint = place.block;
            visit(place.point)
        })
    })
}

/// Gives the starts of blocks, until `visit` says no.
fn ends(path: &Contour, visit: &mut dyn FnMut(Point) -> bool) -> bool {
    let step = path.blocks().len().div_ceil(ENDS).max(1);
    path.blocks().iter().step_by(step).all(|block| visit(block.curve.start()))
}

/// Distance to the left of a path; `None` beyond its open ends.
fn nearest(path: &mut Nearby, point: Point) -> Option<Offset> {
    let (foot, path) = (path.nearest(point)?, path.contour());
    let at_an_end = !path.is_closed() && !foot.beside && (foot.s <= Offset::ZERO || foot.s >= path.length());
    (!at_an_end || foot.left.abs() <= SAME).then_some(foot.left)
}
