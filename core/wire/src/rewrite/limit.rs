//! The last gate before the axes: size, speed and acceleration of the correction of one axis, held for any input.
//!
//! Position x and velocity v are whole steps (2⁻⁸ nm, and 2⁻⁸ nm per tick). With the acceleration a, the way made
//! while braking from the velocity v, the move of this tick included, is
//!
//! > S(v) = v + (v − a) + (v − 2a) + … , positive terms only,
//!
//! and `S(v − a) = S(v) − v` exactly. So when a tick moves by a v with S(v) ≤ d, d the distance to the clamp before
//! it, the distance behind it is at least S(v − a): braking by a is again permitted. By induction the rule
//!
//! > v' = wish limited to ±V and to allowed(d), then to v ± a
//!
//! never crosses the clamp, never exceeds V and never changes v by more than a, whatever is asked of it.
//! `allowed(d)` may be anything from 0 to the inverse of S, v = (d + a·n(n − 1)/2)/n with n the ticks of braking. It
//! is read from a table built when the image is loaded: eight samples per octave of d with straight lines between,
//! which lie below the inverse because that is concave. For d ≤ a it is exact: the last piece is made in one tick.
//!
//! To follow a target the velocity of the target itself is asked for, plus what brakes in time on the distance still
//! missing. When nothing limits, the output equals the target to the last bit; half of the way to the clamp that is known without
//! a look at the table, and most ticks end there. Everything is odd in its input, so a
//! mirrored target gives the mirrored output.

use super::SettingsError;
use crate::image::{CorrectionLimits, FineOffset, MAX_CLAMP_NM};
use truepath_units::isqrt_rounded;

/// Samples of the braking table: 8 exact ones, 8 per octave up to 2³², the end; up to 257 the last one is repeated, so
/// that a byte is an index with a successor.
const SAMPLES: usize = 257;
/// The one that stands for 2³².
const LAST_SAMPLE: usize = 240;
/// No step may be larger, so that sums of three stay within 32 bits.
const LARGEST_STEP: i64 = 1 << 29;

/// Limits per tick, the same for every axis, with the braking table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    clamp: i32,
    velocity: i32,
    acceleration: i32,
    /// Where and how fast a target is followed without a look at the clamp.
    free: Free,
    ramp_ticks: u32,
    allowed: [u32; SAMPLES],
}

/// Places so far from the clamp, on either side, that the table allows a velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Free {
    velocity: i32,
    /// The places from −`reach` on, so many of them.
    reach: i32,
    places: u32,
}

/// Correction of one axis with its velocity and the target of the tick before, steps of 2⁻⁸ nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AxisState {
    position: i32,
    velocity: i32,
    target: i32,
}

impl AxisState {
    /// A correction that stands.
    pub const fn at_rest(correction: FineOffset) -> Self {
        Self { position: correction.bits(), velocity: 0, target: correction.bits() }
    }
    /// The correction.
    pub const fn correction(&self) -> FineOffset {
        FineOffset::from_bits(self.position)
    }
    /// Its change in the last tick.
    pub const fn velocity(&self) -> FineOffset {
        FineOffset::from_bits(self.velocity)
    }
    /// Whether nothing is left of the correction.
    #[inline]
    pub const fn is_at_rest_at_zero(&self) -> bool {
        self.position == 0 && self.velocity == 0
    }
    /// Whether the correction is what was asked for.
    #[inline]
    pub const fn is_on_target(&self) -> bool {
        self.position == self.target
    }
}

impl Limits {
    /// Limits per tick from limits per second, rounded down.
    ///
    /// # Errors
    /// The tick rate is so high that a limit vanishes, or so low that a step is not small.
    pub fn new(limits: &CorrectionLimits, tick_hz: u32) -> Result<Self, SettingsError> {
        let clamp = limits.clamp.nm().clamp(0, MAX_CLAMP_NM) << FineOffset::FRACTION_BITS;
        let hz = u128::from(tick_hz.max(1));
        let per_tick = |value: u128, divisor: u128| {
            let fine = (value << FineOffset::FRACTION_BITS).checked_div(divisor).unwrap_or(0);
            i64::try_from(fine).unwrap_or(i64::MAX)
        };
        let velocity = per_tick(limits.slew_nm_per_s.into(), hz);
        let acceleration = per_tick(limits.acceleration_nm_per_s2.into(), hz.saturating_mul(hz));
        if velocity < 1 || acceleration < 1 {
            return Err(SettingsError::LimitVanishes { velocity, acceleration });
        }
        // Larger ones would not limit: the whole clamp is crossed in a few ticks.
        let velocity = velocity.min(LARGEST_STEP) as i32;
        let acceleration = acceleration.min(LARGEST_STEP) as i32;
        let mut allowed = [0; SAMPLES];
        for (index, entry) in allowed.iter_mut().enumerate() {
            *entry = braking_velocity(sample(index.min(LAST_SAMPLE)), acceleration).min(velocity.unsigned_abs());
        }
        let mut made =
            Self { clamp: clamp as i32, velocity, acceleration, free: Free::default(), ramp_ticks: 0, allowed };
        made.free = made.freely();
        made.ramp_ticks = made.longest_ramp();
        Ok(made)
    }

    /// Largest correction.
    pub const fn clamp(&self) -> FineOffset {
        FineOffset::from_bits(self.clamp)
    }
    /// Largest change of the correction in a tick.
    pub const fn velocity(&self) -> FineOffset {
        FineOffset::from_bits(self.velocity)
    }
    /// Largest change of that change in a tick.
    pub const fn acceleration(&self) -> FineOffset {
        FineOffset::from_bits(self.acceleration)
    }
    /// Ticks within which any correction has ramped to zero and stands.
    pub const fn ramp_ticks(&self) -> u32 {
        self.ramp_ticks
    }

    /// Moves one axis towards a target by one tick; says whether the clamp cut the target by more than the rounding
    /// of a rotation.
    #[inline]
    pub fn step(&self, axis: &mut AxisState, target: i32) -> bool {
        // On the target, and nothing limits: it is followed, which is what the rule comes to.
        let follow = target.wrapping_sub(axis.position);
        if axis.target == axis.position
            && (axis.position.wrapping_add(self.free.reach) as u32) < self.free.places
            && is_within(follow, self.free.velocity)
            && is_within(follow.wrapping_sub(axis.velocity), self.acceleration)
        {
            *axis = AxisState { position: target, velocity: follow, target };
            return false;
        }
        self.limited(axis, target)
    }

    /// The rule, wherever the axis is and whatever is asked of it.
    #[inline(always)]
    fn limited(&self, axis: &mut AxisState, target: i32) -> bool {
        let (v, a) = (self.velocity, self.acceleration);
        let goal = within(target, self.clamp);
        // In range: clamp < 2³⁰, so differences of two places are below 2³¹.
        let missing = axis.target.wrapping_sub(axis.position);
        let approach = if missing == 0 {
            0
        } else {
            let sign = missing >> 31;
            let away = (missing ^ sign).wrapping_sub(sign);
            (away.min(self.braking(away.unsigned_abs())) ^ sign).wrapping_sub(sign)
        };
        let wish = within(goal.wrapping_sub(axis.target), v).wrapping_add(approach);
        // The table ends at ±V, so this is also the limit of speed.
        let wish = if wish >= 0 {
            let room = self.clamp.wrapping_sub(axis.position).max(0).unsigned_abs();
            wish.min(self.braking(room))
        } else {
            let room = self.clamp.wrapping_add(axis.position).max(0).unsigned_abs();
            wish.max(self.braking(room).wrapping_neg())
        };
        let velocity = wish.max(axis.velocity.wrapping_sub(a)).min(axis.velocity.wrapping_add(a));
        axis.velocity = velocity;
        axis.position = axis.position.wrapping_add(velocity);
        axis.target = goal;
        // −2 … 2, as one question.
        target.wrapping_sub(goal).wrapping_add(2) as u32 > 4
    }

    /// The table, interpolated: at most the velocity from which braking needs the distance.
    #[inline(always)]
    fn braking(&self, distance: u32) -> i32 {
        if distance < 8 {
            return self.allowed.get(distance as usize).copied().unwrap_or(0) as i32;
        }
        // Octave 3…31 and the next three bits give the sample, the others how far to the next one, units of 2⁻³².
        let above = distance.leading_zeros();
        let mantissa = distance.wrapping_shl(above);
        let index = (28u32.wrapping_sub(above) << 3).wrapping_add(mantissa >> 28) as usize & 0xFF;
        let low = self.allowed.get(index).copied().unwrap_or(0);
        let high = self.allowed.get(index.wrapping_add(1)).copied().unwrap_or(0);
        // Rounded down: the line must stay below the root.
        let rise = u64::from(high.wrapping_sub(low)).wrapping_mul(u64::from(mantissa << 4)) >> 32;
        low.wrapping_add(rise as u32) as i32
    }

    /// As fast as any, if that leaves half of the way to the clamp or more; else what half of the way allows.
    fn freely(&self) -> Free {
        let clamp = self.clamp.unsigned_abs();
        let half = (0..=LAST_SAMPLE).rev().find(|&i| sample(i) <= u64::from(clamp >> 1)).unwrap_or(0);
        let allowed = |i: usize| self.allowed.get(i).copied().unwrap_or(0);
        let enough = (0..half).find(|&i| allowed(i) == allowed(half)).unwrap_or(half);
        let reach = clamp.saturating_sub(sample(enough) as u32);
        let places = reach.wrapping_shl(1).wrapping_add(1);
        Free { velocity: allowed(enough) as i32, reach: reach as i32, places }
    }

    /// Stop, turn, cross the clamp, brake: V/a three times with a fourth for the lines below the root, clamp/V, and
    /// a few ticks of rounding.
    fn longest_ramp(&self) -> u32 {
        let top = self.braking(self.clamp.unsigned_abs()).max(1).unsigned_abs();
        let cross = self.clamp.unsigned_abs().checked_div(top).unwrap_or(0);
        let speed_up = top.checked_div(self.acceleration.unsigned_abs()).unwrap_or(0);
        cross.saturating_add(speed_up.saturating_mul(4)).saturating_add(16)
    }
}

/// A value limited to ± a magnitude. (`clamp` would carry a panic.)
#[inline]
fn within(value: i32, magnitude: i32) -> i32 {
    value.min(magnitude).max(magnitude.wrapping_neg())
}

/// Whether a value is within ± a magnitude, 0…2³⁰.
#[inline(always)]
fn is_within(value: i32, magnitude: i32) -> bool {
    value.wrapping_add(magnitude) as u32 <= (magnitude as u32).wrapping_shl(1)
}

/// The distance a sample of the table stands for.
fn sample(index: usize) -> u64 {
    let index = index as u64;
    if index < 8 { index } else { (8 | (index & 7)) << (index >> 3).saturating_sub(1) }
}

/// The largest v with S(v) ≤ d: n is the number of ticks with a·n(n − 1)/2 < d ≤ a·n(n + 1)/2.
fn braking_velocity(distance: u64, acceleration: i32) -> u32 {
    let a = u64::from(acceleration.unsigned_abs()).max(1);
    let whole = |n: u64| a.saturating_mul(n.saturating_mul(n.saturating_sub(1)) >> 1);
    // √(2d/a), rounded, is n, or one less where the division has dropped a rest.
    let root = isqrt_rounded(u128::from(distance.saturating_mul(2).checked_div(a).unwrap_or(0))) as u64;
    let more = root.saturating_add(1);
    let n = if whole(more) < distance { more } else { root };
    let velocity = distance.saturating_add(whole(n)).checked_div(n).unwrap_or(0);
    u32::try_from(velocity).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests;
