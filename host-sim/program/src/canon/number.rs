//! Numbers with four decimals, as C's `%.4f` writes the double next to them.
//!
//! A length is a whole number of nanometres, so its digits are found with whole numbers alone; only an exact half of
//! the last digit is left to the double, whose error decides there. A zero carries no minus sign.

use std::io::Write;

/// One degree, or millimetre, in the whole numbers of the core.
pub(super) const MILLION: i64 = 1_000_000;

/// What stands between values.
const SEPARATOR: &[u8; 2] = b", ";

/// The first number of more than eight digits.
const NINE_DIGITS: u64 = 100_000_000;

/// A short text in two pieces of at most eight bytes, the first byte of each lowest. Each is put down as a whole word; what the
/// word has too much is overwritten by what follows.
#[derive(Clone, Copy)]
pub(super) struct Short {
    head: u64,
    tail: u64,
    head_length: u8,
    length: u8,
}

/// Bytes of which a short text uses no more.
pub(super) const SHORT: usize = 16;

impl Short {
    /// How often an arc turns, with its direction, and the separator.
    pub(super) fn turns(clockwise: bool, turns: u64) -> Self {
        let mut text = Vec::with_capacity(SHORT);
        if clockwise {
            text.push(b'-');
        }
        push_whole(&mut text, turns);
        text.extend_from_slice(SEPARATOR);
        let length = text.len();
        text.resize(SHORT, 0);
        let words: &[[u8; 8]] = text.as_chunks().0;
        let [head, tail] = [words[0], words[1]].map(u64::from_le_bytes);
        Self { head, tail, head_length: length.min(8) as u8, length: length as u8 }
    }

    /// Puts it down at a place, with up to [`SHORT`] bytes overwritten; gives the place behind it.
    #[inline]
    pub(super) fn put(self, out: &mut [u8], at: usize) -> usize {
        for (place, word) in [(at, self.head), (at.wrapping_add(self.head_length.into()), self.tail)] {
            if let Some(bytes) = out.get_mut(place..).and_then(|rest| rest.first_chunk_mut()) {
                *bytes = word.to_le_bytes();
            }
        }
        at.wrapping_add(self.length.into())
    }

    pub(super) fn push(self, out: &mut Vec<u8>) {
        let start = out.len();
        out.extend_from_slice(&[0; SHORT]);
        let end = self.put(out, start);
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
    let (digits, rest, divisor) = match unit {
        1_000_000 => divided::<100>(value),
        25_400_000 => divided::<2_540>(value),
        _ => return None,
    };
    if rest == divisor / 2 { None } else { Some(digits.wrapping_add(u64::from(rest > divisor / 2))) }
}

#[inline]
fn divided<const BY: u64>(value: i64) -> (u64, u64, u64) {
    let magnitude = value.unsigned_abs();
    (magnitude / BY, magnitude % BY, BY)
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

/// The same of at most eight digits.
#[inline]
fn few_digits(minus: bool, ten_thousandths: u64) -> Short {
    let digits = eight_digits(ten_thousandths);
    // The last digit before the point stays.
    let zeros = zeros_in_front(digits).min(3);
    let whole = (digits & 0xFFFF_FFFF) >> (8 * zeros);
    let head = if minus { (whole << 8) | u64::from(b'-') } else { whole };
    let tail = u64::from(b'.') | ((digits >> 32) << 8) | (u64::from(u16::from_le_bytes(*SEPARATOR)) << 40);
    let head_length = 4u8.wrapping_sub(zeros as u8).wrapping_add(u8::from(minus));
    Short { head, tail, head_length, length: head_length.wrapping_add(7) }
}

/// The digits of a number below 10⁸, the first in the lowest byte: two halves, four quarters, eight digits at once.
#[inline]
const fn eight_digits(number: u64) -> u64 {
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = (fours.wrapping_mul(10_486) >> 20) & 0x7F_0000_007F;
    let twos = hundreds | (fours.wrapping_sub(hundreds.wrapping_mul(100)) << 16);
    let tens = (twos.wrapping_mul(103) >> 10) & 0x000F_000F_000F_000F;
    tens | (twos.wrapping_sub(tens.wrapping_mul(10)) << 8) | 0x3030_3030_3030_3030
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
    one: u64,
}

impl Count {
    /// Before the first line.
    pub(super) fn new() -> Self {
        let mut count = Self { number: 0, text: None, one: 0 };
        count.write();
        count
    }

    /// Counts one on; gives its text when it is short.
    #[inline]
    pub(super) fn next(&mut self) -> Option<Short> {
        self.number += 1;
        match &mut self.text {
            Some(text) if !self.number.is_multiple_of(10) => text.head += self.one,
            _ => self.write(),
        }
        self.text
    }

    /// Appends the present number.
    pub(super) fn push(&self, out: &mut Vec<u8>) {
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
            let left_out = zeros.min(3);
            self.one = 1 << (8 * (7 - left_out));
            let head_length = 8 - left_out as u8;
            let head = (digits ^ blanks) >> (8 * left_out);
            Short { head, tail: u64::from(b' '), head_length, length: head_length + 1 }
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
            (1..=20).for_each(|_| {
                count.next();
                count.push(&mut out);
            });
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
