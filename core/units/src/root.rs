//! Square roots of integers, rounded to nearest.
//!
//! A table gives the reciprocal root of a number normalised to 64 bits, Newton's steps refine it; they multiply and never
//! divide: a division of 64 bits is slow on a PC and a routine on the microcontroller, and the root is the heart of the
//! wall's envelope. The remainder makes the result exact, so nothing but the time depends on the approximation.

/// The square root of an integer, rounded to nearest (exact: no tie exists). Error ≤ 1/2.
#[inline]
pub const fn isqrt_rounded(value: u128) -> u128 {
    if value >> 64 == 0 {
        return rounded_64(value as u64) as u128;
    }
    rounded_128(value)
}

/// [`isqrt_rounded`] of a number from 1 to 2⁶² − 1, sooner found where it is nearly the square of `near`, below 2³¹: `per_double` is 2⁶³
/// over twice that or a number near it. One step of Newton's, proved by what is left.
#[inline]
pub const fn isqrt_near(value: i64, near: i64, per_double: i64) -> i64 {
    let root = near.wrapping_add(part(value.wrapping_sub(near.wrapping_mul(near)), per_double));
    // The nearest is the one with −root < value − root² ≤ root.
    let left = value.wrapping_sub(root.wrapping_mul(root));
    if root >> 31 == 0 && left > root.wrapping_neg() && left <= root { root } else { rounded_64(value as u64) as i64 }
}

/// A number over another, to about a unit, by 2⁶³ over that.
#[inline]
pub const fn part(number: i64, per: i64) -> i64 {
    (number as i128).wrapping_mul(per as i128).wrapping_add(1 << 62).wrapping_shr(63) as i64
}

/// [`isqrt_rounded`] of 64 bits.
pub(crate) const fn rounded_64(value: u64) -> u64 {
    let root = floor_64(value);
    // value > (root + 1/2)² exactly when value − root² > root.
    let up = value.wrapping_sub(root.wrapping_mul(root)) > root;
    root.wrapping_add(up as u64)
}

const fn rounded_128(value: u128) -> u128 {
    let root = floor_128(value);
    let up = value.wrapping_sub(square(root)) > root as u128;
    (root as u128).wrapping_add(up as u128)
}

const fn square(v: u64) -> u128 {
    (v as u128).wrapping_mul(v as u128)
}

const fn floor_64(value: u64) -> u64 {
    if value == 0 {
        return 0;
    }
    let shift = value.leading_zeros() & !1;
    normalised(value << shift).0 >> (shift / 2)
}

/// The root of a value of more than 64 bits, rounded down.
const fn floor_128(value: u128) -> u64 {
    let shift = value.leading_zeros() & !1;
    let n = value << shift;
    let (leading, reciprocal) = normalised((n >> 64) as u64);
    // The root of the upper half is half of the digits; what it leaves of n, over twice the root, is the other half. The
    // second time removes what the reciprocal's 30 bits left.
    let mut root = leading << 32;
    let mut times = 0;
    while times < 2 {
        let rest = (n.wrapping_sub(square(root)) as i128) >> 40;
        root = root.saturating_add_signed((rest.wrapping_mul(reciprocal as i128) >> 56) as i64);
        times = i32::wrapping_add(times, 1);
    }
    while square(root) > n {
        root = root.wrapping_sub(1);
    }
    while n.wrapping_sub(square(root)) > (root as u128) << 1 {
        root = root.wrapping_add(1);
    }
    root >> (shift / 2)
}

/// For n ≥ 2⁶²: (⌊√n⌋, 2⁶³/√n to about 30 bits).
const fn normalised(n: u64) -> (u64, u64) {
    let mut x = first(n);
    let m = n >> 32;
    let mut times = 0;
    while times < 2 {
        // x ← x·(3 − m·x²)/2 with 31 fractional bits; from 8 good bits to 15, to 30.
        let product = m.wrapping_mul(x.wrapping_mul(x) >> 32) >> 31;
        x = x.saturating_mul((3u64 << 31).wrapping_sub(product)) >> 32;
        times = i32::wrapping_add(times, 1);
    }
    let mut root = within_32(m.wrapping_mul(x) >> 31);
    // What it leaves of n, over twice the root.
    let rest = n.wrapping_sub(root.wrapping_mul(root)) as i64;
    root = within_32(root.wrapping_add_signed((rest >> 8).wrapping_mul(x as i64) >> 56));
    while root.wrapping_mul(root) > n {
        root = root.wrapping_sub(1);
    }
    while n.wrapping_sub(root.wrapping_mul(root)) > root << 1 {
        root = root.wrapping_add(1);
    }
    (root, x)
}

/// No root of 64 bits has more than 32.
const fn within_32(root: u64) -> u64 {
    if root > u32::MAX as u64 { u32::MAX as u64 } else { root }
}

/// The reciprocal root of the middle of the interval that the leading byte of n (64…255) stands for.
#[expect(clippy::indexing_slicing, reason = "a byte is below 256")]
const fn first(n: u64) -> u64 {
    (RECIPROCAL_ROOTS[(n >> 56) as u8 as usize] as u64) << 16
}

/// 2¹⁵/√m at the middles of intervals of m, 1/256 wide.
static RECIPROCAL_ROOTS: [u16; 256] = {
    let mut table = [u16::MAX; 256];
    let mut rest: &mut [u16] = &mut table;
    let mut byte = 0u64;
    while let [slot, behind @ ..] = rest {
        // √(2³⁰/m), m = (byte + 1/2)/256.
        let root = (1u64 << 39).div_euclid(byte.wrapping_mul(2).wrapping_add(1)).isqrt();
        *slot = if root > u16::MAX as u64 { u16::MAX } else { root as u16 };
        byte = byte.wrapping_add(1);
        rest = behind;
    }
    table
};

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    /// The root of the standard library, rounded.
    fn expected(v: u128) -> u128 {
        let root = v.isqrt();
        root + u128::from(v - root * root > root)
    }

    #[test]
    fn roots_about_every_power_of_two_and_its_squares_are_exact() {
        for bits in 0..128u32 {
            let power = 1u128 << bits;
            for near in 0..200 {
                for v in [power.wrapping_add(near), power.wrapping_sub(near), u128::MAX - near] {
                    assert_eq!(isqrt_rounded(v), expected(v), "{v}");
                }
                let root = (power >> (bits / 2)).wrapping_sub(near) & u128::from(u64::MAX);
                for v in [root * root, (root * root).wrapping_sub(1), root * root + root, root * root + root + 1] {
                    assert_eq!(isqrt_rounded(v), expected(v), "{v}");
                }
            }
        }
    }

    #[test]
    fn roots_of_every_leading_byte_are_exact_at_both_ends_of_it() {
        for byte in 64..=256u128 {
            for shift in [56u32, 54, 120, 119] {
                let edge = if byte == 256 && shift == 120 { u128::MAX } else { byte << shift };
                for v in [edge - 2, edge - 1, edge, edge.saturating_add(1)] {
                    assert_eq!(isqrt_rounded(v), expected(v), "{v}");
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn a_root_found_from_one_nearby_or_far_off_is_the_same(
            value in 1i64..1 << 62, drop in 0u32..61, near in 0i64..1 << 31, off in -2000i64..2000, per in any::<i64>()
        ) {
            let value = (value >> drop).max(1);
            let root = expected(value as u128) as i64;
            let beside = (root + off).clamp(1, (1 << 31) - 1);
            for (near, per) in [(near, per), (beside, (1 << 62) / beside), (root, 0)] {
                prop_assert_eq!(isqrt_near(value, near, per), root);
            }
        }

        #[test]
        fn root_is_the_nearest_integer(v in any::<u128>(), drop in 0u32..127) {
            let v = v >> drop;
            prop_assert_eq!(isqrt_rounded(v), expected(v));
        }
    }
}
