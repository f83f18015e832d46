//! Engagement angle from geometry: where the cutter circle leaves the stock.
//!
//! φ is measured from the wall normal n towards the direction of travel t; the engaged arc is 0…φ₁ and φ₁ is the last
//! place, going from n towards t, where the circle of the displaced cutter crosses the raw stock. P23 eq. (5) is
//! wrong as printed (134.4° on its own example); here φ₁ = atan2(q·t, q·n) of the crossing point q. Block boundaries
//! play no part: the load rises before an arc begins.

use super::path::Path;
use super::sample::Sample;
use truepath_units::geometry::{Direction, Point, Vector};
use truepath_units::{Offset, Real, atan2, isqrt_rounded};

/// The nominal place of an actual cutter centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Normal towards the wall.
    pub normal: Direction,
    /// Direction of travel.
    pub heading: Direction,
    /// Index of the sample at or before it.
    pub index: usize,
}

/// Steps along the path by which a displaced centre may be away from its own sample.
const FRAME_STEPS: usize = 64;

impl Path<'_> {
    /// The frame at the nominal place of the centre displaced by `displacement` from sample `index`: the force turns
    /// with the place where the cutter is, not with the place it was sent to.
    pub fn frame(&self, index: usize, displacement: Vector) -> Option<Frame> {
        let samples = self.samples();
        let own = samples.get(index)?;
        let centre = own.point + displacement;
        // Where the normal turns on the spot there is no path to be displaced along.
        let shares = |other: Option<&Sample>| other.is_some_and(|o| o.point == own.point);
        if shares(samples.get(index.saturating_add(1))) || shares(index.checked_sub(1).and_then(|i| samples.get(i))) {
            return Some(Frame { normal: own.normal, heading: self.setup().wall.heading(own.normal), index });
        }
        let (mut at, mut found) = (index, None);
        for _ in 0..FRAME_STEPS {
            let here = samples.get(at)?;
            let heading = self.setup().wall.heading(here.normal);
            let along = centre.from(here.point).along(heading);
            let Some(next) = samples.get(at.saturating_add(1)) else { break };
            let gap = next.point.from(here.point).along(heading);
            if along < Offset::ZERO && at > 0 {
                at = at.saturating_sub(1);
                // A backward step that lands short of the next sample has found the interval.
                let behind = samples.get(at)?;
                let h = self.setup().wall.heading(behind.normal);
                if centre.from(behind.point).along(h) >= Offset::ZERO {
                    break;
                }
            } else if along > gap && gap > Offset::ZERO {
                at = at.saturating_add(1);
            } else {
                found = Some((along, gap));
                break;
            }
        }
        let (here, next) = (samples.get(at)?, samples.get(at.saturating_add(1)).or(samples.get(at))?);
        let (along, gap) = found.unwrap_or_else(|| {
            let heading = self.setup().wall.heading(here.normal);
            (centre.from(here.point).along(heading), next.point.from(here.point).along(heading))
        });
        let u = along.over(gap).max(Real::ZERO).min(Real::ONE);
        let blend = |a: Real, b: Real| Real::dot(a, Real::ONE - u, b, u);
        let normal = Direction { x: blend(here.normal.x, next.normal.x), y: blend(here.normal.y, next.normal.y) };
        Some(Frame { normal, heading: self.setup().wall.heading(normal), index: at })
    }

    /// The engagement angle φ₁ (rad, 0…π) of a cutter whose centre is displaced from sample `index`.
    ///
    /// Looks at the stock from the sample to 2.2 radii ahead; stretches that cannot reach the circle are stepped
    /// over, so the cost is bounded by the window and does not depend on the length of the contour.
    pub fn engagement(&self, index: usize, displacement: Vector, frame: &Frame) -> Real {
        self.engagement_about(index, displacement, frame, &mut Exit::default())
    }

    /// The same, with what is kept of the last engagement on this path.
    pub(super) fn engagement_about(&self, index: usize, displacement: Vector, frame: &Frame, kept: &mut Exit) -> Real {
        let samples = self.samples();
        let Some(here) = samples.get(index) else { return Real::ZERO };
        let radius = self.setup().radius;
        let walk = Walk {
            centre: here.point + displacement,
            heading: frame.heading,
            radius,
            stride: self.stock_step().nm().max(1),
            end: here.s + radius + radius + radius.scaled(Real::ratio(1, 5)),
        };
        let start = frame.index.min(index);
        let mut stocked = || {
            kept.end = self.first_beyond(walk.end, kept.end);
            let within = samples.get(start..kept.end)?;
            let last = walk.last_of_stocked(within)?.saturating_add(start);
            Some(last).filter(|at| walk.is_ahead_of(samples, *at))
        };
        let known = if self.is_stocked() && radius < REACH { stocked() } else { None };
        let Some(inside) = known.or_else(|| walk.last_of_all(samples, start)) else { return Real::ZERO };
        let (Some(a), Some(b)) = (samples.get(inside), samples.get(inside.saturating_add(1))) else {
            return Real::ZERO;
        };
        let sagitta = match kept.sagitta {
            Some((at, sagitta)) if at == inside => sagitta,
            _ => sagitta(a, b),
        };
        kept.sagitta = Some((inside, sagitta));
        let exit = crossing((a.stock, b.stock, sagitta), walk.centre, walk.radius).from(walk.centre);
        let angle = atan2(exit.along(frame.heading).nm(), exit.along(frame.normal).nm());
        angle.max(Real::ZERO)
    }
}

/// What is kept of an engagement for the next one on the same path, which is mostly near.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Exit {
    /// The first sample behind the stock that was looked at.
    end: usize,
    /// The sample before the place where the circle left the stock, and how far the stock bulges behind it.
    sagitta: Option<(usize, Vector)>,
}

/// Radius and components whose squares add up in 64 bits.
const REACH: Offset = Offset::from_um(1_000_000);

/// Components within this have squares that add up in 62 bits, nm.
const WITHIN: i64 = 1 << 30;

/// A walk along the stock ahead of a cutter.
struct Walk {
    centre: Point,
    heading: Direction,
    radius: Offset,
    /// The largest distance between neighbouring samples of the stock, nm.
    stride: i64,
    /// Arc length at which it ends.
    end: Offset,
}

impl Walk {
    /// The last sample from `start` on whose stock is inside the circle and not behind the cutter.
    fn last_of_all(&self, samples: &[Sample], start: usize) -> Option<usize> {
        // Mostly the last one inside is ahead.
        let last = self.last(samples, start, |_| true).filter(|at| self.is_ahead_of(samples, *at));
        last.or_else(|| self.last(samples, start, |sample| self.is_ahead(sample)))
    }

    fn is_ahead_of(&self, samples: &[Sample], at: usize) -> bool {
        samples.get(at).is_some_and(|sample| self.is_ahead(sample))
    }

    /// The last sample whose stock is inside the circle, where stock stands beside every sample: looked for from the last one back,
    /// which begins with the longest steps. Distances are told by their squares, and only so much is stepped over as surely does not
    /// reach the circle. Of a radius below [`REACH`].
    fn last_of_stocked(&self, samples: &[Sample]) -> Option<usize> {
        let radius = self.radius.nm();
        let square = radius.wrapping_mul(radius);
        // As far from the centre as rounds to less than the radius.
        let inside = square.wrapping_sub(radius);
        // The largest distance was rounded.
        let stride = self.stride.saturating_add(1);
        // d − r = (d² − r²)/(d + r), and d + r is √2 + 1 radii at most below √2 radii. In strides, by a reciprocal: a division of
        // 64 bits is slow on a PC and a routine on the microcontroller. Rounded down, which steps over less.
        let near = radius.wrapping_mul(5) / 2;
        let beyond = per(near.saturating_add(1).saturating_mul(stride));
        let radii = radius.checked_div(stride).unwrap_or(0).unsigned_abs();
        let (centre_x, centre_y) = (self.centre.x.nm(), self.centre.y.nm());
        let mut behind = samples.len();
        loop {
            let at = behind.checked_sub(1)?;
            let sample = samples.get(at)?;
            // Of places within 4 · 10⁹ m.
            let x = sample.stock.x.nm().wrapping_sub(centre_x);
            let y = sample.stock.y.nm().wrapping_sub(centre_y);
            let skip = if (x.wrapping_add(WITHIN) | y.wrapping_add(WITHIN)) as u64 >> 31 != 0 {
                0
            } else {
                let distance = x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y));
                if distance <= inside {
                    return Some(at);
                } else if distance < square.wrapping_mul(2) {
                    times(distance.wrapping_sub(square), beyond)
                } else if distance < square.wrapping_mul(4) {
                    // 0.41 radii at least.
                    radii.wrapping_mul(2) / 5
                } else {
                    radii
                }
            };
            behind = behind.saturating_sub(skip.max(1) as usize);
        }
    }

    fn is_ahead(&self, sample: &Sample) -> bool {
        sample.stock.from(self.centre).along(self.heading) > -Offset::from_nm(self.stride)
    }

    #[inline]
    fn last(&self, samples: &[Sample], start: usize, counts: impl Fn(&Sample) -> bool) -> Option<usize> {
        let (mut last, mut at) = (None, start);
        while let Some(sample) = samples.get(at) {
            if sample.s > self.end {
                break;
            }
            let depth = (self.radius - sample.stock.distance(self.centre)).nm();
            if depth > 0 && sample.on_surface && counts(sample) {
                last = Some(at);
            }
            // The circle is at least |depth| away along the stock: no crossing before that.
            let skip = depth.saturating_abs().checked_div(self.stride).unwrap_or(0).max(1);
            at = at.saturating_add(skip.unsigned_abs() as usize);
        }
        last
    }
}

/// 2⁶⁴ over a positive number, rounded down.
fn per(divisor: i64) -> u64 {
    u64::MAX.checked_div(divisor.unsigned_abs()).unwrap_or(0)
}

/// A number that is not negative times such a reciprocal, rounded down: at most the quotient.
const fn times(number: i64, reciprocal: u64) -> u64 {
    ((number.unsigned_abs() as u128).wrapping_mul(reciprocal as u128) >> 64) as u64
}

/// Newton steps for the crossing of the circle with the curved stock between two samples.
const CROSSING_STEPS: usize = 4;

/// How far the stock between two samples bulges from its chord, like the arc that its normals belong to.
fn sagitta(a: &Sample, b: &Sample) -> Vector {
    let chord = b.stock.from(a.stock);
    // A straight stock, as most is, has no bulge and needs no direction.
    let bulge = a.normal.cross(b.normal) * Real::ratio(1, 8);
    let along = if bulge == Real::ZERO { None } else { chord.direction() };
    along.map_or(Vector::ZERO, |along| along.right().times(chord.length().scaled(bulge)))
}

/// Where the stock between two samples, the first inside the circle and the second outside, crosses it.
fn crossing((a, b, sagitta): (Point, Point, Vector), centre: Point, radius: Offset) -> Point {
    let chord = b.from(a);
    if chord == Vector::ZERO {
        return a;
    }
    let spoke = a.from(centre);
    // |spoke + u·chord|² = r²
    let (p, q) = (chord.dot(chord), spoke.dot(chord));
    let c = spoke.dot(spoke).wrapping_sub(i128::from(radius.nm()).wrapping_mul(radius.nm().into()));
    let discriminant = product(q, q).saturating_sub(product(p, c)).max(0);
    let root = isqrt_rounded(discriminant.unsigned_abs()) as i128;
    let u = Real::narrow(truepath_units::div_rounded(root.saturating_sub(q) << Real::FRACTION_BITS, p));
    let u = u.max(Real::ZERO).min(Real::ONE);
    let at = |u: Real| a + chord.scaled(u) + sagitta.scaled(u * (Real::ONE - u) * Real::from_int(4));
    // The chord gives the start; where stock and circle meet at a small angle its bulge takes a few Newton steps. A step
    // that changes nothing is the last: every further one would be the same, as is one from a place on the circle.
    let (mut u, mut point) = (u, at(u));
    for _ in 0..CROSSING_STEPS {
        let reach = point.from(centre);
        let miss = reach.length() - radius;
        if miss == Offset::ZERO {
            break;
        }
        let Some(out) = reach.direction() else { break };
        let tangent = chord + sagitta.scaled((Real::ONE - u - u) * Real::from_int(4));
        let next = (u - miss.over(tangent.along(out))).max(Real::ZERO).min(Real::ONE);
        if next == u {
            break;
        }
        u = next;
        point = at(u);
    }
    point
}

/// A product, saturated; of two numbers of 64 bits one multiplication.
#[inline]
fn product(a: i128, b: i128) -> i128 {
    match (i64::try_from(a), i64::try_from(b)) {
        (Ok(a), Ok(b)) => i128::from(a).wrapping_mul(b.into()),
        _ => a.saturating_mul(b),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic, clippy::indexing_slicing)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Small and large cutters, fine and coarse steps, stock straight or round, on either side of the circle and far away.
        #[test]
        fn no_stock_inside_the_circle_is_stepped_over(
            radius in prop_oneof![1i64..5_000, 10_000i64..20_000_000, 900_000_000i64..1_000_000_000],
            step in 0.001f64..0.4,
            turn in -0.01f64..0.01,
            away in (-3.0f64..3.0, -3.0f64..3.0),
            start in 0usize..40,
        ) {
            let length = (radius as f64 * step).max(1.0);
            let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0f64);
            let mut samples = std::vec::Vec::new();
            for k in 0..400i64 {
                let stock = Point::from_nm(x as i64, y as i64);
                samples.push(Sample { stock, s: Offset::from_nm(k * length as i64), ..Sample::BLANK });
                (x, y, heading) = (x + length * heading.cos(), y + length * heading.sin(), heading + turn);
            }
            let stride = samples.windows(2).map(|pair| pair[0].stock.distance(pair[1].stock).nm()).max().unwrap_or(1).max(1);
            let at = |share: f64| (share * radius as f64) as i64;
            let walk = Walk {
                centre: Point::from_nm(at(away.0), at(away.1)),
                heading: Direction::X,
                radius: Offset::from_nm(radius),
                stride,
                end: Offset::MAX,
            };
            let is_inside = |sample: &Sample| {
                let spoke = sample.stock.from(walk.centre);
                let [x, y] = [spoke.x, spoke.y].map(|v| i128::from(v.nm()));
                x * x + y * y <= i128::from(radius) * i128::from(radius - 1)
            };
            // The stock of a path is continued until it is out of reach.
            prop_assume!(samples.last().is_some_and(|last| !is_inside(last)));
            let every = (start..samples.len()).rfind(|k| is_inside(&samples[*k]));
            prop_assert_eq!(walk.last_of_stocked(&samples[start..]).map(|at| at + start), every);
        }
    }
}
