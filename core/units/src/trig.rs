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
    // Quarter turns below the angle are removed exactly, in units of 2⁻⁹¹.
    let scaled = (magnitude as i128) << 59;
    let turns = quarter_turns(scaled);
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

/// Whole quarter turns in an angle in units of 2⁻⁹¹, not negative: most are counted, because a division of 128 bits is a routine.
fn quarter_turns(scaled: i128) -> i128 {
    let mut turns = 0i128;
    let mut end = FRAC_PI_2_Q91;
    while turns < 4 {
        if scaled < end {
            return turns;
        }
        end = end.saturating_add(FRAC_PI_2_Q91);
        turns = turns.saturating_add(1);
    }
    scaled.checked_div(FRAC_PI_2_Q91).unwrap_or(0)
}

/// Taylor series of sine and cosine on 0…π/4; the first term left out is below 2⁻⁶².
fn first_octant(x: i64) -> (Real, Real) {
    let square = mul(x, x);
    // 1 − x²/(a·b)·(…): Horner over both series at once.
    let terms = step::<306, 342>(square, (0, 0));
    let terms = step::<240, 272>(square, terms);
    let terms = step::<182, 210>(square, terms);
    let terms = step::<132, 156>(square, terms);
    let terms = step::<90, 110>(square, terms);
    let terms = step::<56, 72>(square, terms);
    let terms = step::<30, 42>(square, terms);
    let terms = step::<12, 20>(square, terms);
    let (cosine, sine) = step::<2, 6>(square, terms);
    let to_real = |v: i64| Real::from_bits(shift_rounded(v as i128, Q - Real::FRACTION_BITS) as i64);
    (to_real(mul(x, ONE.saturating_add(sine))), to_real(ONE.saturating_add(cosine)))
}

/// The next terms of cosine and sine; their divisors are constants, so that nothing is divided.
#[inline]
fn step<const COSINE: u64, const SINE: u64>(square: i64, (cosine, sine): (i64, i64)) -> (i64, i64) {
    let term = |inner: i64| mul(square, ONE.saturating_add(inner)).cast_unsigned();
    // Neither factor is negative.
    let divided = |term: u64, by: u64| term.saturating_add(by / 2).checked_div(by).unwrap_or(0).cast_signed();
    let cosine = divided(term(cosine), COSINE);
    let sine = divided(term(sine), SINE);
    (cosine.saturating_neg(), sine.saturating_neg())
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

/// 1/11, 1/9 … 1/1 in units of 2⁻⁶⁰.
const ODD_PARTS: [i64; 6] = [
    div_rounded(ONE as i128, 11) as i64,
    div_rounded(ONE as i128, 9) as i64,
    div_rounded(ONE as i128, 7) as i64,
    div_rounded(ONE as i128, 5) as i64,
    div_rounded(ONE as i128, 3) as i64,
    ONE,
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
    let series = ODD_PARTS.iter().fold(0i64, |series, part| part.saturating_sub(mul(square, series)));
    ATAN_SIXTEENTHS.get(index).copied().unwrap_or(0).saturating_add(mul(rest, series))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 1.0 / 4_294_967_296.0;

    /// The series as it is written, every division done.
    fn divided(x: i64) -> (Real, Real) {
        let square = mul(x, x);
        let (mut sine, mut cosine) = (0i64, 0i64);
        let step = |inner: i64, divisor: i64| -(div_rounded(mul(square, inner) as i128, divisor as i128) as i64);
        for k in (1..=9i64).rev() {
            cosine = step(ONE + cosine, 2 * k * (2 * k - 1));
            sine = step(ONE + sine, 2 * k * (2 * k + 1));
        }
        let to_real = |v: i64| Real::from_bits(shift_rounded(v as i128, Q - Real::FRACTION_BITS) as i64);
        (to_real(mul(x, ONE + sine)), to_real(ONE + cosine))
    }

    proptest! {
        #[test]
        fn nothing_is_divided_and_every_bit_is_that_of_the_division(x in 0..=FRAC_PI_2 / 2, angle in any::<i64>()) {
            prop_assert_eq!(first_octant(x), divided(x));
            for angle in [angle, angle >> 26, angle >> 28, angle >> 29] {
                let scaled = (angle.unsigned_abs() as i128) << 59;
                prop_assert_eq!(quarter_turns(scaled), scaled / FRAC_PI_2_Q91);
            }
        }
    }

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
