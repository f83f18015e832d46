//! The number of a word: as written, or as computed from an expression.
//!
//! A plain number keeps its digits, so `0.0001` in inches is 2540 nm to the last bit. Only what stands in brackets or
//! parameters passes through floating point, and it is rounded once when it leaves: to the nearest, halves away from
//! zero, so that a mirrored program gives mirrored numbers.

use super::super::Units;
use super::Decimal;
use truepath_units::Real;

/// The number of a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Digits that stand in the program.
    Exact(Decimal),
    /// The value of an expression or a parameter.
    Computed(f64),
}

/// How far a computed number may be from a whole one to count as such; LinuxCNC's value.
const WHOLE: f64 = 1e-4;

impl Number {
    /// Its length in whole nanometres; `None` beyond ±9.2 × 10⁹ mm and for what is no number.
    #[inline]
    #[expect(clippy::float_arithmetic, reason = "a computed number leaves floating point here, rounded once")]
    pub fn nanometres(self, units: Units) -> Option<i64> {
        match self {
            Self::Exact(decimal) => decimal.in_64(units.nanometres()),
            Self::Computed(value) => whole(value * units.nanometres() as f64),
        }
    }
    /// As a [`Real`], rounded once, saturating at ±2.1 × 10⁹.
    pub fn real(self) -> Real {
        self.real_ratio(1, 1)
    }
    /// This number times `numerator / denominator` as a [`Real`], rounded once, saturating at ±2.1 × 10⁹.
    #[expect(clippy::float_arithmetic, reason = "a computed number leaves floating point here, rounded once")]
    pub fn real_ratio(self, numerator: i16, denominator: i16) -> Real {
        match self {
            Self::Exact(decimal) => decimal.real_ratio(numerator, denominator),
            Self::Computed(value) => {
                let scaled = value * f64::from(numerator) / f64::from(denominator) * 4_294_967_296.0;
                // The conversion saturates.
                Real::from_bits(libm::round(scaled) as i64)
            }
        }
    }
    /// This number times a whole one, when that is a whole number; a computed one may miss it by `factor` · 0.0001.
    #[expect(clippy::float_arithmetic, reason = "a computed number leaves floating point here, rounded once")]
    pub fn exactly_times(self, factor: i64) -> Option<i64> {
        match self {
            Self::Exact(decimal) => decimal.exactly_times(factor),
            Self::Computed(value) => {
                let product = value * factor as f64;
                let near = libm::fabs(product - libm::round(product)) <= WHOLE * libm::fabs(factor as f64);
                if near { whole(product) } else { None }
            }
        }
    }
    /// Whether it is below zero; −0 is not.
    pub fn is_negative(self) -> bool {
        match self {
            Self::Exact(decimal) => decimal.is_negative(),
            Self::Computed(value) => value < 0.0,
        }
    }
    /// Zero.
    pub const ZERO: Self = Self::Computed(0.0);

    /// A length in nanometres as a parameter holds it.
    #[expect(clippy::float_arithmetic, reason = "a parameter takes its value here, rounded once")]
    pub fn of_nanometres(length: i64, units: Units) -> f64 {
        length as f64 / units.nanometres() as f64
    }
    /// A [`Real`] over `numerator / denominator` as a parameter holds it.
    #[expect(clippy::float_arithmetic, reason = "a parameter takes its value here")]
    pub fn of_real(value: Real, numerator: i16, denominator: i16) -> f64 {
        value.bits() as f64 / 4_294_967_296.0 * f64::from(denominator) / f64::from(numerator)
    }
    /// As the expressions see it.
    pub fn value(self) -> f64 {
        match self {
            Self::Exact(decimal) => decimal.value(),
            Self::Computed(value) => value,
        }
    }
}

/// To the nearest whole number, halves away from zero; `None` where 64 bits do not hold it.
fn whole(value: f64) -> Option<i64> {
    let rounded = libm::round(value);
    // −2⁶³ … 2⁶³ are numbers of this type; the comparison is false for what is no number.
    if rounded > -9.2e18 && rounded < 9.2e18 { Some(rounded as i64) } else { None }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_written_number_keeps_its_digits_and_a_computed_one_is_rounded_once() {
        let written = Number::Exact(Decimal::new(1, 4).unwrap());
        assert_eq!(written.nanometres(Units::Inches), Some(2540));
        assert_eq!(Number::Computed(0.000_000_5).nanometres(Units::Millimetres), Some(1));
        assert_eq!(Number::Computed(-0.000_000_5).nanometres(Units::Millimetres), Some(-1));
    }

    #[test]
    fn what_is_no_length_is_none() {
        for value in [f64::NAN, f64::INFINITY, -1e300] {
            assert_eq!(Number::Computed(value).nanometres(Units::Millimetres), None);
        }
    }

    #[test]
    fn a_computed_number_is_whole_within_a_ten_thousandth() {
        assert_eq!(Number::Computed(2.999_99).exactly_times(1), Some(3));
        assert_eq!(Number::Computed(38.2).exactly_times(10), Some(382));
        assert_eq!(Number::Computed(2.999).exactly_times(1), None);
    }

    #[test]
    fn a_written_number_has_the_value_of_its_digits_to_the_last_bit() {
        for (mantissa, decimals, value) in [(1, 1, 0.1), (254, 1, 25.4), (-1_234_567, 4, -123.4567), (3, 0, 3.0)] {
            assert_eq!(Number::Exact(Decimal::new(mantissa, decimals).unwrap()).value(), value);
        }
    }
}
