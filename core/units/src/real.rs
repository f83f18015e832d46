//! The general number of the model.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use fixed::types::I32F32;

use super::div_rounded;
use super::round::{difference, products_rounded, products_to_real, sum, symmetric, within_64};

/// A fixed-point number with 31 integer and 32 fraction bits (Q31.32): range ±2.1 × 10⁹, step 2.3 × 10⁻¹⁰.
///
/// The range is symmetric: no number holds −2³¹, whose opposite would not exist, so negation is exact. Sums saturate;
/// products and quotients are formed in 128 bits, rounded once to nearest (ties away from zero) and saturate. A division
/// by zero gives the end of the range (0/0 = 0). No operation panics or wraps.
/// Cost of a product: one 64 × 64 → 128 bit multiplication; not for the servo cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Real(I32F32);

impl Real {
    /// Bits behind the point.
    pub const FRACTION_BITS: u32 = 32;
    /// 0.
    pub const ZERO: Self = Self::from_bits(0);
    /// 1.
    pub const ONE: Self = Self::from_int(1);
    /// 1/2.
    pub const HALF: Self = Self::from_bits(1 << 31);
    /// The largest number.
    pub const MAX: Self = Self::from_bits(i64::MAX);
    /// The smallest number; −[`MAX`](Self::MAX).
    pub const MIN: Self = Self::from_bits(i64::MAX.saturating_neg());
    /// The smallest positive number.
    pub const STEP: Self = Self::from_bits(1);
    /// π, to the last bit.
    pub const PI: Self = Self::from_bits(13_493_037_705);
    /// π/2, to the last bit.
    pub const FRAC_PI_2: Self = Self::from_bits(6_746_518_852);
    /// 2π, to the last bit.
    pub const TAU: Self = Self::from_bits(26_986_075_409);

    /// From raw bits, units of 2⁻³², saturating: −2⁶³ becomes [`MIN`](Self::MIN).
    #[inline]
    pub const fn from_bits(bits: i64) -> Self {
        Self(I32F32::from_bits(symmetric(bits)))
    }
    /// Raw bits, units of 2⁻³².
    #[inline]
    pub const fn bits(self) -> i64 {
        self.0.to_bits()
    }
    /// From a whole number, saturating: −2³¹ becomes [`MIN`](Self::MIN).
    #[inline]
    pub const fn from_int(value: i32) -> Self {
        Self::from_bits((value as i64) << 32)
    }
    /// `numerator / denominator`, rounded once, saturating.
    #[inline]
    pub const fn ratio(numerator: i64, denominator: i64) -> Self {
        Self::narrow(div_rounded((numerator as i128) << 32, denominator as i128))
    }
    /// Raw bits formed in 128 bits, saturated to the range.
    #[inline]
    pub const fn narrow(bits: i128) -> Self {
        Self(I32F32::from_bits(within_64(bits)))
    }
    /// `self · other`, rounded once, saturating.
    #[inline]
    pub const fn times(self, other: Self) -> Self {
        Self(I32F32::from_bits(products_to_real((self.bits() as i128).wrapping_mul(other.bits() as i128))))
    }
    /// The same where the product is known to be within the range; beyond it wraps.
    #[inline]
    pub const fn times_within(self, other: Self) -> Self {
        let product = (self.bits() as i128).wrapping_mul(other.bits() as i128);
        Self(I32F32::from_bits(products_rounded(product, 32) as i64))
    }
    /// `self / other`, rounded once, saturating; 0/0 = 0.
    #[inline]
    pub const fn over(self, other: Self) -> Self {
        Self::narrow(div_rounded((self.bits() as i128) << 32, other.bits() as i128))
    }
    /// `a·b + c·d`, rounded once: the sum does not depend on the order of the two products.
    #[inline]
    pub const fn dot(a: Self, b: Self, c: Self, d: Self) -> Self {
        let p = (a.bits() as i128).wrapping_mul(b.bits() as i128);
        let q = (c.bits() as i128).wrapping_mul(d.bits() as i128);
        Self(I32F32::from_bits(products_to_real(p.wrapping_add(q))))
    }
    /// The magnitude.
    #[inline]
    pub const fn abs(self) -> Self {
        Self::from_bits(self.bits().saturating_abs())
    }
    /// The square root, rounded to nearest; 0 for a negative number.
    pub fn sqrt(self) -> Self {
        if self <= Self::ZERO {
            return Self::ZERO;
        }
        Self::narrow(super::isqrt_rounded((self.bits().unsigned_abs() as u128) << 32) as i128)
    }
    /// The nearest whole number, ties away from zero.
    #[inline]
    pub const fn round_to_int(self) -> i64 {
        super::shift_rounded_i64(self.bits(), 32)
    }
    /// The whole number at or below.
    #[inline]
    pub const fn floor(self) -> i64 {
        self.bits() >> 32
    }
    /// This magnitude with the sign of `other`.
    pub fn with_sign_of(self, other: Self) -> Self {
        if other < Self::ZERO { -self.abs() } else { self.abs() }
    }
}

impl Add for Real {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(I32F32::from_bits(sum(self.bits(), other.bits())))
    }
}
impl Sub for Real {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(I32F32::from_bits(difference(self.bits(), other.bits())))
    }
}
impl Mul for Real {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.times(other)
    }
}
impl Div for Real {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}
impl Neg for Real {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::from_bits(self.bits().wrapping_neg())
    }
}
impl AddAssign for Real {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Real {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl PartialEq<i32> for Real {
    fn eq(&self, other: &i32) -> bool {
        *self == Self::from_int(*other)
    }
}
impl PartialOrd<i32> for Real {
    fn partial_cmp(&self, other: &i32) -> Option<Ordering> {
        self.partial_cmp(&Self::from_int(*other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_symmetric() {
        let (min, max) = (Real::MIN, Real::MAX);
        for end in [
            Real::from_bits(i64::MIN),
            Real::from_int(i32::MIN),
            min + min,
            min - max,
            -max,
            max * min,
            min / Real::HALF,
        ] {
            assert_eq!((end, -end, end.abs()), (min, max, max));
        }
        assert_eq!(min + min, -(max + max));
    }
}
