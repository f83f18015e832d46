//! Lengths and angles of a program as exact whole numbers, and back to the text of a word.
//!
//! A coordinate is kept as a whole number of 10⁻¹² mm, or of 10⁻¹² degrees: every decimal that a program writes with up
//! to twelve places is exact in it, and so is every decimal of inches with up to ten (25.4 has one place of its own).
//! Increments of G91 are therefore split so that they sum up to the programmed one to the last digit, and a coordinate
//! that a line takes over unchanged is written back with the digits it had.
//!
//! Limits: 10⁶ mm and 10⁸ degrees either way ([`FARTHEST`]); digits behind the twelfth are rounded.

use truepath_core::gcode::{Decimal, Units};

/// Parts of a millimetre, or of a degree.
const PARTS: i128 = 1_000_000_000_000;
/// The farthest coordinate, mm; degrees are allowed a hundred times more.
pub const FARTHEST: f64 = 1e6;

/// A coordinate: 10⁻¹² mm or 10⁻¹² degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity(i128);

/// The unit in which a word is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Degrees.
    Degrees,
    /// G21.
    Millimetres,
    /// G20.
    Inches,
}

impl Scale {
    /// Of an axis (X 0 … C 5) under these units.
    pub const fn of_axis(axis: usize, units: Units) -> Self {
        match (axis, units) {
            (3.., _) => Self::Degrees,
            (_, Units::Millimetres) => Self::Millimetres,
            (_, Units::Inches) => Self::Inches,
        }
    }
    /// Parts in one of it.
    const fn parts(self) -> i128 {
        match self {
            Self::Degrees | Self::Millimetres => PARTS,
            Self::Inches => PARTS / 10 * 254,
        }
    }
    /// The farthest coordinate.
    const fn farthest(self) -> i128 {
        match self {
            Self::Degrees => 100_000_000 * PARTS,
            _ => 1_000_000 * PARTS,
        }
    }
}

impl Quantity {
    /// Nothing.
    pub const ZERO: Self = Self(0);

    /// A written number; `None` beyond the farthest coordinate.
    pub fn written(number: Decimal, scale: Scale) -> Option<Self> {
        let power = 10i128.checked_pow(u32::from(number.decimals()))?;
        let parts = rounded(i128::from(number.mantissa()).checked_mul(scale.parts())?, power);
        (parts.abs() <= scale.farthest()).then_some(Self(parts))
    }
    /// Millionths of a millimetre or of a degree.
    pub const fn of_millionths(count: i64) -> Self {
        Self(count as i128 * (PARTS / 1_000_000))
    }
    /// The nearest to a number of millimetres or degrees; `None` when it is not finite or beyond the farthest.
    pub fn nearest(value: f64, scale: Scale) -> Option<Self> {
        let parts = (value * PARTS as f64).round();
        (parts.is_finite() && parts.abs() <= scale.farthest() as f64).then_some(Self(parts as i128))
    }
    /// In millimetres or degrees.
    pub fn value(self) -> f64 {
        // Whole and rest apart: the sum is then right to the last bit of the result.
        (self.0 / PARTS) as f64 + (self.0 % PARTS) as f64 / PARTS as f64
    }
    /// The sum; `None` beyond the farthest coordinate.
    pub fn plus(self, other: Self, scale: Scale) -> Option<Self> {
        let sum = self.0.checked_add(other.0)?;
        (sum.abs() <= scale.farthest()).then_some(Self(sum))
    }
    /// The difference.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
    /// The nearest that has this many decimals in the unit of its word.
    #[must_use]
    pub fn with_decimals(self, decimals: u8, scale: Scale) -> Self {
        let power = 10i128.pow(u32::from(decimals.min(12)));
        let whole = rounded(self.0.saturating_mul(power), scale.parts());
        Self(rounded(whole.saturating_mul(scale.parts()), power))
    }
    /// The number of a word, with at least one decimal and as many as it needs, at most twelve.
    pub fn text(self, scale: Scale) -> String {
        let power = 10i128.pow(12);
        let whole = rounded(self.0.saturating_mul(power), scale.parts());
        let (sign, digits) = (if whole < 0 { "-" } else { "" }, whole.unsigned_abs());
        let (before, behind) = (digits / power.unsigned_abs(), digits % power.unsigned_abs());
        let behind = format!("{behind:012}");
        let kept = behind.trim_end_matches('0');
        format!("{sign}{before}.{}", if kept.is_empty() { "0" } else { kept })
    }
}

/// The quotient, to nearest, halves away from zero.
const fn rounded(numerator: i128, denominator: i128) -> i128 {
    let half = denominator / 2;
    if numerator < 0 { (numerator - half) / denominator } else { (numerator + half) / denominator }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn written(mantissa: i64, decimals: u8, scale: Scale) -> Quantity {
        Quantity::written(Decimal::new(mantissa, decimals).unwrap(), scale).unwrap()
    }

    #[test]
    fn a_ten_thousandth_of_an_inch_is_written_back_as_it_was() {
        let q = written(1, 4, Scale::Inches);
        assert_eq!((q.value(), q.text(Scale::Inches)), (0.00254, "0.0001".to_owned()));
    }

    #[test]
    fn a_coordinate_beyond_a_kilometre_is_none() {
        assert!(Quantity::written(Decimal::new(1_000_001, 0).unwrap(), Scale::Millimetres).is_none());
        assert!(Quantity::nearest(f64::NAN, Scale::Degrees).is_none());
    }

    proptest! {
        #[test]
        fn what_is_written_reads_back(mantissa in -99_999_999i64..99_999_999, decimals in 4u8..10, inches: bool) {
            let scale = if inches { Scale::Inches } else { Scale::Millimetres };
            let q = written(mantissa, decimals, scale);
            let text = q.text(scale);
            let (before, behind) = text.split_once('.').unwrap();
            let digits: i64 = format!("{before}{behind}").parse().unwrap();
            prop_assert_eq!(written(digits, behind.len() as u8, scale), q);
            prop_assert_eq!(q.with_decimals(decimals, scale), q);
        }
    }
}
