//! Lengths in whole nanometres: places ([`Position`]) and differences of places ([`Offset`]).

use core::fmt;
use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use serde::{Deserialize, Deserializer, Serialize};

use super::root::rounded_64;
use super::round::{difference, products_to_real, sum, symmetric};
use super::{Real, div_rounded, isqrt_rounded};

/// An absolute coordinate, nanometres, ±9.2 × 10⁹ m (the machine uses ±4 m). Arithmetic saturates at ±(2⁶³ − 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Position(i64);

/// A difference of coordinates, a length or a displacement, nanometres. Arithmetic saturates at ±(2⁶³ − 1): negation is
/// exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Offset(i64);

impl Position {
    /// The origin of the coordinate.
    pub const ZERO: Self = Self(0);

    /// From whole nanometres, saturating: −2⁶³ becomes −(2⁶³ − 1).
    #[inline]
    pub const fn from_nm(nm: i64) -> Self {
        Self(symmetric(nm))
    }
    /// Whole nanometres.
    #[inline]
    pub const fn nm(self) -> i64 {
        self.0
    }
}

impl Offset {
    /// No length.
    pub const ZERO: Self = Self(0);
    /// The longest length.
    pub const MAX: Self = Self(i64::MAX);

    /// From whole nanometres, saturating: −2⁶³ becomes −(2⁶³ − 1).
    #[inline]
    pub const fn from_nm(nm: i64) -> Self {
        Self(symmetric(nm))
    }
    /// From whole micrometres, saturating.
    #[inline]
    pub const fn from_um(um: i64) -> Self {
        Self::from_nm(um.saturating_mul(1_000))
    }
    /// Whole nanometres.
    #[inline]
    pub const fn nm(self) -> i64 {
        self.0
    }
    /// From millimetres, rounded to the nanometre.
    #[inline]
    pub const fn from_mm(mm: Real) -> Self {
        Self(products_to_real((mm.bits() as i128).wrapping_mul(1_000_000)))
    }
    /// Millimetres, rounded to 2⁻³² mm; saturates beyond ±2147 km.
    #[inline]
    pub const fn mm(self) -> Real {
        Real::ratio(self.0, 1_000_000)
    }
    /// The length without its sign.
    #[inline]
    pub const fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }
    /// This length times a number, rounded to the nanometre, saturating.
    #[inline]
    pub const fn scaled(self, factor: Real) -> Self {
        Self(products_to_real((self.0 as i128).wrapping_mul(factor.bits() as i128)))
    }
    /// This length over another, as a number; saturates, 0/0 is 0.
    #[inline]
    pub const fn over(self, other: Self) -> Real {
        Real::ratio(self.0, other.0)
    }
    /// The sum of two products `self·a + other·b`, rounded once.
    #[inline]
    pub const fn blend(self, a: Real, other: Self, b: Real) -> Self {
        let p = (self.0 as i128).wrapping_mul(a.bits() as i128);
        let q = (other.0 as i128).wrapping_mul(b.bits() as i128);
        Self(products_to_real(p.wrapping_add(q)))
    }
}

/// The length of (x, y), rounded to the nanometre, saturating.
#[inline]
pub const fn hypot_nm(x: Offset, y: Offset) -> Offset {
    let (a, b) = (x.nm().unsigned_abs(), y.nm().unsigned_abs());
    if (a | b) >> 31 == 0 {
        return Offset::from_nm(rounded_64(a.wrapping_mul(a).wrapping_add(b.wrapping_mul(b))) as i64);
    }
    let (a, b) = (a as u128, b as u128);
    let root = isqrt_rounded(a.saturating_mul(a).saturating_add(b.saturating_mul(b)));
    if root > i64::MAX as u128 { Offset::MAX } else { Offset::from_nm(root as i64) }
}

/// A length in millimetres as text: `{}` with as many decimals as it needs, at most six; `{:.3}` rounded to three.
#[derive(Clone, Copy, Debug)]
pub struct Millimetres(pub Offset);

impl fmt::Display for Millimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let power = |decimals: usize| 10i128.saturating_pow(u32::try_from(decimals).unwrap_or(0));
        let nm = self.0.nm();
        let mut decimals = f.precision().unwrap_or(6).min(6);
        let mut digits = div_rounded(i128::from(nm.unsigned_abs()), power(6usize.saturating_sub(decimals)));
        while f.precision().is_none() && decimals > 0 && digits % 10 == 0 {
            (digits, decimals) = (digits / 10, decimals.saturating_sub(1));
        }
        let sign = if nm < 0 { "-" } else { "" };
        let (whole, part) = (digits.checked_div(power(decimals)), digits.checked_rem(power(decimals)));
        write!(f, "{sign}{}", whole.unwrap_or(0))?;
        if decimals == 0 { Ok(()) } else { write!(f, ".{:0decimals$}", part.unwrap_or(0)) }
    }
}

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(bytes: D) -> Result<Self, D::Error> {
        i64::deserialize(bytes).map(Self::from_nm)
    }
}
impl<'de> Deserialize<'de> for Offset {
    fn deserialize<D: Deserializer<'de>>(bytes: D) -> Result<Self, D::Error> {
        i64::deserialize(bytes).map(Self::from_nm)
    }
}

impl Sub for Position {
    type Output = Offset;
    #[inline]
    fn sub(self, other: Self) -> Offset {
        Offset(difference(self.0, other.0))
    }
}
impl Add<Offset> for Position {
    type Output = Self;
    #[inline]
    fn add(self, by: Offset) -> Self {
        Self(sum(self.0, by.0))
    }
}
impl Sub<Offset> for Position {
    type Output = Self;
    #[inline]
    fn sub(self, by: Offset) -> Self {
        Self(difference(self.0, by.0))
    }
}
impl Add for Offset {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(sum(self.0, other.0))
    }
}
impl Sub for Offset {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(difference(self.0, other.0))
    }
}
impl Neg for Offset {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::from_nm(self.0.wrapping_neg())
    }
}
impl AddAssign for Offset {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Offset {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_symmetric() {
        let (min, max) = (-Offset::MAX, Offset::MAX);
        let far = Position::from_nm(i64::MIN);
        let ends = [min + min, min - max, Offset::from_nm(i64::MIN), Offset::from_um(i64::MIN), far - Position::ZERO];
        for end in
            ends.into_iter().chain([(far + min) - Position::ZERO, (far - max) - Position::ZERO, max.scaled(Real::MIN)])
        {
            assert_eq!((end, -end, end.abs()), (min, max, max));
        }
        assert_eq!(min + min, -(max + max));
    }

    #[test]
    fn a_length_in_millimetres_has_the_decimals_it_needs_or_those_asked_for() {
        use std::format;
        let shown =
            |nm| (format!("{}", Millimetres(Offset::from_nm(nm))), format!("{:.3}", Millimetres(Offset::from_nm(nm))));
        for (nm, short, fixed) in [
            (0, "0", "0.000"),
            (-4_900_000, "-4.9", "-4.900"),
            (1, "0.000001", "0.000"),
            (12_345_600, "12.3456", "12.346"),
            (9_999_500, "9.9995", "10.000"),
        ] {
            assert_eq!(shown(nm), (short.into(), fixed.into()));
        }
    }
}
