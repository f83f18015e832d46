//! The one rounding of the crate: to nearest, ties away from zero.
//!
//! It is odd-symmetric, `round(-x) == -round(x)`, which is what makes a mirrored or turned contour give mirrored or
//! turned bits. Everything that drops bits goes through one of the widths below.

/// Into ±(2⁶³ − 1): −2⁶³ has no opposite.
#[inline]
pub(crate) const fn symmetric(value: i64) -> i64 {
    if value == i64::MIN { i64::MAX.wrapping_neg() } else { value }
}

/// The sum of two numbers within ±(2⁶³ − 1), saturated to that range: almost none leaves it, so that is a branch never taken.
#[inline]
pub(crate) const fn sum(a: i64, b: i64) -> i64 {
    match a.overflowing_add(b) {
        (sum, false) if sum != i64::MIN => sum,
        _ => end_on_the_side_of(a),
    }
}

/// The same of their difference.
#[inline]
pub(crate) const fn difference(a: i64, b: i64) -> i64 {
    match a.overflowing_sub(b) {
        (difference, false) if difference != i64::MIN => difference,
        _ => end_on_the_side_of(a),
    }
}

/// What leaves the range does so on the side of its first number.
#[cold]
#[inline(never)]
const fn end_on_the_side_of(a: i64) -> i64 {
    if a < 0 { i64::MAX.wrapping_neg() } else { i64::MAX }
}

/// Saturates to ±(2⁶³ − 1).
#[inline]
pub(crate) const fn within_64(value: i128) -> i64 {
    let low = value as i64;
    if low as i128 == value {
        symmetric(low)
    } else if value < 0 {
        i64::MAX.wrapping_neg()
    } else {
        i64::MAX
    }
}

/// `value / 2^bits`, rounded to nearest, ties away from zero. `bits` ≤ 126.
#[inline]
pub const fn shift_rounded(value: i128, bits: u32) -> i128 {
    if bits == 0 {
        return value;
    }
    let half = 1u128 << bits.saturating_sub(1);
    let magnitude = value.unsigned_abs().saturating_add(half) >> bits;
    signed(magnitude, value < 0)
}

/// `value / 2^bits` for the sum of at most two products of 64 bits and 1 ≤ `bits` ≤ 63, the same rounding in few
/// instructions: half is added, less one step where the value is negative, and the shift rounds down. Neither product may
/// hold −2⁶³, so that the sum is within ±(2¹²⁷ − 2⁶⁴).
#[inline]
pub(crate) const fn products_rounded(sum: i128, bits: u32) -> i128 {
    with_half(sum, bits) >> (bits & 127)
}

/// The same by 32 bits, saturated to ±(2⁶³ − 1): the product of the model's numbers.
#[inline]
pub(crate) const fn products_to_real(sum: i128) -> i64 {
    let sum = with_half(sum, 32);
    // Far from the ends of the range, as almost all are, the upper word alone tells that the lower bits hold it.
    if ((sum >> 64) as i64).wrapping_add(1 << 30) as u64 >> 31 == 0 { (sum >> 32) as i64 } else { to_the_end(sum) }
}

#[inline]
const fn with_half(sum: i128, bits: u32) -> i128 {
    let half = 1i64 << (bits.wrapping_sub(1) & 63);
    sum.wrapping_add(half.wrapping_add((sum >> 127) as i64) as u64 as i128)
}

#[cold]
#[inline(never)]
const fn to_the_end(sum: i128) -> i64 {
    within_64(sum >> 32)
}

/// `value / 2^bits` in 64 bits, the same rounding, for the servo cycle. `bits` ≤ 62.
#[inline]
pub const fn shift_rounded_i64(value: i64, bits: u32) -> i64 {
    if bits == 0 {
        return value;
    }
    let half = 1u64 << bits.saturating_sub(1);
    let magnitude = value.unsigned_abs().saturating_add(half) >> bits;
    if value < 0 { (magnitude as i64).wrapping_neg() } else { magnitude as i64 }
}

/// `value / 2^bits` for a value within ±2⁶² and 1 ≤ `bits` ≤ 62, the same rounding in five instructions of a 32-bit
/// processor: half is added, less one step where the value is negative, and the shift rounds down.
#[inline]
pub const fn shift_rounded_i63(value: i64, bits: u32) -> i64 {
    let half = 1i64 << (bits.wrapping_sub(1) & 63);
    // Up to 32 bits the half less the sign fits a word, which saves the upper half of its addition.
    let half = if bits <= 32 {
        ((half as u32).wrapping_add((value >> 63) as u32)) as i64
    } else {
        half.wrapping_add(value >> 63)
    };
    value.wrapping_add(half) >> (bits & 63)
}

/// `value / 2^bits` for a value within ±2³⁰ and 1 ≤ `bits` ≤ 30, the same rounding in 32 bits.
#[inline]
pub const fn shift_rounded_i31(value: i32, bits: u32) -> i32 {
    let half = 1i32 << (bits.wrapping_sub(1) & 31);
    value.wrapping_add(half.wrapping_add(value >> 31)) >> (bits & 31)
}

/// `numerator / denominator`, rounded to nearest, ties away from zero.
///
/// A zero denominator saturates to the end of the range on the numerator's side, and 0/0 is 0: no data can divide
/// by zero.
#[inline]
pub const fn div_rounded(numerator: i128, denominator: i128) -> i128 {
    let negative = (numerator < 0) != (denominator < 0);
    let d = denominator.unsigned_abs();
    let n = numerator.unsigned_abs();
    let half_more = n.saturating_add(d / 2);
    if (half_more | d) >> 64 == 0
        && let Some(quotient) = (half_more as u64).checked_div(d as u64)
    {
        // Most: a division of 128 bits is a routine.
        return signed(quotient as u128, negative);
    }
    let Some(quotient) = half_more.checked_div(d) else {
        return if n == 0 { 0 } else { signed(i128::MAX.unsigned_abs(), numerator < 0) };
    };
    signed(quotient, negative)
}

const fn signed(magnitude: u128, negative: bool) -> i128 {
    let limited = if magnitude > i128::MAX as u128 { i128::MAX } else { magnitude as i128 };
    if negative { limited.wrapping_neg() } else { limited }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ties_go_away_from_zero_on_both_sides() {
        assert_eq!([shift_rounded(5, 1), shift_rounded(-5, 1)], [3, -3]);
        assert_eq!([shift_rounded_i64(5, 1), shift_rounded_i64(-5, 1)], [3, -3]);
        assert_eq!([div_rounded(7, 2), div_rounded(-7, 2), div_rounded(7, -2)], [4, -4, -4]);
    }

    #[test]
    fn division_by_zero_saturates_instead_of_panicking() {
        assert_eq!([div_rounded(0, 0), div_rounded(1, 0), div_rounded(-1, 0)], [0, i128::MAX, -i128::MAX]);
    }

    #[test]
    fn sums_and_differences_end_where_saturating_ones_do() {
        let ends = [0, 1, 2, i64::MAX / 2, i64::MAX / 2 + 1, i64::MAX - 1, i64::MAX];
        let all = ends.into_iter().chain(ends.map(|v| -v));
        for (a, b) in all.clone().flat_map(|a| all.clone().map(move |b| (a, b))) {
            assert_eq!(sum(a, b), symmetric(a.saturating_add(b)), "{a} + {b}");
            assert_eq!(difference(a, b), symmetric(a.saturating_sub(b)), "{a} - {b}");
        }
    }

    proptest! {
        #[test]
        fn rounding_is_odd_symmetric(v in any::<i64>(), bits in 0u32..62, d in 1i64..) {
            let wide = i128::from(v);
            prop_assert_eq!(shift_rounded(-wide, bits), -shift_rounded(wide, bits));
            prop_assert_eq!(div_rounded(-wide, d.into()), -div_rounded(wide, d.into()));
            let narrow = v >> 1;
            prop_assert_eq!(i128::from(shift_rounded_i64(narrow, bits)), shift_rounded(narrow.into(), bits));
        }

        #[test]
        fn the_short_ways_round_like_the_long_one(v in any::<i64>(), drop in 1u32..63, bits in 1u32..63) {
            // Every magnitude, and ties: the value as it is and with nothing but the half behind the point.
            for v in [v >> drop, ((v >> drop) | 1) << (bits - 1).min(drop)] {
                prop_assert_eq!(shift_rounded_i63(v >> 1, bits), shift_rounded_i64(v >> 1, bits));
                let (v, bits) = ((v as i32) >> 1, bits.min(30));
                prop_assert_eq!(i64::from(shift_rounded_i31(v, bits)), shift_rounded_i64(v.into(), bits));
            }
        }

        #[test]
        fn sums_of_products_round_like_the_long_way(
            v in prop::array::uniform4(any::<i64>()), drop in 0u32..63, bits in 1u32..64
        ) {
            let [a, b, c, d] = v.map(|v| i128::from(symmetric(v)) >> drop);
            for sum in [a * b + c * d, a * b, (a << bits.min(62)) + (1 << (bits - 1)), (a << bits.min(62)) - (1 << (bits - 1))] {
                prop_assert_eq!(products_rounded(sum, bits), shift_rounded(sum, bits));
                prop_assert_eq!(products_to_real(sum), within_64(shift_rounded(sum, 32)));
                let limits = (-i128::from(i64::MAX), i128::from(i64::MAX));
                prop_assert_eq!(i128::from(within_64(sum)), sum.clamp(limits.0, limits.1));
            }
        }

        #[test]
        fn rounding_is_to_nearest(v in any::<i64>(), d in 1i64.., up in 0u32..60) {
            let (v, d) = (i128::from(v) << up, i128::from(d));
            let q = div_rounded(v, d);
            prop_assert!((q * d - v).abs() * 2 <= d);
        }
    }
}
