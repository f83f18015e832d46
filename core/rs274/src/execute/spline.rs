//! Splines and their flattening.
//!
//! One kind covers them all: the rational B-spline of order k over a clamped uniform knot vector (Piegl and Tiller, The
//! NURBS Book, §4.2), of which the Bézier curves of G5 (k = 4, four points) and G5.1 (k = 3, three points) are the case
//! of a single span. It is evaluated by de Boor's algorithm in whole numbers, relative to the first point, so that a
//! shifted, turned or mirrored program gives shifted, turned or mirrored lines.
//!
//! The lines keep to the curve within the tolerance: a step is halved until three places between its ends are within
//! half of it. Limits: [`POINTS`] control points, order [`ORDER`], 4096 lines a span.

use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real, div_rounded, shift_rounded};

/// Control points of one spline, the start included.
pub(super) const POINTS: usize = 32;

/// The highest order (degree + 1).
pub(super) const ORDER: usize = 8;

/// A span in units of the parameter.
const SPAN: i64 = 1 << 16;

/// The shortest step along a span.
const SHORTEST: i64 = SPAN / 4096;

/// A control point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ControlPoint {
    /// From the start of the spline.
    pub(super) at: Vector,
    /// Its weight, above 0.
    pub(super) weight: Real,
}

impl ControlPoint {
    /// With weight 1.
    pub(super) const fn plain(at: Vector) -> Self {
        Self { at, weight: Real::ONE }
    }
}

/// A point in homogeneous coordinates: the weighted point, and the weight, both with 32 fraction bits.
#[derive(Clone, Copy, Default)]
struct Weighted {
    x: i128,
    y: i128,
    weight: i128,
}

impl Weighted {
    fn of(point: ControlPoint) -> Self {
        let weight = i128::from(point.weight.bits());
        let weighted = |v: Offset| weight.saturating_mul(i128::from(v.nm()));
        Self { x: weighted(point.at.x), y: weighted(point.at.y), weight }
    }

    /// From `self` (0) to `other` (1).
    fn towards(self, other: Self, share: Real) -> Self {
        let part = |a: i128, b: i128| {
            let step = b.saturating_sub(a).saturating_mul(i128::from(share.bits()));
            a.saturating_add(rounded(step))
        };
        Self { x: part(self.x, other.x), y: part(self.y, other.y), weight: part(self.weight, other.weight) }
    }

    fn place(self) -> Vector {
        let of = |v: i128| Offset::from_nm(i64::try_from(div_rounded(v, self.weight)).unwrap_or(i64::MAX));
        Vector { x: of(self.x), y: of(self.y) }
    }
}

/// A product of two numbers with 32 fraction bits, with 32 fraction bits.
const fn rounded(product: i128) -> i128 {
    shift_rounded(product, Real::FRACTION_BITS)
}

/// A spline: at least `order` points, `2 ≤ order ≤ ORDER`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spline<'a> {
    pub(super) points: &'a [ControlPoint],
    pub(super) order: usize,
}

impl Spline<'_> {
    fn spans(&self) -> usize {
        self.points.len().saturating_sub(self.order).saturating_add(1)
    }

    /// A knot, in units of the parameter.
    fn knot(&self, index: usize) -> i64 {
        let inner = index.saturating_sub(self.order.saturating_sub(1)).min(self.spans());
        i64::try_from(inner).unwrap_or(i64::MAX).saturating_mul(SPAN)
    }

    /// The place at `along` (0 … `SPAN`) of a span.
    fn place(&self, span: usize, along: i64) -> Vector {
        let mut level = [Weighted::default(); ORDER];
        for (slot, point) in level.iter_mut().zip(self.points.iter().skip(span)).take(self.order) {
            *slot = Weighted::of(*point);
        }
        let parameter = i64::try_from(span).unwrap_or(0).saturating_mul(SPAN).saturating_add(along);
        for step in 1..self.order {
            for j in (step..self.order).rev() {
                let low = self.knot(span.saturating_add(j));
                let high = self.knot(span.saturating_add(j).saturating_add(self.order).saturating_sub(step));
                let share = Real::ratio(parameter.saturating_sub(low), high.saturating_sub(low).max(1));
                let before = level.get(j.saturating_sub(1)).copied().unwrap_or_default();
                if let Some(point) = level.get_mut(j) {
                    *point = before.towards(*point, share);
                }
            }
        }
        level.get(self.order.saturating_sub(1)).copied().unwrap_or_default().place()
    }

    /// Gives the ends of the lines that stand for it, from the start, to `line`.
    ///
    /// # Errors
    /// What `line` answers.
    pub(super) fn flatten<E>(&self, tolerance: Offset, mut line: impl FnMut(Vector) -> Result<(), E>) -> Result<(), E> {
        let within = tolerance.nm() / 2;
        let mut from = Vector::default();
        for span in 0..self.spans() {
            let (mut at, mut step) = (0i64, SPAN);
            while at < SPAN {
                let to = self.place(span, at.saturating_add(step));
                let quarter = |n: i64| self.place(span, at.saturating_add((step / 4).saturating_mul(n)));
                let close = |n| distance(from, to, quarter(n)) <= within;
                // A turn back just before an end runs along the chord, beyond it; it is short when the middle of the
                // curve is near that of the chord.
                let even = || uneven(from, to, quarter(2)) <= tolerance.nm().saturating_mul(2);
                if step > SHORTEST && !(close(2) && close(1) && close(3) && even()) {
                    step /= 2;
                    continue;
                }
                line(to)?;
                from = to;
                at = at.saturating_add(step);
                // Steps stay at multiples of their length, so twice the length is tried only where it fits.
                while step < SPAN && at.checked_rem(step.saturating_mul(2)) == Some(0) {
                    step = step.saturating_mul(2);
                    if at.saturating_add(step) > SPAN {
                        step /= 2;
                        break;
                    }
                }
            }
        }
        Ok(())
    }
}

/// How far a place is from the middle between two others, nm.
fn uneven(from: Vector, to: Vector, place: Vector) -> i64 {
    let twice = |a: Offset, b: Offset, c: Offset| c + c - a - b;
    let off = Vector { x: twice(from.x, to.x, place.x), y: twice(from.y, to.y, place.y) };
    off.length().nm() / 2
}

/// How far a place is from the line between two others, nm, rounded up.
fn distance(from: Vector, to: Vector, place: Vector) -> i64 {
    let less = |a: Vector, b: Vector| Vector { x: a.x - b.x, y: a.y - b.y };
    let (chord, off) = (less(to, from), less(place, from));
    // Behind an end the end is nearest: a cusp runs along its chord and beyond it.
    if chord.dot(off) <= 0 {
        return off.length().nm();
    }
    let beyond = less(place, to);
    if chord.dot(beyond) >= 0 {
        return beyond.length().nm();
    }
    let height = div_rounded(chord.cross(off).saturating_abs(), i128::from(chord.length().nm().max(1)));
    i64::try_from(height).unwrap_or(i64::MAX).saturating_add(1)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::indexing_slicing)]
    #![allow(clippy::float_arithmetic)]
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const MM: i64 = 1_000_000;

    fn flat(points: &[(i64, i64, f64)], order: usize) -> Vec<(i64, i64)> {
        let weight = |w: f64| Real::from_bits((w * 4_294_967_296.0) as i64);
        let points: Vec<_> =
            points.iter().map(|p| ControlPoint { at: Vector::from_nm(p.0, p.1), weight: weight(p.2) }).collect();
        let mut lines = std::vec![(0, 0)];
        Spline { points: &points, order }
            .flatten(Offset::from_um(1), |to| {
                lines.push((to.x.nm(), to.y.nm()));
                Ok::<(), ()>(())
            })
            .unwrap();
        lines
    }

    /// A full circle of radius 10 about (−10, 0) in nine points of order 3 would need double knots; a quarter is one span.
    #[test]
    fn a_rational_quarter_circle_keeps_its_radius() {
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let lines = flat(&[(0, 0, 1.0), (0, 10 * MM, half), (-10 * MM, 10 * MM, 1.0)], 3);
        assert_eq!(lines.last(), Some(&(-10 * MM, 10 * MM)));
        for pair in lines.windows(2) {
            let radius = |x: f64, y: f64| (x + 10.0e6).hypot(y);
            let middle = ((pair[0].0 + pair[1].0) as f64 / 2.0, (pair[0].1 + pair[1].1) as f64 / 2.0);
            assert!((radius(pair[1].0 as f64, pair[1].1 as f64) - 10.0e6).abs() < 2.0);
            assert!((radius(middle.0, middle.1) - 10.0e6).abs() < 1_000.0);
        }
        assert!(lines.len() < 200);
    }

    /// Bernstein form, in double precision.
    fn bezier(points: &[(i64, i64, f64)], t: f64) -> (f64, f64) {
        let mut level: Vec<(f64, f64)> = points.iter().map(|p| (p.0 as f64, p.1 as f64)).collect();
        while level.len() > 1 {
            level =
                level.windows(2).map(|w| (w[0].0 + (w[1].0 - w[0].0) * t, w[0].1 + (w[1].1 - w[0].1) * t)).collect();
        }
        level[0]
    }

    fn off(lines: &[(i64, i64)], place: (f64, f64)) -> f64 {
        let to_line = |w: &[(i64, i64)]| {
            let (ax, ay) = (w[0].0 as f64, w[0].1 as f64);
            let (dx, dy) = (w[1].0 as f64 - ax, w[1].1 as f64 - ay);
            let t = (((place.0 - ax) * dx + (place.1 - ay) * dy) / (dx * dx + dy * dy).max(1e-9)).clamp(0.0, 1.0);
            (ax + t * dx - place.0).hypot(ay + t * dy - place.1)
        };
        lines.windows(2).map(to_line).fold(f64::MAX, f64::min)
    }

    proptest! {
        #[test]
        fn the_lines_are_within_the_tolerance_of_the_curve(
            raw in prop::array::uniform3((-100_000_000i64..100_000_000, -100_000_000i64..100_000_000)),
        ) {
            let points = [(0, 0, 1.0), (raw[0].0, raw[0].1, 1.0), (raw[1].0, raw[1].1, 1.0), (raw[2].0, raw[2].1, 1.0)];
            let lines = flat(&points, 4);
            prop_assert_eq!(lines.last(), Some(&raw[2]));
            for n in 0..=200 {
                prop_assert!(off(&lines, bezier(&points, f64::from(n) / 200.0)) < 1_000.0);
            }
        }

        #[test]
        fn a_mirrored_spline_gives_mirrored_lines(
            raw in prop::collection::vec((-9_000_000i64..9_000_000, -9_000_000i64..9_000_000, 1u32..5), 3..9),
        ) {
            let mut points = std::vec![(0, 0, 1.0)];
            points.extend(raw.iter().map(|p| (p.0, p.1, f64::from(p.2))));
            let mirrored: Vec<_> = points.iter().map(|p| (-p.1, p.0, p.2)).collect();
            let turned: Vec<_> = flat(&points, 3).into_iter().map(|p| (-p.1, p.0)).collect();
            prop_assert_eq!(flat(&mirrored, 3), turned);
        }
    }
}
