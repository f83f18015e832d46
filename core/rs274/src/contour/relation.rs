//! How two paths lie to each other: the same, or one farther from the wall.
//!
//! A path is looked at from up to 64 places evenly along it and from its block ends (up to 256 of them, evenly chosen).
//! Beside the end of an open path nothing can be said; such places do not count.

use truepath_units::Offset;
use truepath_units::geometry::{Block, Contour, Curve, Point, Shape, Side};

/// Two places nearer than this are one: rounding of incremental programs and of arc centres.
const SAME: Offset = Offset::from_um(2);
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

/// Whether two paths run over the same places, from wherever and in whichever direction.
pub(super) fn coincide(a: &[Block], b: &[Block]) -> bool {
    let on = |a: &[Block], b: &[Block]| look(a, b, &mut |left| (left.abs() <= SAME).then_some(left.abs())).is_some();
    !Extent::of(a).is_apart(&Extent::of(b), SAME) && on(a, b) && on(b, a)
}

/// A rectangle along the axes that holds a path.
pub(super) struct Extent {
    /// Its lower and upper end along x and y, nm.
    ends: [[i64; 2]; 2],
}

impl Extent {
    pub(super) fn of(path: &[Block]) -> Self {
        let mut ends = [[i64::MAX, i64::MIN]; 2];
        for block in path {
            // No place of an arc is farther from the nearer of its ends than half of its length.
            let more = match block.curve.shape() {
                Shape::Line => 0,
                Shape::Arc { .. } => block.curve.length().nm() / 2,
            };
            for point in [block.curve.start(), block.curve.end()] {
                for ([lower, upper], at) in ends.iter_mut().zip([point.x.nm(), point.y.nm()]) {
                    *lower = at.saturating_sub(more).min(*lower);
                    *upper = at.saturating_add(more).max(*upper);
                }
            }
        }
        Self { ends }
    }
    /// Whether two of them are farther from each other than `gap`.
    pub(super) fn is_apart(&self, other: &Self, gap: Offset) -> bool {
        let beyond = |([lower, _], [_, upper]): (&[i64; 2], &[i64; 2])| lower.saturating_sub(*upper) > gap.nm();
        self.ends.iter().zip(&other.ends).any(beyond) || other.ends.iter().zip(&self.ends).any(beyond)
    }
}

/// How much farther from the wall of `other` a path lies: all of it on the free side of `other`, which in turn is not
/// all on the free side of the path. Two paths that have each other on the free side are two walls.
pub(super) fn farther(path: &[Block], other: &[Block], wall: Side, reach: Offset) -> Option<Gap> {
    if far(path, other, reach) {
        return None;
    }
    let seen = view_free(path, other, wall)?;
    if seen.lowest > reach || seen.highest <= SAME || view_free(other, path, wall).is_some() {
        return None;
    }
    let band = Offset::from_um(20).max(Offset::from_nm(seen.lowest.nm() / 20));
    let even = count_even(path, other, |d| d.abs() <= seen.lowest + band);
    let parallel = even.1 > 0 && even.0.saturating_mul(5) >= even.1.saturating_mul(4);
    Some(Gap { distance: seen.lowest.max(Offset::ZERO), parallel })
}

/// The least and the greatest distance.
struct View {
    lowest: Offset,
    highest: Offset,
}

/// Distances into the free side; `None` when a place lies on the wall's side.
fn view_free(path: &[Block], other: &[Block], wall: Side) -> Option<View> {
    look(path, other, &mut |left| {
        let free = if wall == Side::Right { left } else { -left };
        (free >= -SAME).then_some(free)
    })
}

/// Looks at another path from every place; `judge` turns the distance to the left into what counts, or ends it.
/// `None` as well when fewer than half of the places lie beside the other path.
fn look(path: &[Block], other: &[Block], judge: &mut dyn FnMut(Offset) -> Option<Offset>) -> Option<View> {
    let (path, other) = (Contour::new(path)?, Contour::new(other)?);
    let mut view = View { lowest: Offset::MAX, highest: Offset::ZERO };
    let (mut seen, mut beside) = (0u32, 0u32);
    let mut place = |point: Point| {
        seen = seen.saturating_add(1);
        let Some(left) = nearest(&other, point) else { return true };
        let Some(distance) = judge(left) else { return false };
        beside = beside.saturating_add(1);
        view.lowest = view.lowest.min(distance);
        view.highest = view.highest.max(distance);
        true
    };
    let all = along(&path, &mut place) && ends(&path, &mut place);
    (all && beside > 0 && beside.saturating_mul(2) >= seen).then_some(view)
}

/// How many of the places evenly along a path hold, and how many lie beside the other one.
fn count_even(path: &[Block], other: &[Block], holds: impl Fn(Offset) -> bool) -> (u32, u32) {
    let (Some(path), Some(other)) = (Contour::new(path), Contour::new(other)) else { return (0, 0) };
    let mut count = (0u32, 0u32);
    along(&path, &mut |point| {
        if let Some(left) = nearest(&other, point) {
            count = (count.0.saturating_add(holds(left).into()), count.1.saturating_add(1));
        }
        true
    });
    count
}

/// Whether a path is certainly farther from another one than `reach`, seen from eight places: no place of the path is
/// farther from the nearest of them than an eighth of its length.
fn far(path: &[Block], other: &[Block], reach: Offset) -> bool {
    let (Some(path), Some(other)) = (Contour::new(path), Contour::new(other)) else { return true };
    let limit = reach + Offset::from_nm(path.length().nm() / 8);
    let mut hint = 0;
    (0..8).all(|k| {
        let s = Offset::from_nm((path.length().nm() / 8).saturating_mul(k));
        path.at(s, hint).is_none_or(|place| {
            hint = place.block;
            let mut least = Offset::MAX;
            other.feet(place.point, |foot| least = least.min(foot.left.abs()));
            least > limit
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
fn nearest(path: &Contour, point: Point) -> Option<Offset> {
    let (length, open) = (path.length(), !path.is_closed());
    let mut best = None;
    path.feet(point, |foot| {
        if best.is_none_or(|(left, _): (Offset, _)| foot.left.abs() < left.abs()) {
            let beyond = open && !foot.beside && (foot.s <= Offset::ZERO || foot.s >= length);
            best = Some((foot.left, beyond));
        }
    });
    best.filter(|(left, beyond)| !beyond || left.abs() <= SAME).map(|(left, _)| left)
}
