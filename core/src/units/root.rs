//! Square roots of integers, rounded to nearest.

use super::Offset;

/// The square root of an integer, rounded to nearest (exact: no tie exists). Error ≤ 1/2.
pub const fn isqrt_rounded(value: u128) -> u128 {
    let root = value.isqrt();
    // value > (root + 1/2)² exactly when value − root² > root.
    if value.saturating_sub(root.saturating_mul(root)) > root { root.saturating_add(1) } else { root }
}

/// The length of (x, y), rounded to the nanometre, saturating.
pub const fn hypot_nm(x: Offset, y: Offset) -> Offset {
    let a = x.nm().unsigned_abs() as u128;
    let b = y.nm().unsigned_abs() as u128;
    let root = isqrt_rounded(a.saturating_mul(a).saturating_add(b.saturating_mul(b)));
    if root > i64::MAX as u128 { Offset::MAX } else { Offset::from_nm(root as i64) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn root_is_the_nearest_integer(v in any::<u128>()) {
            let v = v >> 4;
            let r = isqrt_rounded(v);
            // (r − 1/2)² ≤ v ≤ (r + 1/2)², in whole numbers.
            prop_assert!(r * r - r < v || r == 0);
            prop_assert!(v <= r * r + r);
        }
    }
}
