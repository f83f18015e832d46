//! Numbers with four decimals, as C's `%.4f` writes the double next to them.
//!
//! A length is a whole number of nanometres, so its digits are found with whole numbers alone; only an exact half of
//! the last digit is left to the double, whose error decides there. A zero carries no minus sign.

use std::io::Write;

/// Appends `value / unit` with four decimals; `unit` is positive: 1 000 000 for millimetres and degrees, 25 400 000
/// for inches.
pub(super) fn push_ratio(out: &mut Vec<u8>, value: i64, unit: i64) {
    // An axis that does not move, and those that turn nearly always.
    if value == 0 {
        return out.extend_from_slice(b"0.0000");
    }
    // Both units are multiples of 10 000. Division by a constant is a product.
    let magnitude = value.unsigned_abs();
    let (mut digits, rest, last) = match unit {
        1_000_000 => (magnitude / 100, magnitude % 100, 100),
        _ => {
            let last = (unit / 10_000).unsigned_abs().max(1);
            (magnitude / last, magnitude % last, last)
        }
    };
    if rest * 2 == last {
        return push_real(out, value as f64 / unit as f64);
    }
    digits += u64::from(rest * 2 > last);
    if value < 0 && digits != 0 {
        out.push(b'-');
    }
    push_digits(out, digits);
}

/// Appends a double with four decimals.
pub(super) fn push_real(out: &mut Vec<u8>, value: f64) {
    let start = out.len();
    // Writing to memory does not fail.
    let _ = write!(out, "{value:.4}");
    if out.get(start..) == Some(b"-0.0000") {
        out.remove(start);
    }
}

/// Appends ten-thousandths as a decimal number.
fn push_digits(out: &mut Vec<u8>, ten_thousandths: u64) {
    let (whole, part) = (ten_thousandths / 10_000, ten_thousandths % 10_000);
    push_whole(out, whole);
    // With a one before them, so that the zeros stay.
    let mut text = itoa::Buffer::new();
    let digits = text.format(part as u32 + 10_000).as_bytes();
    out.extend_from_slice(&[b'.', digits[1], digits[2], digits[3], digits[4]]);
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

    proptest! {
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
