//! The place of a contour nearest to a point.

use super::{Block, Contour, Extent, Point, Shape};
use crate::{Offset, Real, atan2};

/// The foot of a point on a contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nearest {
    /// Arc length of the foot from the start of the contour.
    pub s: Offset,
    /// Distance of the point from the foot, positive on the left of travel.
    pub left: Offset,
    /// Whether the point lies beside the contour, not beyond one of its ends or sharp corners. The wedge outside the
    /// flat corner of two facets of a smooth curve counts as beside.
    pub beside: bool,
    /// Index of the block.
    pub block: usize,
}

impl Contour<'_> {
    /// The places whose distance from `point` is locally the smallest, one per block at most, given to `visit` in
    /// the order of the contour. Cost grows with the number of blocks: for measurements, not for the servo cycle.
    pub fn feet(&self, point: Point, mut visit: impl FnMut(Nearest)) {
        for (index, block) in self.blocks().iter().enumerate() {
            visit(self.foot(index, block, point));
        }
    }

    /// The foot on one block.
    #[inline]
    fn foot(&self, index: usize, block: &Block, point: Point) -> Nearest {
        let origin = self.blocks().first().map_or(Offset::ZERO, |b| b.s);
        let length = block.curve.length();
        let fraction = match block.curve.shape() {
            Shape::Line => {
                let along = point.from(block.curve.start()).along(block.curve.start_heading());
                along.over(length)
            }
            Shape::Arc { centre, sweep } => {
                let spoke = block.curve.start().from(centre);
                let to = point.from(centre);
                let (mut cross, mut dot) = (spoke.cross(to), spoke.dot(to));
                while cross.unsigned_abs().max(dot.unsigned_abs()) > u128::from(i64::MAX.unsigned_abs()) {
                    cross /= 2;
                    dot /= 2;
                }
                let mut angle = in_sense_of(atan2(cross as i64, dot as i64), sweep);
                // Beyond both ends: the nearer end.
                let past = angle.abs() - sweep.abs();
                if past > Real::ZERO && past > Real::TAU - angle.abs() {
                    angle -= Real::TAU.with_sign_of(sweep);
                }
                angle / sweep
            }
        };
        let beside =
            (fraction >= Real::ZERO && fraction <= Real::ONE) || self.in_facet(index, fraction > Real::ONE, point);
        let fraction = fraction.max(Real::ZERO).min(Real::ONE);
        let foot = block.curve.point(fraction);
        let side = point.from(foot).along(block.curve.heading(fraction).left());
        let distance = point.distance(foot);
        let left = if side < Offset::ZERO { -distance } else { distance };
        Nearest { s: block.s - origin + length.scaled(fraction), left, beside, block: index }
    }
}

/// Stretches of blocks whose rectangles are kept.
const STRETCHES: usize = 16;

/// Finds the nearest place of one contour for many points, one after the other along another path: stretches and blocks are passed over
/// whose rectangle is farther away than the foot on the block that was the nearest to the point before, or than one found since.
#[derive(Clone, Copy, Debug)]
pub struct Nearby<'a> {
    contour: Contour<'a>,
    /// Rectangles of as many blocks each as `stretch` says.
    extents: [Extent; STRETCHES],
    stretch: usize,
    /// Block of the last nearest place.
    hint: usize,
}

impl<'a> Nearby<'a> {
    /// Looks at every block once.
    pub fn new(contour: Contour<'a>) -> Self {
        let stretch = contour.blocks().len().div_ceil(STRETCHES).max(1);
        let mut extents = [Extent::EMPTY; STRETCHES];
        for (extent, blocks) in extents.iter_mut().zip(contour.blocks().chunks(stretch)) {
            *extent = Extent::of(blocks);
        }
        Self { contour, extents, stretch, hint: 0 }
    }

    /// The contour.
    pub const fn contour(&self) -> &Contour<'a> {
        &self.contour
    }

    /// The nearest of the [`feet`](Contour::feet) of a point, the first one of equally near ones.
    pub fn nearest(&mut self, point: Point) -> Option<Nearest> {
        let contour = self.contour;
        let hinted = contour.blocks().get(self.hint).map(|block| contour.foot(self.hint, block, point));
        let mut reach = hinted.map_or(Offset::MAX, |foot| foot.left.abs());
        let mut best: Option<Nearest> = None;
        let mut first = 0usize;
        for (extent, blocks) in self.extents.iter().zip(contour.blocks().chunks(self.stretch)) {
            if !extent.is_farther(point, reach) {
                for (index, block) in (first..).zip(blocks) {
                    if Extent::of_curve(&block.curve).is_farther(point, reach) {
                        continue;
                    }
                    let foot = contour.foot(index, block, point);
                    if best.is_none_or(|best| foot.left.abs() < best.left.abs()) {
                        reach = foot.left.abs().min(reach);
                        best = Some(foot);
                    }
                }
            }
            first = first.saturating_add(self.stretch);
        }
        self.hint = best.map_or(0, |foot| foot.block);
        best
    }
}

/// The same angle counted in the sense of `sweep`, 0…2π in magnitude.
fn in_sense_of(angle: Real, sweep: Real) -> Real {
    let against = (sweep > Real::ZERO && angle < Real::ZERO) || (sweep < Real::ZERO && angle > Real::ZERO);
    if against { angle + Real::TAU.with_sign_of(sweep) } else { angle }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Curve, Vector};

    /// A path of lines and half circles with corners in a square of 40 mm.
    fn path() -> impl Strategy<Value = Vec<Block>> {
        let step = (-20_000i64..20_000, -20_000i64..20_000, any::<bool>(), any::<bool>());
        prop::collection::vec(step, 1..60).prop_map(|corners| {
            let (mut at, mut s) = (Point::from_nm(0, 0), Offset::ZERO);
            let mut blocks = Vec::new();
            for (x, y, round, left) in corners {
                let next = Point::from_nm(0, 0) + Vector { x: Offset::from_um(x), y: Offset::from_um(y) };
                let middle = at + next.from(at).scaled(Real::HALF);
                let arc = || Curve::arc(at, next, middle, left).ok();
                let Some(curve) = (if round { arc() } else { Curve::line(at, next) }) else { continue };
                blocks.push(Block { curve, s, feed: Real::ONE, line: 1 });
                s += curve.length();
                at = next;
            }
            blocks
        })
    }

    proptest! {
        #[test]
        fn the_nearest_place_is_that_of_a_look_at_every_block(
            blocks in path(),
            points in prop::collection::vec((-30_000_000i64..30_000_000, -30_000_000i64..30_000_000), 1..20),
        ) {
            let Some(contour) = Contour::new(&blocks) else { return Ok(()) };
            let mut nearby = Nearby::new(contour);
            // On the path as well, where many feet are at no distance.
            let ends = blocks.iter().map(|b| b.curve.end());
            for point in points.iter().map(|(x, y)| Point::from_nm(*x, *y)).chain(ends) {
                let mut best: Option<Nearest> = None;
                contour.feet(point, |foot| {
                    if best.is_none_or(|b| foot.left.abs() < b.left.abs()) {
                        best = Some(foot);
                    }
                });
                prop_assert_eq!(nearby.nearest(point), best);
            }
        }
    }
}
