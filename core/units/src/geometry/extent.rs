//! Rectangles along the axes that hold blocks.

use super::{Block, Curve, Point, Shape};
use crate::Offset;

/// A rectangle along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Its lower and upper end along x and y, nm.
    ends: [[i64; 2]; 2],
}

/// What rounding may put a place outside of the rectangle of its block, nm, and more.
const MARGIN: i64 = 1_000;

impl Extent {
    /// Of nothing: apart from everything.
    pub const EMPTY: Self = Self { ends: [[i64::MAX, i64::MIN]; 2] };

    /// Of a path.
    pub fn of(path: &[Block]) -> Self {
        path.iter().fold(Self::EMPTY, |mut all, block| {
            for ([lower, upper], [from, to]) in all.ends.iter_mut().zip(Self::of_curve(&block.curve).ends) {
                *lower = from.min(*lower);
                *upper = to.max(*upper);
            }
            all
        })
    }
    /// Of a line or an arc; that of an arc may be larger than need be.
    #[inline]
    pub fn of_curve(curve: &Curve) -> Self {
        // No place of an arc is farther from the nearer of its ends than half of its length.
        let more = match curve.shape() {
            Shape::Line => 0,
            Shape::Arc { .. } => curve.length().nm() / 2,
        };
        let side = |a: i64, b: i64| [a.min(b).saturating_sub(more), a.max(b).saturating_add(more)];
        let (start, end) = (curve.start(), curve.end());
        Self { ends: [side(start.x.nm(), end.x.nm()), side(start.y.nm(), end.y.nm())] }
    }
    /// Whether two of them are farther from each other than `gap` along an axis.
    pub fn is_apart(&self, other: &Self, gap: Offset) -> bool {
        let beyond = |([lower, _], [_, upper]): (&[i64; 2], &[i64; 2])| lower.saturating_sub(*upper) > gap.nm();
        self.ends.iter().zip(&other.ends).any(beyond) || other.ends.iter().zip(&self.ends).any(beyond)
    }
    /// Whether no place within is as near to a point as `reach`.
    #[inline]
    pub fn is_farther(&self, point: Point, reach: Offset) -> bool {
        let beyond = |[lower, upper]: [i64; 2], at: i64| lower.saturating_sub(at).max(at.saturating_sub(upper)).max(0);
        let [along_x, along_y] = self.ends;
        let (x, y) = (beyond(along_x, point.x.nm()), beyond(along_y, point.y.nm()));
        let reach = reach.nm().saturating_add(MARGIN);
        if x > reach || y > reach {
            return true;
        }
        let square = |v: i64| u128::from(v.unsigned_abs()).saturating_mul(v.unsigned_abs().into());
        square(x).saturating_add(square(y)) > square(reach)
    }
}
