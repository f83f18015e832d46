//! Numbers with four decimals, as C's `%.4f` writes the double next to them.
//!
//! A length is a whole number of nanometres, so its digits are found with whole numbers alone; only an exact half of
//! the last digit is left to the double, whose error decides there. A zero carries no minus sign.

use std::io::Write;

/// What stands between values.
const SEPARATOR: &[u8; 2] = b", ";

/// The first number of more than eight digits.
const NINE_DIGITS: u64 = 100_000_000;

/// A text of at most sixteen bytes, the first of them lowest.
#[derive(Clone, Copy)]
pub(super) struct Short {
    bytes: u128,
    length: usize,
}

impl Short {
    #[inline]
    pub(super) fn push(self, out: &mut Vec<u8>) {
        let end = out.len() + self.length;
        out.extend_from_slice(&self.bytes.to_le_bytes());
        out.truncate(end);
    }
}

/// Appends `value / unit` with four decimals; `unit` is positive: 1 000 000 for millimetres and degrees, 25 400 000
/// for inches.
pub(super) fn push_ratio(out: &mut Vec<u8>, value: i64, unit: i64) {
    push_separated(out, value, unit);
    out.truncate(out.len() - SEPARATOR.len());
}

/// The same with a comma and a blank behind it.
pub(super) fn push_separated(out: &mut Vec<u8>, value: i64, unit: i64) {
    match short_ratio(value, unit) {
        Some(text) => text.push(out),
        None => push_long_ratio(out, value, unit),
    }
}

/// The same as a short text; `None` for nine digits and more, and where rounding is that of the double.
#[inline]
pub(super) fn short_ratio(value: i64, unit: i64) -> Option<Short> {
    let digits = ten_thousandths(value, unit).filter(|&digits| digits < NINE_DIGITS)?;
    Some(few_digits(value < 0 && digits != 0, digits))
}

/// The magnitude in ten-thousandths of the unit; `None` halfway between two.
#[inline]
fn ten_thousandths(value: i64, unit: i64) -> Option<u64> {
    // Division by a constant is a product.
    let (digits, twice_rest, divisor) = match unit {
        1_000_000 => divided::<100>(value),
        25_400_000 => divided::<2_540>(value),
        _ => return None,
    };
    if twice_rest == divisor { None } else { Some(digits + u64::from(twice_rest > divisor)) }
}

#[inline]
fn divided<const BY: u64>(value: i64) -> (u64, u64, u64) {
    let magnitude = value.unsigned_abs();
    (magnitude / BY, magnitude % BY * 2, BY)
}

#[cold]
fn push_long_ratio(out: &mut Vec<u8>, value: i64, unit: i64) {
    match ten_thousandths(value, unit) {
        Some(digits) => push_digits(out, value < 0, digits),
        None => {
            push_real(out, value as f64 / unit as f64);
            out.extend_from_slice(SEPARATOR);
        }
    }
}

/// Appends a double with four decimals.
pub(super) fn push_real(out: &mut Vec<u8>, value: f64) {
    // Feeds and speeds are mostly whole.
    if (1.0..10_000.0).contains(&value) && value.fract() == 0.0 {
        few_digits(false, value as u64 * 10_000).push(out);
        return out.truncate(out.len() - SEPARATOR.len());
    }
    let start = out.len();
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.4}");
    if out.get(start..) == Some(b"-0.0000") {
        out.remove(start);
    }
}

/// Appends ten-thousandths as a decimal number, and the separator.
fn push_digits(out: &mut Vec<u8>, minus: bool, ten_thousandths: u64) {
    if minus {
        out.push(b'-');
    }
    let (whole, part) = (ten_thousandths / 10_000, ten_thousandths % 10_000);
    push_whole(out, whole);
    // With a one before them, so that the zeros stay.
    let mut text = itoa::Buffer::new();
    let digits = text.format(part as u32 + 10_000).as_bytes();
    out.extend_from_slice(&[b'.', digits[1], digits[2], digits[3], digits[4]]);
    out.extend_from_slice(SEPARATOR);
}

/// The same of at most eight digits: as one number of 16 bytes, from which the zeros in front are shifted out.
#[inline]
fn few_digits(minus: bool, ten_thousandths: u64) -> Short {
    let digits = eight_digits(ten_thousandths);
    // The last digit before the point stays.
    let zeros = zeros_in_front(digits).min(3);
    let (whole, part) = (digits & 0xFFFF_FFFF, digits >> 32);
    let text = u128::from(whole) | (u128::from(b'.') << 32) | (u128::from(part) << 40);
    let text = (text | (u128::from(u16::from_le_bytes(*SEPARATOR)) << 72)) >> (8 * zeros);
    let bytes = if minus { (text << 8) | u128::from(b'-') } else { text };
    Short { bytes, length: 9 + SEPARATOR.len() - zeros as usize + usize::from(minus) }
}

/// The digits of a number below 10⁸, the first in the lowest byte: two halves, four quarters, eight digits at once.
#[inline]
const fn eight_digits(number: u64) -> u64 {
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = ((fours * 10_486) >> 20) & 0x7F_0000_007F;
    let twos = hundreds | ((fours - hundreds * 100) << 16);
    let tens = ((twos * 103) >> 10) & 0x000F_000F_000F_000F;
    tens | ((twos - tens * 10) << 8) | 0x3030_3030_3030_3030
}

/// How many of eight digits are zeros in front, 7 of a zero.
#[inline]
const fn zeros_in_front(digits: u64) -> u32 {
    ((digits ^ 0x3030_3030_3030_3030) | (1 << 56)).trailing_zeros() / 8
}

/// The running number of lines, counted up in its text: in at least five places, with blanks before it and one behind it.
pub(super) struct Count {
    number: u64,
    /// `None` from nine digits on.
    text: Option<Short>,
    /// What changes the last digit by one.
    one: u128,
}

impl Count {
    /// Before the first line.
    pub(super) fn new() -> Self {
        let mut count = Self { number: 0, text: None, one: 0 };
        count.write();
        count
    }

    #[inline]
    pub(super) fn push_next(&mut self, out: &mut Vec<u8>) {
        self.number += 1;
        match &mut self.text {
            Some(text) if !self.number.is_multiple_of(10) => text.bytes += self.one,
            _ => self.write(),
        }
        match self.text {
            Some(text) => text.push(out),
            None => {
                push_whole(out, self.number);
                out.push(b' ');
            }
        }
    }

    fn write(&mut self) {
        self.text = (self.number < NINE_DIGITS).then(|| {
            let digits = eight_digits(self.number);
            let zeros = zeros_in_front(digits);
            let blanks = 0x1010_1010_1010_1010 & ((1 << (8 * zeros)) - 1);
            let text = u128::from(digits ^ blanks) | (u128::from(b' ') << 64);
            let left_out = zeros.min(3);
            self.one = 1 << (8 * (7 - left_out));
            Short { bytes: text >> (8 * left_out), length: 9 - left_out as usize }
        });
    }
}

/// Appends a whole number.
pub(super) fn push_whole(out: &mut Vec<u8>, number: u64) {
    out.extend_from_slice(itoa::Buffer::new().format(number).as_bytes());
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ratio(value: i64, unit: i64) -> String {
        let mut out = Vec::new();
        push_ratio(&mut out, value, unit);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn lengths_are_rounded_to_the_nearest_digit_and_zero_has_no_sign() {
        assert_eq!(ratio(12_345_678, 1_000_000), "12.3457");
        assert_eq!(ratio(-49, 1_000_000), "0.0000");
        assert_eq!(ratio(-51, 1_000_000), "-0.0001");
        assert_eq!(ratio(25_400_000, 25_400_000), "1.0000");
        assert_eq!(ratio(i64::MIN, 1_000_000), "-9223372036854.7758");
    }

    #[test]
    fn whole_numbers_stand_right_in_five_places() {
        for number in [0, 7, 95, 9_985, 99_999, 123_456, 99_999_985, 12_345_678_901] {
            let mut out = Vec::new();
            let mut count = Count { number, ..Count::new() };
            count.write();
            (1..=20).for_each(|_| count.push_next(&mut out));
            let expected: String = (1..=20).map(|next| format!("{:5} ", number + next)).collect();
            assert_eq!(String::from_utf8(out).unwrap(), expected);
        }
    }

    #[test]
    fn a_number_of_nine_digits_is_written_as_one_of_eight() {
        assert_eq!(ratio(9_999_999_949, 1_000_000), "9999.9999");
        assert_eq!(ratio(-9_999_999_951, 1_000_000), "-10000.0000");
        assert_eq!(ratio(-1_000_000_000, 1_000_000), "-1000.0000");
    }

    proptest! {
        #[test]
        fn eight_digits_are_those_of_the_number(number in 0u64..100_000_000) {
            let text = format!("{number:08}");
            let digits = eight_digits(number).to_le_bytes();
            prop_assert_eq!(digits.as_slice(), text.as_bytes());
            let zeros = text.bytes().take(7).take_while(|&b| b == b'0').count();
            prop_assert_eq!(zeros_in_front(eight_digits(number)) as usize, zeros);
        }

        #[test]
        fn every_length_is_written_as_the_double_next_to_it(nm in -1i64 << 50..1 << 50, inch: bool) {
            let unit = if inch { 25_400_000 } else { 1_000_000 };
            let mut expected = Vec::new();
            push_real(&mut expected, nm as f64 / unit as f64);
            prop_assert_eq!(ratio(nm, unit).into_bytes(), expected);
        }

        #[test]
        fn halves_are_left_to_the_double(half in -1i64 << 30..1 << 30) {
            let nm = half * 100 + 50;
            prop_assert_eq!(ratio(nm, 1_000_000), format!("{:.4}", nm as f64 / 1e6).replace("-0.0000", "0.0000"));
        }
    }
}
