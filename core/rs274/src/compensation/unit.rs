//! Unit vectors fine enough for corners, and sums of scaled unit vectors with one rounding.
//!
//! The directions of [`geometry`](truepath_units::geometry) carry 32 bits behind the point, which a long miter at a narrow
//! corner would magnify to a micrometre. Here a direction carries 60 bits, a length 16 bits of a nanometre, and a
//! place is rounded to the nanometre once. Every operation is odd-symmetric, so that a path turned by 90° or mirrored
//! gives the turned or mirrored bits.
//!
//! Limits: coordinates to ±200 m and radii to 100 m; with them every product below fits 127 bits.

use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, isqrt_rounded, shift_rounded};

/// Bits behind the point of a unit vector.
const UNIT_BITS: u32 = 60;

/// Bits of a nanometre in a [`Fine`] length.
pub(crate) const FINE_BITS: u32 = 16;

/// One, in units of 2⁻⁶⁰.
pub(crate) const ONE: i128 = 1 << UNIT_BITS;

/// A length in 2⁻¹⁶ nm.
pub(crate) type Fine = i128;

/// A direction in the plane, components in units of 2⁻⁶⁰.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unit {
    x: i128,
    y: i128,
}

/// From whole nanometres.
pub(crate) fn fine(length: Offset) -> Fine {
    i128::from(length.nm()) << FINE_BITS
}

/// The root of a sum of squares in 2⁻³² nm².
pub(crate) fn root(square: i128) -> Option<Fine> {
    let square = u128::try_from(square).ok()?;
    i128::try_from(isqrt_rounded(square)).ok()
}

/// The length of a displacement.
pub(crate) fn length(v: Vector) -> Fine {
    // Two coordinates of ±200 m: the sum of squares is below 2⁷⁷.
    let square = v.length_squared().min(u128::MAX >> 34) << (FINE_BITS.saturating_mul(2));
    i128::try_from(isqrt_rounded(square)).unwrap_or(i128::MAX)
}

impl Unit {
    /// The direction of a displacement; `None` for the zero vector.
    pub(crate) fn of(v: Vector) -> Option<Self> {
        let (x, y) = (i128::from(v.x.nm()), i128::from(v.y.nm()));
        let largest = x.unsigned_abs().max(y.unsigned_abs());
        if largest == 0 {
            return None;
        }
        // Scaled so that the length carries 62 significant bits.
        let shift = 62u32.saturating_sub(128u32.saturating_sub(largest.leading_zeros()));
        let (x, y) = (x << shift, y << shift);
        let (ax, ay) = (x.unsigned_abs(), y.unsigned_abs());
        let length = isqrt_rounded(ax.saturating_mul(ax).saturating_add(ay.saturating_mul(ay)));
        let length = i128::try_from(length).ok()?;
        let part = |v: i128| truepath_units::div_rounded(v << UNIT_BITS, length);
        Some(Self { x: part(x), y: part(y) })
    }

    /// A quarter turn counter-clockwise.
    pub(crate) const fn left(self) -> Self {
        Self { x: self.y.saturating_neg(), y: self.x }
    }

    /// The opposite direction.
    pub(crate) const fn reversed(self) -> Self {
        Self { x: self.x.saturating_neg(), y: self.y.saturating_neg() }
    }

    /// Cosine of the turn from here to `other`, units of 2⁻⁶⁰.
    pub(crate) const fn dot(self, other: Self) -> i128 {
        let p = self.x.saturating_mul(other.x);
        shift_rounded(p.saturating_add(self.y.saturating_mul(other.y)), UNIT_BITS)
    }

    /// Sine of the turn from here to `other`, units of 2⁻⁶⁰.
    pub(crate) const fn cross(self, other: Self) -> i128 {
        let p = self.x.saturating_mul(other.y);
        shift_rounded(p.saturating_sub(self.y.saturating_mul(other.x)), UNIT_BITS)
    }

    /// The component of a displacement along this direction.
    pub(crate) fn along(self, v: Vector) -> Fine {
        let p = i128::from(v.x.nm()).saturating_mul(self.x);
        let sum = p.saturating_add(i128::from(v.y.nm()).saturating_mul(self.y));
        shift_rounded(sum, UNIT_BITS.saturating_sub(FINE_BITS))
    }

    /// `from` + `a` along this direction + `b` along its left, each coordinate rounded once.
    pub(crate) fn step(self, from: Point, a: Fine, b: Fine) -> Point {
        let left = self.left();
        let part = |u: i128, v: i128| {
            let sum = a.saturating_mul(u).saturating_add(b.saturating_mul(v));
            let nm = shift_rounded(sum, UNIT_BITS.saturating_add(FINE_BITS));
            Offset::from_nm(i64::try_from(nm).unwrap_or(i64::MAX))
        };
        Point { x: from.x + part(self.x, left.x), y: from.y + part(self.y, left.y) }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    const FAR: i64 = 200_000_000_000;

    proptest! {
        #[test]
        fn a_unit_vector_has_length_one_to_the_last_bits(x in -FAR..FAR, y in -FAR..FAR, scale in 0u32..38) {
            let v = Vector::from_nm(x >> scale, y >> scale);
            prop_assume!(v != Vector::ZERO);
            let u = Unit::of(v).unwrap();
            prop_assert!((u.dot(u) - ONE).abs() <= 4);
            prop_assert_eq!(u.cross(u), 0);
            prop_assert_eq!(Unit::of(-v).unwrap(), u.reversed());
            prop_assert!((u.along(v) - length(v)).abs() <= 2);
        }

        #[test]
        fn a_step_along_the_own_direction_comes_back(x in -FAR..FAR, y in -FAR..FAR) {
            let v = Vector::from_nm(x, y);
            prop_assume!(v != Vector::ZERO);
            let origin = Point::from_nm(0, 0);
            prop_assert_eq!(Unit::of(v).unwrap().step(origin, length(v), 0), origin + v);
        }
    }
}
