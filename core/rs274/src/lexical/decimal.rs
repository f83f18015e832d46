//! Numbers as a program or a measurement file writes them: exact decimals, never floating point.
//!
//! `X0.0001` in inches is 2540 nm to the last digit because the written digits are kept and converted once. Numbers
//! have an optional sign, digits and at most one point, no exponent; blanks may stand anywhere between the digits
//! (RS274/NGC §3.3.2.1). Digits beyond the 18th significant one are dropped: less than 10⁻⁸ nm on any length a
//! machine can travel.

use truepath_units::{Real, div_rounded};

/// A decimal number, `mantissa / 10^decimals`, as it stands in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Decimal {
    mantissa: i64,
    decimals: u8,
}

/// Significant digits kept; the mantissa then fits 64 bits.
const DIGITS: u8 = 18;

/// Powers of ten, all exact.
const POWERS: [f64; 19] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18];

impl Decimal {
    /// 0.
    pub const ZERO: Self = Self { mantissa: 0, decimals: 0 };

    /// From digits and the number of them behind the point, at most 18.
    ///
    /// `None` when `decimals` is larger or the mantissa has more than 18 digits.
    pub const fn new(mantissa: i64, decimals: u8) -> Option<Self> {
        const LIMIT: u64 = 1_000_000_000_000_000_000;
        if decimals > DIGITS || mantissa.unsigned_abs() >= LIMIT { None } else { Some(Self { mantissa, decimals }) }
    }
    /// Reads sign, digits and one point from the start of a text; what follows is the rest. Blanks count for nothing.
    ///
    /// # Errors
    /// [`NumberError`].
    pub fn read(
        input: &[u8],
        is_point: impl Fn(u8) -> bool,
        is_blank: impl Fn(u8) -> bool,
    ) -> (&[u8], Result<Self, NumberError>) {
        if let Some((value, end)) = Self::read_plain(input, &is_point) {
            let rest = input.get(end..).unwrap_or(&[]);
            // Behind a blank the number may go on.
            let next = rest.iter().find(|&&byte| !is_blank(byte));
            if !next.is_some_and(|&byte| byte.is_ascii_digit() || is_point(byte)) {
                return (rest, Ok(value));
            }
        }
        let (mut mantissa, mut significant, mut decimals) = (0i64, 0u8, 0u8);
        let (mut negative, mut signed, mut point, mut any, mut too_large) = (false, false, false, false, false);
        let mut end = 0usize;
        for (index, &byte) in input.iter().enumerate() {
            let digit = byte.wrapping_sub(b'0');
            if digit < 10 {
                any = true;
                if significant < DIGITS && decimals < DIGITS {
                    mantissa = mantissa.wrapping_mul(10).wrapping_add(i64::from(digit));
                    significant = significant.wrapping_add(u8::from(mantissa != 0));
                    decimals = decimals.wrapping_add(u8::from(point));
                } else {
                    too_large |= !point;
                }
            } else if is_point(byte) && !point {
                point = true;
            } else if is_blank(byte) {
                continue;
            } else if matches!(byte, b'+' | b'-') && !signed && !point && !any {
                signed = true;
                negative = byte == b'-';
            } else {
                break;
            }
            end = index.saturating_add(1);
        }
        let value = match (any, too_large) {
            (false, _) => Err(NumberError::Missing),
            (true, true) => Err(NumberError::TooLarge),
            (true, false) => Ok(Self { mantissa: if negative { mantissa.wrapping_neg() } else { mantissa }, decimals }),
        };
        (input.get(end..).unwrap_or(&[]), value)
    }
    /// The same of a number as programs nearly always write it, to its first blank: at most 18 digits, only a minus before them.
    /// With the number of bytes read; `None` where the long way decides.
    #[inline]
    fn read_plain(input: &[u8], is_point: impl Fn(u8) -> bool) -> Option<(Self, usize)> {
        let (negative, from) = match input.split_first() {
            Some((b'-', behind)) => (true, behind),
            _ => (false, input),
        };
        let (mut mantissa, mut rest) = digits(0, from);
        let mut written = from.len().wrapping_sub(rest.len());
        let mut decimals = 0;
        if let Some((&byte, behind)) = rest.split_first()
            && is_point(byte)
        {
            (mantissa, rest) = digits(mantissa, behind);
            decimals = behind.len().wrapping_sub(rest.len());
            written = written.wrapping_add(decimals);
        }
        if written == 0 || written > usize::from(DIGITS) {
            return None;
        }
        let mantissa = if negative { mantissa.wrapping_neg() } else { mantissa };
        Some((Self { mantissa, decimals: decimals as u8 }, input.len().wrapping_sub(rest.len())))
    }
    /// The written digits as a whole number, with the sign.
    pub const fn mantissa(self) -> i64 {
        self.mantissa
    }
    /// How many of the digits stand behind the point, 0…18.
    pub const fn decimals(self) -> u8 {
        self.decimals
    }
    /// Whether it is below zero; −0 is not.
    pub const fn is_negative(self) -> bool {
        self.mantissa < 0
    }
    /// This number with the other sign.
    #[must_use]
    pub const fn negated(self) -> Self {
        Self { mantissa: self.mantissa.wrapping_neg(), ..self }
    }
    /// This number times a whole one, rounded once to a whole number.
    pub const fn times(self, factor: i64) -> i128 {
        // Nearly always the power of ten divides the factor: no division of 128 bits then.
        if let Some(whole) = self.whole_factor(factor) {
            return (self.mantissa as i128).wrapping_mul(whole as i128);
        }
        div_rounded((self.mantissa as i128).saturating_mul(factor as i128), self.power())
    }
    /// The same, where 64 bits hold it.
    #[inline]
    pub(in super::super) fn in_64(self, factor: i64) -> Option<i64> {
        match self.whole_factor(factor).and_then(|whole| self.mantissa.checked_mul(whole)) {
            Some(product) => Some(product),
            None => self.rounded_in_64(factor),
        }
    }
    #[cold]
    fn rounded_in_64(self, factor: i64) -> Option<i64> {
        i64::try_from(self.times(factor)).ok()
    }
    /// This number times a whole one, when that is a whole number.
    pub const fn exactly_times(self, factor: i64) -> Option<i64> {
        if self.decimals == 0
            && let Some(whole) = self.mantissa.checked_mul(factor)
            && whole != i64::MIN
        {
            return Some(whole);
        }
        let product = (self.mantissa as i128).saturating_mul(factor as i128);
        match (product.checked_rem(self.power()), product.checked_div(self.power())) {
            (Some(0), Some(whole)) if whole.unsigned_abs() <= i64::MAX as u128 => Some(whole as i64),
            _ => None,
        }
    }
    /// This number as a [`Real`], rounded once, saturating at ±2.1 × 10⁹.
    pub const fn real(self) -> Real {
        Real::narrow(div_rounded((self.mantissa as i128) << Real::FRACTION_BITS, self.power()))
    }
    /// This number times `numerator / denominator` as a [`Real`], rounded once, saturating at ±2.1 × 10⁹.
    pub const fn real_ratio(self, numerator: i16, denominator: i16) -> Real {
        let top = ((self.mantissa as i128) << Real::FRACTION_BITS).saturating_mul(numerator as i128);
        Real::narrow(div_rounded(top, self.power().saturating_mul(denominator as i128)))
    }
    /// The nearest 64-bit floating point number: both the digits and the power of ten are exact up to 2⁵³ and 10²².
    #[expect(clippy::float_arithmetic, reason = "what expressions compute with")]
    pub fn value(self) -> f64 {
        self.mantissa as f64 / POWERS.get(usize::from(self.decimals)).copied().unwrap_or(1e18)
    }
    /// `factor / 10^decimals` when that is whole.
    const fn whole_factor(self, factor: i64) -> Option<i64> {
        // Millimetres and degrees.
        if factor == 1_000_000 {
            return match self.decimals {
                0 => Some(1_000_000),
                1 => Some(100_000),
                2 => Some(10_000),
                3 => Some(1_000),
                4 => Some(100),
                5 => Some(10),
                6 => Some(1),
                _ => None,
            };
        }
        let mut whole = factor;
        let mut left = self.decimals;
        while left > 0 {
            if whole % 10 != 0 {
                return None;
            }
            whole /= 10;
            left = left.saturating_sub(1);
        }
        Some(whole)
    }
    const fn power(self) -> i128 {
        10i128.saturating_pow(self.decimals as u32)
    }
}

/// The digits at the start of a text behind those of `mantissa`, and what follows them.
#[inline]
fn digits(mut mantissa: i64, mut text: &[u8]) -> (i64, &[u8]) {
    while let Some((&byte, behind)) = text.split_first() {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        mantissa = mantissa.wrapping_mul(10).wrapping_add(i64::from(digit));
        text = behind;
    }
    (mantissa, text)
}

/// Why a text is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberError {
    /// No digit.
    Missing,
    /// More than 18 digits before the point.
    TooLarge,
}

/// A blank between the parts of a block: space, tab, and what punched-tape and DOS files carry (NUL, VT, FF, CR, ^Z).
pub(in super::super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0 | 0x0B | 0x0C | 0x1A)
}

/// The bytes behind the blanks in front.
pub(in super::super) fn trimmed(text: &[u8]) -> &[u8] {
    let blanks = text.iter().take_while(|&&b| is_blank(b)).count();
    text.get(blanks..).unwrap_or(&[])
}

/// A number, with the blanks before and inside it; what follows it is the rest.
pub(in super::super) fn number(input: &[u8]) -> (&[u8], Result<Decimal, NumberError>) {
    Decimal::read(input, |byte| byte == b'.', is_blank)
}

/// A number with nothing unusual in it at a place of a text, and the place behind it, where a blank, a digit or a point must not
/// follow for it to be all of the number; `None` where [`number`] decides.
#[inline]
pub(in super::super) fn plain_number(text: &[u8], at: usize) -> Option<(Decimal, usize)> {
    let negative = text.get(at) == Some(&b'-');
    let first = at.saturating_add(usize::from(negative));
    if let Some((digits, len)) = few_digits(eight_bytes(text, first)?) {
        let end = first.saturating_add(len);
        if len < 8 || !text.get(end).is_some_and(u8::is_ascii_digit) {
            return Some((if negative { digits.negated() } else { digits }, end));
        }
    }
    let (value, len) = Decimal::read_plain(text.get(at..)?, |byte| byte == b'.')?;
    Some((value, at.saturating_add(len)))
}

/// The eight bytes at a place, the first of them lowest, with zeros for those behind the end of the text.
#[inline]
fn eight_bytes(text: &[u8], at: usize) -> Option<u64> {
    let rest = text.get(at..)?;
    if let Some(bytes) = rest.first_chunk() {
        return Some(u64::from_le_bytes(*bytes));
    }
    let missing = 8usize.saturating_sub(rest.len()) as u32;
    match text.last_chunk() {
        Some(bytes) => Some(u64::from_le_bytes(*bytes).unbounded_shr(missing.saturating_mul(8))),
        None => Some(rest.iter().rev().fold(0, |bytes, &byte| (bytes << 8) | u64::from(byte))),
    }
}

/// The number that eight bytes begin with, all digits computed at once, and its length; `None` without a digit, and for eight.
#[inline]
const fn few_digits(bytes: u64) -> Option<(Decimal, usize)> {
    const EACH: u64 = 0x0101_0101_0101_0101;
    // Digits are now 0…9; the highest bit of all other bytes is set in `others`.
    let bytes = bytes ^ (EACH * 0x30);
    let others = (((bytes & (EACH * 0x7F)).wrapping_add(EACH * 0x76)) | bytes) & (EACH * 0x80);
    // Bits of the digits before the point.
    let whole = others.trailing_zeros() & 0x78;
    if whole == 64 {
        return None;
    }
    let (mut eight, mut count, mut len) = (bytes, whole, whole);
    if (bytes >> whole) as u8 == b'.' ^ b'0' {
        // Those behind it move up to them.
        let before = (1u64 << whole).wrapping_sub(1);
        eight = (bytes & before) | ((bytes >> 8) & !before);
        len = (others & others.wrapping_sub(1)).trailing_zeros() & 0x78;
        count = len.wrapping_sub(8);
    }
    if count == 0 {
        return None;
    }
    // With zeros in front there are eight. Pairs, fours, all.
    let eight = eight << (64u32.wrapping_sub(count) & 0x38);
    let pairs = eight.wrapping_mul(10).wrapping_add(eight >> 8) & 0x00FF_00FF_00FF_00FF;
    let fours = pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0x0000_FFFF_0000_FFFF;
    let mantissa = (fours & 0xFFFF).wrapping_mul(10_000).wrapping_add(fours >> 32) as i64;
    let decimals = (count.wrapping_sub(whole) / 8) as u8;
    Some((Decimal { mantissa, decimals }, (len / 8) as usize))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::float_arithmetic)]
    use super::*;
    use proptest::prelude::*;
    use std::format;

    fn read(text: &str) -> (Result<Decimal, NumberError>, usize) {
        let (rest, value) = number(text.as_bytes());
        (value, rest.len())
    }

    #[test]
    fn digits_are_kept_as_written_and_blanks_do_not_matter() {
        assert_eq!(read("-12.50X"), (Ok(Decimal { mantissa: -1250, decimals: 2 }), 1));
        assert_eq!(read(" + 1 2 . 5 X"), (Ok(Decimal { mantissa: 125, decimals: 1 }), 2));
        assert_eq!(read(".5"), (Ok(Decimal { mantissa: 5, decimals: 1 }), 0));
        assert_eq!(read("7."), (Ok(Decimal { mantissa: 7, decimals: 0 }), 0));
    }

    #[test]
    fn a_second_point_is_left_for_the_caller() {
        assert_eq!(read("1.2.3"), (Ok(Decimal { mantissa: 12, decimals: 1 }), 2));
    }

    #[test]
    fn no_digit_or_too_many_digits_is_no_number() {
        assert_eq!(read("-.").0, Err(NumberError::Missing));
        assert_eq!(read("").0, Err(NumberError::Missing));
        assert_eq!(read("1234567890123456789").0, Err(NumberError::TooLarge));
        assert_eq!(read("0000000000000000000000012").0, Ok(Decimal { mantissa: 12, decimals: 0 }));
    }

    #[test]
    fn a_ten_thousandth_of_an_inch_is_2540_nanometres() {
        assert_eq!(read("0.0001").0.unwrap().times(25_400_000), 2540);
        assert_eq!(read("0.00000005").0.unwrap().times(25_400_000), 1);
        assert_eq!(read("-0.0000005").0.unwrap().times(1_000_000), -1);
    }

    #[test]
    fn a_whole_number_may_be_written_with_zero_decimals_only() {
        assert_eq!(read("59.10").0.unwrap().exactly_times(10), Some(591));
        assert_eq!(read("59.15").0.unwrap().exactly_times(10), None);
    }

    proptest! {
        #[test]
        fn the_short_way_reads_what_the_long_way_reads(text in "[-+]?[0-9. X]{0,24}") {
            // A blank in front is what the short way leaves to the long one.
            let (long, left) = read(&format!(" {text}"));
            let (short, rest) = read(&text);
            prop_assert_eq!(&short, &long);
            prop_assert!(short.is_err() || rest == left);
        }

        #[test]
        fn eight_digits_at_once_are_read_as_one_by_one(text in "[-+]?[0-9]{0,9}[.]?[0-9]{0,9}[-0-9. X]{0,9}", more in "[0-9. X\u{80}]{0,9}", at in 0usize..3) {
            let text = format!("{}{text}{more}", "G1X".get(..at).unwrap());
            let one_by_one = Decimal::read_plain(text.as_bytes().get(at..).unwrap(), |byte| byte == b'.');
            prop_assert_eq!(plain_number(text.as_bytes(), at), one_by_one.map(|(value, len)| (value, at + len)));
        }

        #[test]
        fn every_written_number_reads_back_as_its_digits(whole in 0u32.., part in 0u32..1_000_000, minus: bool) {
            let text = format!("{}{whole}.{part:06}", if minus { "-" } else { "" });
            let value = read(&text).0.unwrap();
            let expected = i128::from(whole) * 1_000_000 + i128::from(part);
            prop_assert_eq!(value.times(1_000_000), if minus { -expected } else { expected });
            let real = value.real().bits() as f64 / 4_294_967_296.0;
            let float: f64 = text.parse().unwrap();
            prop_assert!(float.abs() > 2.1e9 || (real - float).abs() < 1e-6);
        }
    }
}
