//! The live feed per tooth as a ratio to the nominal one, without a division.
//!
//! ratio = (way per tick · ticks per minute) / (spindle speed · teeth · f₀). All but the way and the spindle speed is
//! one constant, prepared when the image is loaded; the reciprocal of the spindle speed comes from a table of 64
//! starting values and two Newton steps, good to 2⁻²⁷. The ratio is smoothed over 2ᵏ ticks, because a way of whole
//! nanometres per tick is a coarse measure of speed, and a ratio within 2⁻¹² of 1 counts as 1, so that this
//! quantisation leaves no trace in the correction (cost: 0.02 % of the chip part elsewhere).

use crate::image::{FeedLaw, FineOffset, RATIO_BITS, RATIO_ONE};
use truepath_units::shift_rounded_i31;

/// Fraction bits of the smoothed ratio.
const SMOOTH_BITS: u32 = 24;
/// The largest ratio that is told apart, units of 2⁻²⁴: 4.
const MOST: u32 = 4 << SMOOTH_BITS;
/// Ratios this near to 1 are 1, units of 2⁻¹⁶.
const DEAD_BAND: i32 = 1 << (RATIO_BITS - 12);

/// Constant of the feed: the spindle speed, in thousandths of a revolution per minute, at which a way of one
/// nanometre per tick is the nominal feed per tooth; as `mantissa · 2^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FeedScale {
    mantissa: u32,
    exponent: i32,
}

/// The smoothed ratio of live to nominal feed, units of 2⁻²⁴.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct FeedRatio(i32);

impl Default for FeedRatio {
    /// The nominal feed, until the first motion along the path.
    fn default() -> Self {
        Self(1 << SMOOTH_BITS)
    }
}

impl FeedScale {
    /// 60 000 · ticks per second / (teeth · f₀).
    pub fn new(law: &FeedLaw, tick_hz: u32) -> Self {
        let per_turn = u128::from(law.teeth).saturating_mul(u128::from(law.per_tooth.bits().unsigned_abs())).max(1);
        let numerator = u128::from(tick_hz).saturating_mul(60_000 << FineOffset::FRACTION_BITS);
        let wide = (numerator << 64).checked_div(per_turn).unwrap_or(0).max(1 << 32);
        let bits = 128u32.saturating_sub(wide.leading_zeros());
        let drop = bits.saturating_sub(32);
        Self { mantissa: (wide >> drop) as u32, exponent: (drop as i32).saturating_sub(64) }
    }

    /// The ratio of one tick, units of 2⁻²⁴, at most 4. `way_nm` < 2²³; `millirpm` > 0.
    #[inline]
    fn ratio(self, way_nm: u32, millirpm: u32) -> u32 {
        let (reciprocal, shift) = reciprocal(millirpm);
        let speed = high_word(way_nm << 8, self.mantissa);
        // value = speed · reciprocal · 2^(exponent + 32 − 8 + shift − 62) = speed · reciprocal · 2^(left − 36)
        let left = self.exponent.wrapping_add(22).wrapping_add(shift as i32);
        if left >= 0 {
            // A speed that leaves its word is a ratio above 2³² · 2³⁰ / 2³⁶.
            if speed.leading_zeros() < left.unsigned_abs() {
                return if speed == 0 { 0 } else { MOST };
            }
            // The low word does not reach the rounding. The high word is below 2³¹.
            let high = high_word(speed.wrapping_shl(left.unsigned_abs()), reciprocal);
            (high.wrapping_add(8) >> 4).min(MOST)
        } else {
            let (high, drop) = (high_word(speed, reciprocal), 4u32.wrapping_add(left.unsigned_abs()).min(31));
            (high.wrapping_add(1u32.wrapping_shl(drop) >> 1).wrapping_shr(drop)).min(MOST)
        }
    }
}

impl FeedRatio {
    /// Takes in the way along the path of one tick. A way backwards counts as none.
    #[inline(always)]
    pub fn update(&mut self, scale: FeedScale, way_nm: i32, millirpm: u32, smoothing: u32) {
        if millirpm == 0 {
            return;
        }
        let way = way_nm.clamp(0, (1 << 23) - 1) as u32;
        let away = (scale.ratio(way, millirpm) as i32).wrapping_sub(self.0);
        let change = if smoothing == 0 { away } else { shift_rounded_i31(away, smoothing) };
        self.0 = self.0.wrapping_add(change);
    }

    /// The ratio, units of 2⁻¹⁶, with the dead band about 1.
    #[inline]
    pub fn value(self) -> u32 {
        let one = RATIO_ONE as i32;
        let away = shift_rounded_i31(self.0, SMOOTH_BITS - RATIO_BITS).wrapping_sub(one);
        let beyond = away.wrapping_sub(away.min(DEAD_BAND).max(DEAD_BAND.wrapping_neg()));
        one.wrapping_add(beyond).unsigned_abs()
    }
}

/// 2⁶²/m at the middle of each of 64 equal parts of m = 2³¹…2³², the starting values.
static START: [u32; 64] = start();

#[expect(clippy::arithmetic_side_effects, clippy::indexing_slicing, reason = "evaluated by the compiler only")]
const fn start() -> [u32; 64] {
    let mut table = [0; 64];
    let mut k = 0;
    while k < 64 {
        let middle = (1u64 << 31) + ((k as u64) << 25) + (1 << 24);
        table[k] = ((1u64 << 62) / middle) as u32;
        k += 1;
    }
    table
}

/// (y, s) with 1/value = y · 2^(s − 62), y below 2³¹, relative error below 2⁻²⁷; value > 0.
#[inline]
fn reciprocal(value: u32) -> (u32, u32) {
    let shift = value.leading_zeros();
    let mantissa = value.wrapping_shl(shift);
    let mut y = START.get((mantissa >> 25 & 63) as usize).copied().unwrap_or(0);
    let times = |a: u32, b: u32| (u64::from(a).wrapping_mul(u64::from(b)) >> 31) as u32;
    for _ in 0..2 {
        // y·(2 − m·y), m·y near 1 as units of 2⁻³¹; rounded down, so y stays below 2³¹.
        y = times(y, times(mantissa, y).wrapping_neg());
    }
    (y, shift)
}

/// The high word of a product.
#[inline]
fn high_word(a: u32, b: u32) -> u32 {
    (u64::from(a).wrapping_mul(u64::from(b)) >> 32) as u32
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
    use super::*;
    use truepath_units::Real;

    #[test]
    fn the_reciprocal_is_good_to_27_bits_over_the_whole_range() {
        let mut value = 1u64;
        while value <= u64::from(u32::MAX) {
            for v in [value as u32, (value as u32).saturating_sub(1).max(1)] {
                let (y, s) = reciprocal(v);
                let found = f64::from(y) * 2f64.powi(s as i32 - 62) * f64::from(v);
                assert!((found - 1.0).abs() < 2f64.powi(-27), "1/{v}: {found}");
                assert!(y <= 1 << 31);
            }
            value += value / 997 + 1;
        }
    }

    fn law(per_tooth_nm: i32, teeth: u32) -> FeedLaw {
        let f = FineOffset::from_bits(per_tooth_nm << 8);
        FeedLaw::new(f, teeth, 0, Real::ZERO, Real::ZERO, Real::from_int(2))
    }

    #[test]
    fn the_ratio_is_the_feed_per_tooth_over_the_nominal_one() {
        for (nm, teeth, hz) in [(44_444, 6, 1_000), (5_000, 1, 20_000), (800_000, 8, 100), (1_000, 2, 400)] {
            let scale = FeedScale::new(&law(nm, teeth), hz);
            for millirpm in [60_000u32, 999_999, 1_500_000, 24_000_000, 90_000_000] {
                for way in [3u32, 611, 6_667, 123_456, 8_000_000] {
                    let turns_per_tick = f64::from(millirpm) / 60_000.0 / f64::from(hz);
                    let expected = f64::from(way) / (turns_per_tick * f64::from(teeth) * f64::from(nm));
                    let found = scale.ratio(way, millirpm) as f64 / f64::from(1 << SMOOTH_BITS);
                    // The way carries 8 more bits, of which one may be lost in the high word.
                    let tolerance = expected * (2e-6 + 1.0 / (128.0 * f64::from(way))) + 2e-7;
                    assert!(
                        (found - expected.min(4.0)).abs() <= tolerance,
                        "{nm} {teeth} {hz} {way} {millirpm}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_ratio_is_rounded_to_the_nearest_step_and_ends_at_four() {
        // Long ways, whose own rounding counts for less than a step, at ratios from a sixteenth to eight.
        let scale = FeedScale::new(&law(800_000, 2), 100);
        for millirpm in [30_000u32, 60_000, 200_001, 1_500_000, 7_000_003] {
            for way in (1_000_000u32..8_000_000).step_by(50_021) {
                let turns_per_tick = f64::from(millirpm) / 60_000.0 / 100.0;
                let expected = f64::from(way) / (turns_per_tick * 2.0 * 800_000.0) * f64::from(1 << SMOOTH_BITS);
                let found = f64::from(scale.ratio(way, millirpm));
                let steps = (found - expected.min(f64::from(MOST))).abs();
                // Half a step, and what the reciprocal is short of.
                assert!(steps <= 0.5 + expected * 2f64.powi(-27), "{way} {millirpm}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_slow_spindle_gives_every_ratio_up_to_four_and_four_beyond() {
        // A small feed at a fast tick: the spindle's part of the ratio is large.
        let scale = FeedScale::new(&law(5_000, 1), 20_000);
        for millirpm in [1_000u32, 20_000, 60_000, 500_000] {
            for way in 0..500u32 {
                let turns_per_tick = f64::from(millirpm) / 60_000.0 / 20_000.0;
                let expected = f64::from(way) / (turns_per_tick * 5_000.0);
                let found = scale.ratio(way, millirpm) as f64 / f64::from(1 << SMOOTH_BITS);
                // As above, where the word of the speed is full: one bit of the way's eight.
                let tolerance = expected * (2e-6 + 1.0 / (128.0 * f64::from(way.max(1)))) + 2e-7;
                assert!((found - expected.min(4.0)).abs() <= tolerance, "{way} {millirpm}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_ratio_within_the_dead_band_is_one_and_beyond_it_continues_from_there() {
        let value = |away: i32| FeedRatio((1 << SMOOTH_BITS) + away).value();
        let band = 1 << (SMOOTH_BITS - 12);
        let step = 1 << (SMOOTH_BITS - RATIO_BITS);
        for away in [-band, -1, 0, 1, band] {
            assert_eq!(value(away), RATIO_ONE);
        }
        for steps in [1, 2, 1_000] {
            assert_eq!(value(band + steps * step), RATIO_ONE + steps as u32);
            assert_eq!(value(-band - steps * step), RATIO_ONE - steps as u32);
        }
    }

    #[test]
    fn smoothing_over_so_many_ticks_takes_in_that_part_of_a_change() {
        let scale = FeedScale::new(&law(44_444, 6), 1_000);
        let change = |smoothing| {
            let mut ratio = FeedRatio::default();
            ratio.update(scale, 3_333, 1_500_000, smoothing);
            (1 << SMOOTH_BITS) - ratio.0
        };
        let whole = change(0);
        assert!((whole - (1 << 23)).abs() < 1 << 11, "{whole}");
        for smoothing in 1..=12 {
            assert!((change(smoothing) - (whole >> smoothing)).abs() <= 1, "{smoothing}");
        }
    }

    #[test]
    fn a_way_beyond_its_range_counts_as_the_longest_and_one_back_as_none() {
        let scale = FeedScale::new(&law(800_000, 8), 100);
        let taken = |way| {
            let mut ratio = FeedRatio::default();
            ratio.update(scale, way, 6_000_000, 0);
            ratio
        };
        let longest = (1 << 23) - 1;
        assert_ne!(taken(longest), taken(longest - 2));
        assert!([longest + 1, longest + 2, 1 << 24, i32::MAX].iter().all(|&way| taken(way) == taken(longest)));
        assert!([-1, -6_667, i32::MIN].iter().all(|&way| taken(way) == FeedRatio(0)));
    }

    #[test]
    fn alternating_whole_nanometres_count_as_the_nominal_feed() {
        // 400 mm/min at 1 kHz is 6666.67 nm per tick.
        let scale = FeedScale::new(&law(44_444, 6), 1_000);
        let mut ratio = FeedRatio::default();
        for tick in 0..10_000 {
            ratio.update(scale, if tick % 3 == 0 { 6_666 } else { 6_667 }, 1_500_000, 5);
            assert_eq!(ratio.value(), RATIO_ONE, "tick {tick}");
        }
        ratio.update(scale, i32::MAX, 1, 5);
        ratio.update(scale, i32::MIN, u32::MAX, 5);
        ratio.update(scale, 5, 0, 5);
        assert!(ratio.value() <= 4 * RATIO_ONE);
    }

    #[test]
    fn the_smoothed_ratio_arrives_at_a_new_feed() {
        let scale = FeedScale::new(&law(44_444, 6), 1_000);
        let mut ratio = FeedRatio::default();
        for _ in 0..400 {
            ratio.update(scale, 3_333, 1_500_000, 4);
        }
        assert!((i64::from(ratio.value()) - 32_767).abs() < 25, "{}", ratio.value());
    }
}
