//! The place of a contour nearest to a point.

use super::{Contour, Point, Shape};
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
        let origin = self.blocks().first().map_or(Offset::ZERO, |b| b.s);
        for (index, block) in self.blocks().iter().enumerate() {
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
            visit(Nearest { s: block.s - origin + length.scaled(fraction), left, beside, block: index });
        }
    }
}

/// The same angle counted in the sense of `sweep`, 0…2π in magnitude.
fn in_sense_of(angle: Real, sweep: Real) -> Real {
    let against = (sweep > Real::ZERO && angle < Real::ZERO) || (sweep < Real::ZERO && angle > Real::ZERO);
    if against { angle + Real::TAU.with_sign_of(sweep) } else { angle }
}
