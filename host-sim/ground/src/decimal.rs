//! Decimal numbers taken from their text, without a detour through binary floating point.
//!
//! `0.1` mm is then exactly 100,000 nm on every host. Range ±10⁹, resolution 10⁻¹⁸; digits beyond that are rounded
//! once, to nearest.

use truepath_core::units::{Offset, Real, div_rounded};

/// A decimal number in units of 10⁻¹⁸.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Decimal(i128);

const SCALE: i32 = 18;
/// 10⁹, the end of the range.
const LIMIT: i128 = 10i128.pow(9 + SCALE as u32);

impl Decimal {
    /// From the text of a TOML number: sign, digits with `_`, point, exponent. `None` for anything else (hexadecimal,
    /// `nan`, `inf`) and for more than 36 digits. Values beyond the range are held at its end.
    pub fn parse(text: &str) -> Option<Self> {
        let (negative, digits) = match text.as_bytes().first()? {
            b'-' => (true, &text[1..]),
            b'+' => (false, &text[1..]),
            _ => (false, text),
        };
        let (digits, exponent) = match digits.split_once(['e', 'E']) {
            Some((digits, exponent)) => (digits, exponent.replace('_', "").parse::<i32>().ok()?),
            None => (digits, 0),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let mut value = 0i128;
        let mut count = 0;
        for c in whole.chars().chain(fraction.chars()).filter(|&c| c != '_') {
            value = value * 10 + i128::from(c.to_digit(10)?);
            count += 1;
            if count > 36 {
                return None;
            }
        }
        if count == 0 {
            return None;
        }
        let decimals = fraction.chars().filter(char::is_ascii_digit).count() as i32;
        let shift = SCALE.saturating_sub(decimals).saturating_add(exponent);
        let scaled = match 10i128.checked_pow(shift.unsigned_abs()) {
            Some(power) if shift >= 0 => value.saturating_mul(power),
            Some(power) => div_rounded(value, power),
            None if shift > 0 && value != 0 => LIMIT,
            None => 0,
        };
        let magnitude = scaled.min(LIMIT);
        Some(Self(if negative { -magnitude } else { magnitude }))
    }

    /// A length in mm from its text, with or without a unit: `0.02`, `0.02mm`, `20um`, `0.0008in`, `0.0008"`. `None` for anything else.
    pub fn length(text: &str) -> Option<Self> {
        let inches = |n: Self| n.of_inches();
        let micrometres = |n: Self| Self(div_rounded(n.0, 1000));
        let units: [(&str, &dyn Fn(Self) -> Self); 6] = [
            ("mm", &|n| n),
            ("um", &micrometres),
            ("µm", &micrometres),
            ("inch", &inches),
            ("in", &inches),
            ("\"", &inches),
        ];
        let said = units.iter().find_map(|(unit, mm)| Some((text.strip_suffix(unit)?, mm)));
        match said {
            Some((number, mm)) => Self::parse(number.trim_end()).map(mm),
            None => Self::parse(text),
        }
    }

    /// Of a length in inches that in millimetres, exactly as far as the resolution goes; beyond the range it is held at its end.
    pub fn of_inches(self) -> Self {
        Self(div_rounded(self.0.saturating_mul(254), 10).clamp(-LIMIT, LIMIT))
    }
    /// As millimetres: whole nanometres, rounded to nearest.
    pub fn as_mm(self) -> Offset {
        Offset::from_nm(div_rounded(self.0, 10i128.pow(12)) as i64)
    }
    /// In billionths (nanoseconds of a time in seconds), rounded to nearest.
    pub fn as_billionths(self) -> i64 {
        div_rounded(self.0, 10i128.pow(9)) as i64
    }
    /// As a number of the model, rounded to nearest.
    pub fn as_real(self) -> Real {
        Real::narrow(div_rounded(self.0 << Real::FRACTION_BITS, 10i128.pow(18)))
    }
    /// As a binary number, for models in `f64`.
    pub fn as_f64(self) -> f64 {
        self.0 as f64 / 1e18
    }
    /// As a whole number; `None` when it is not one.
    pub fn as_whole(self) -> Option<i64> {
        let one = 10i128.pow(18);
        (self.0 % one == 0).then(|| (self.0 / one) as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nm(text: &str) -> i64 {
        Decimal::parse(text).expect(text).as_mm().nm()
    }

    #[test]
    fn lengths_are_exact_nanometres() {
        for (text, expected) in [
            ("0.1", 100_000),
            ("-0.3", -300_000),
            ("+20", 20_000_000),
            ("1_000.000_001", 1_000_000_001),
            ("12.7e-1", 1_270_000),
            ("2E1", 20_000_000),
            ("0.0000005", 1),
            ("-0.0000005", -1),
            ("0.00000049999", 0),
        ] {
            assert_eq!(nm(text), expected, "{text}");
        }
    }

    #[test]
    fn inches_are_exact_and_stay_in_range() {
        let mm = |text| Decimal::parse(text).expect(text).of_inches();
        assert_eq!(mm("0.5"), Decimal::parse("12.7").expect("a number"));
        assert_eq!(mm("-0.000_01").as_mm().nm(), -254);
        assert_eq!(mm("1e9"), Decimal::parse("1e9").expect("a number"));
    }

    #[test]
    fn a_length_may_have_its_unit_behind_it() {
        let nm = |text| Decimal::length(text).map(|length| length.as_mm().nm());
        for (text, expected) in [
            ("0.02", 20_000),
            ("0.02mm", 20_000),
            ("0.02 mm", 20_000),
            ("20um", 20_000),
            ("12.5 µm", 12_500),
            ("0.0005in", 12_700),
            ("-0.001 inch", -25_400),
            ("0.5\"", 12_700_000),
        ] {
            assert_eq!(nm(text), Some(expected), "{text}");
        }
        for text in ["", "in", "mm", "0.5 ft", "5m", "0,5in", "0.5in mm"] {
            assert_eq!(nm(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_are_rounded_once() {
        let third = Decimal::parse("0.333333333333333333333333").expect("a number").as_real();
        assert_eq!(third.bits(), 1_431_655_765);
        assert_eq!(Decimal::parse("1147.7").expect("a number").as_real().bits(), 4_929_333_965_619);
    }

    #[test]
    fn what_is_no_decimal_is_refused() {
        for text in ["", "-", "0x10", "nan", "inf", "1e", ".", "12a", &"1".repeat(40)] {
            assert_eq!(Decimal::parse(text), None, "{text}");
        }
        assert_eq!(Decimal::parse("1e30"), Decimal::parse("1e9"));
        assert_eq!(Decimal::parse("1e-99"), Decimal::parse("0"));
    }

    #[test]
    fn whole_numbers_are_told_from_fractions() {
        assert_eq!(Decimal::parse("6.0").and_then(Decimal::as_whole), Some(6));
        assert_eq!(Decimal::parse("6.5").and_then(Decimal::as_whole), None);
    }
}
