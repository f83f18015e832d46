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

/// 1/23, 1/21 … 1 in units of 2⁻⁶⁰.
const ODD_RECIPROCALS: [i64; 12] = [
    50_127_021_939_428_129,
    54_901_024_028_897_475,
    60_680_079_189_834_051,
    67_818_912_035_696_881,
    76_861_433_640_456_465,
    88_686_269_585_142_075,
    104_811_045_873_349_725,
    128_102_389_400_760_775,
    164_703_072_086_692_425,
    230_584_300_921_369_395,
    384_307_168_202_282_325,
    1_152_921_504_606_846_976,
];

/// `y/K·(1 + series)`, rounded. Division by a constant is a product; neither factor is above 1 by much.
#[inline]
fn term<const K: u64>(y: i64, series: i64) -> i64 {
    let product = mul(y, ONE.saturating_add(series));
    let magnitude = product.unsigned_abs().wrapping_add(K / 2).checked_div(K).unwrap_or(0) as i64;
    if product < 0 { magnitude.wrapping_neg() } else { magnitude }
}

/// Three terms of the exponential series.
#[inline]
fn three<const A: u64, const B: u64, const C: u64>(y: i64, series: i64) -> i64 {
    term::<C>(y, term::<B>(y, term::<A>(y, series)))
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
    let series = ODD_RECIPROCALS.iter().fold(0i64, |series, part| part.saturating_add(mul(square, series)));
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
    // y/1·(1 + y/2·(1 + …)) by Horner, three terms at a time.
    let series = three::<17, 16, 15>(y, 0);
    let series = three::<14, 13, 12>(y, series);
    let series = three::<11, 10, 9>(y, series);
    let series = three::<8, 7, 6>(y, series);
    let series = three::<5, 4, 3>(y, series);
    let value = ONE.saturating_add(term::<1>(y, term::<2>(y, series))) as i128;
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
