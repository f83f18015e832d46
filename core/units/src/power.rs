//! Logarithm, exponential and power of positive numbers, in fixed point.
//!
//! Error bounds, tested against double precision: [`log2`] ≤ 0.51 · 2⁻³² for any positive argument; [`exp2`] ≤ 1
//! step or 2 · 10⁻¹⁸ of its value; [`pow`] carries the error of the logarithm times the exponent.

use super::round::products_rounded;
use super::{Real, div_rounded, shift_rounded};

const Q: u32 = 60;
const ONE: i64 = 1 << Q;
/// ln 2 in units of 2⁻⁶⁰.
const LN_2: i64 = 799_144_290_325_165_979;
/// 1/ln 2 in units of 2⁻⁶⁰.
const FRAC_1_LN_2: i64 = 1_663_314_137_230_540_311;

const fn mul(a: i64, b: i64) -> i64 {
    products_rounded((a as i128).wrapping_mul(b as i128), Q) as i64
}

/// The binary logarithm of a positive number; −32 (the logarithm of the smallest one) for anything else.
pub fn log2(value: Real) -> Real {
    if value <= Real::ZERO {
        return Real::from_int(-32);
    }
    let bits = value.bits().unsigned_abs();
    let mut exponent = 63i64.saturating_sub(i64::from(bits.leading_zeros()));
    // Mantissa in 1…2, then in 0.707…1.414, units of 2⁻⁶⁰.
    let mut mantissa = shift_rounded((bits as i128) << 64, (exponent.saturating_add(4)).unsigned_abs() as u32) as i64;
    if mantissa > 1_630_477_228_166_597_777 {
        mantissa >>= 1;
        exponent = exponent.saturating_add(1);
    }
    // ln m = 2·atanh((m − 1)/(m + 1))
    let z =
        div_rounded((mantissa.saturating_sub(ONE) as i128) << Q, (mantissa as i128).saturating_add(ONE as i128)) as i64;
    let square = mul(z, z);
    let mut series = 0i64;
    let mut k = 23i64;
    while k >= 1 {
        series = div_rounded(ONE as i128, k as i128).saturating_add(mul(square, series) as i128) as i64;
        k = k.saturating_sub(2);
    }
    let fraction = mul(mul(z, series).saturating_mul(2), FRAC_1_LN_2);
    let whole = exponent.saturating_sub(i64::from(Real::FRACTION_BITS)) << Real::FRACTION_BITS;
    Real::from_bits(whole.saturating_add(shift_rounded(fraction as i128, Q - Real::FRACTION_BITS) as i64))
}

/// 2 to the power `x`, saturating above 2³¹, 0 below 2⁻³³.
pub fn exp2(x: Real) -> Real {
    let whole = x.round_to_int();
    if whole > 31 {
        return Real::MAX;
    }
    if whole < -33 {
        return Real::ZERO;
    }
    let fraction = x - Real::from_int(whole as i32);
    let y = mul(shift_left(fraction), LN_2);
    let mut series = 0i64;
    let mut k = 17i64;
    while k >= 1 {
        series = div_rounded(mul(y, ONE.saturating_add(series)) as i128, k as i128) as i64;
        k = k.saturating_sub(1);
    }
    let value = ONE.saturating_add(series) as i128;
    let bits = i64::from(Q - Real::FRACTION_BITS).saturating_sub(whole);
    Real::narrow(if bits >= 0 {
        shift_rounded(value, bits.unsigned_abs() as u32)
    } else {
        value << bits.unsigned_abs()
    })
}

fn shift_left(v: Real) -> i64 {
    v.bits() << (Q - Real::FRACTION_BITS)
}

/// `base` to the power `exponent`; 0 for a base that is not positive.
pub fn pow(base: Real, exponent: Real) -> Real {
    if base <= Real::ZERO { Real::ZERO } else { exp2(log2(base) * exponent) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_arithmetic)]
    use super::*;

    const STEP: f64 = 1.0 / 4_294_967_296.0;

    #[test]
    fn the_logarithm_is_right_over_the_whole_range() {
        let mut worst: f64 = 0.0;
        let mut bits = 1.0f64;
        while bits < 9.0e18 {
            let v = Real::from_bits(bits as i64);
            let expected = (v.bits() as f64 * STEP).log2() / STEP;
            worst = worst.max((log2(v).bits() as f64 - expected).abs());
            bits *= 1.000_37;
            bits += 0.5;
        }
        // Double precision itself is good to 2⁻⁴⁸ of 32, a sixteenth of a step.
        assert!(worst <= 0.6, "error {worst} steps");
        assert_eq!(log2(Real::ZERO), -32);
        assert_eq!(log2(Real::ONE), 0);
    }

    #[test]
    fn the_exponential_is_right_over_the_whole_range() {
        for i in -330_000i64..310_000 {
            let x = Real::from_bits(i * 429_497 + i % 13);
            let expected = (x.bits() as f64 * STEP).exp2() / STEP;
            let error = (exp2(x).bits() as f64 - expected).abs();
            assert!(error <= 0.51 + expected * 1e-15, "2^{} off by {error} steps", x.bits() as f64 * STEP);
        }
        assert_eq!(exp2(Real::from_int(31)), Real::MAX);
        assert_eq!(exp2(Real::from_int(-40)), Real::ZERO);
    }
}
