//! How the chip part of a correction follows the live feed per tooth: the factor (f/f₀)^(1−m).
//!
//! The specific cutting force rises when the chip gets thin, K = K₀·(f/f₀)^(−m), so the part of the force that is
//! proportional to the chip goes with f^(1−m); m = 0 is the plain proportional law of P23 eq (1). The power is
//! computed when the image is made and stored as 33 samples, because the servo cycle has no logarithm.
//! Linear interpolation between the samples is low by at most 0.2 % for f/f₀ ≥ 0.25.

use truepath_units::{Real, pow, shift_rounded_i63, shift_rounded_i64};

use super::FineOffset;

/// Samples of the factor, one per sixteenth of the nominal feed, from standstill to twice the nominal feed.
pub const FACTOR_NODES: usize = 33;
/// Fraction bits of a feed ratio.
pub const RATIO_BITS: u32 = 16;
/// The nominal feed as a ratio.
pub const RATIO_ONE: u32 = 1 << RATIO_BITS;
/// Fraction bits of the chip factor.
pub const FACTOR_BITS: u32 = 24;
/// Factor 1.
pub const FACTOR_ONE: i32 = 1 << FACTOR_BITS;

/// Nominal feed and how the chip part departs from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedLaw {
    /// Nominal feed per tooth, 1 nm … 8 mm.
    pub per_tooth: FineOffset,
    /// Teeth of the cutter, 1 … 64.
    pub teeth: u32,
    /// Nominal spindle speed, thousandths of a revolution per minute, for the record.
    pub spindle_millirpm: u32,
    /// Size exponent m, 0…1, units of 2⁻¹⁶, for the record; the servo cycle reads the table.
    pub size_exponent: u32,
    /// Least ratio of live to nominal feed for which the correction is trusted, units of 2⁻¹⁶.
    pub ratio_low: u32,
    /// Greatest ratio, units of 2⁻¹⁶, at most 2.
    pub ratio_high: u32,
    /// (f/f₀)^(1−m) at f/f₀ = k/16, units of 2⁻²⁴.
    pub factor: [u32; FACTOR_NODES],
}

impl FeedLaw {
    /// The law for a size exponent, valid between two ratios of live to nominal feed.
    /// Values outside the ranges of the fields are refused when the image is made.
    pub fn new(
        per_tooth: FineOffset,
        teeth: u32,
        spindle_millirpm: u32,
        size_exponent: Real,
        ratio_low: Real,
        ratio_high: Real,
    ) -> Self {
        let q16 = |v: Real| shift_rounded_i64(v.bits(), Real::FRACTION_BITS.saturating_sub(RATIO_BITS)) as u32;
        let mut factor = [0; FACTOR_NODES];
        let power = Real::ONE - size_exponent;
        for (k, entry) in factor.iter_mut().enumerate() {
            let value = if power == 0 { Real::ONE } else { pow(Real::ratio(k as i64, 16), power) };
            *entry = shift_rounded_i64(value.bits(), Real::FRACTION_BITS.saturating_sub(FACTOR_BITS)) as u32;
        }
        Self {
            per_tooth,
            teeth,
            spindle_millirpm,
            size_exponent: q16(size_exponent),
            ratio_low: q16(ratio_low),
            ratio_high: q16(ratio_high),
            factor,
        }
    }

    /// The chip factor, units of 2⁻²⁴, at a ratio in units of 2⁻¹⁶; linear between samples, constant beyond 2.
    #[inline(always)]
    pub fn factor_at(&self, ratio: u32) -> i32 {
        const STEP_BITS: u32 = RATIO_BITS - 4;
        let index = (ratio >> STEP_BITS) as usize;
        let last = self.factor.last().copied().unwrap_or(0);
        let low = self.factor.get(index).copied().unwrap_or(last) as i32;
        let high = self.factor.get(index.wrapping_add(1)).copied().unwrap_or(last) as i32;
        let fraction = ratio & ((1 << STEP_BITS) - 1);
        // In range: differences are below 2²⁶, the fraction below 2¹².
        let rise = i64::from(high.wrapping_sub(low)).wrapping_mul(i64::from(fraction));
        low.wrapping_add(shift_rounded_i63(rise, STEP_BITS) as i32)
    }
}

/// A part times a chip factor, units of 2⁻⁸ nm.
#[inline]
pub(super) fn scaled(part: FineOffset, factor: i32) -> i64 {
    // In range: a factor is at most 2, 2²⁵, so the product is below 2⁵⁷.
    shift_rounded_i63(i64::from(part.bits()).wrapping_mul(i64::from(factor)), FACTOR_BITS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
    use super::*;

    #[test]
    fn the_factor_is_one_at_the_nominal_feed_and_follows_the_power() {
        for (exponent, m) in [(0, 0.0), (20, 0.2), (35, 0.35), (100, 1.0)] {
            let m_real = Real::ratio(exponent, 100);
            let law = FeedLaw::new(FineOffset::from_bits(1 << 20), 4, 1, m_real, Real::HALF, Real::from_int(2));
            assert_eq!(law.factor_at(RATIO_ONE), FACTOR_ONE);
            for q in (RATIO_ONE / 4..=2 * RATIO_ONE).step_by(97) {
                let expected = (f64::from(q) / 65536.0).powf(1.0 - m);
                let found = f64::from(law.factor_at(q)) / f64::from(FACTOR_ONE);
                assert!(found <= expected + 1e-6 && found > expected * 0.998, "{q}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn beyond_twice_the_nominal_feed_the_factor_stays() {
        let law = FeedLaw::new(FineOffset::from_bits(1 << 20), 4, 1, Real::ZERO, Real::ZERO, Real::from_int(2));
        assert_eq!(law.factor_at(u32::MAX), 2 * FACTOR_ONE);
        assert_eq!(law.factor_at(0), 0);
    }
}
