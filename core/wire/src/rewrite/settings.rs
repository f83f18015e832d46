//! What a rewriter is told once, apart from its image.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::frame::AXES;
use crate::image::CorrectionLimits;
use truepath_units::Offset;

/// Times and limits of the machine the rewriter sits in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// Setpoints per second, 10 … 100 000. Limits per second become limits per tick by it; the link refuses setpoints
    /// that come more than half as fast again.
    pub tick_hz: u32,
    /// Greatest change of a setpoint in X or Y per tick while a correction is on; rapids are faster. 1 nm … 8 mm.
    pub max_step: Offset,
    /// Frames that may be missing in a row while a correction is on, 0 … 16.
    pub max_lost_frames: u32,
    /// Ticks of standstill after which the place is held without a feed-hold flag, 2 … 2³¹.
    pub hold_after_ticks: u32,
    /// Age of the spindle speed, in ticks, from which it is stale.
    pub spindle_stale_ticks: u32,
    /// Ticks in which the fade goes from full to none and back, 1 … 65 536.
    pub fade_ticks: u32,
    /// The live feed is smoothed over 2ᵏ ticks, k = 0 … 12.
    pub feed_smoothing: u32,
    /// Whether the correction fades out when the cutter moves in the pass and the setpoint does not say that the spindle
    /// is loaded.
    pub require_spindle_load: bool,
    /// Least and greatest position of each axis, nm. A correction that would carry an axis over one is a fault, and
    /// until it has ramped out the position is held at the limit, which goes before the limits of speed.
    pub joint_limits_nm: [(i64, i64); AXES],
    /// Velocity that the machine leaves to a correction, nm/s, 1 … 2³² − 1; the lower of it and the image's counts.
    /// [`NO_VELOCITY_CAP`] leaves it to the image.
    pub correction_slew_nm_per_s: u32,
    /// Acceleration that the machine leaves to a correction, nm/s², 1 … 10¹²; the lower of it and the image's counts.
    /// [`NO_ACCELERATION_CAP`] leaves it to the image.
    pub correction_acceleration_nm_per_s2: u64,
}

/// Largest [`Settings::max_step`], nm.
const LARGEST_STEP_NM: i64 = 8_000_000;
/// Least [`Settings::hold_after_ticks`].
const SHORTEST_HOLD: u32 = 2;
/// Largest [`Settings::fade_ticks`].
const LONGEST_FADE: u32 = 65_536;
/// Largest [`Settings::feed_smoothing`].
const MOST_SMOOTHING: u32 = 12;
/// Above every velocity of an image.
pub const NO_VELOCITY_CAP: u32 = u32::MAX;
/// The highest acceleration of an image.
pub const NO_ACCELERATION_CAP: u64 = 1_000_000_000_000;

impl Settings {
    /// 1 kHz, 1 mm per tick, two lost frames, hold after 20 ms, spindle stale after 100 ms, fade in 250 ms, smoothing
    /// over 16 ms, no load input, no joint limits, no caps.
    pub const fn at_1_khz() -> Self {
        Self {
            tick_hz: 1_000,
            max_step: Offset::from_um(1_000),
            max_lost_frames: 2,
            hold_after_ticks: 20,
            spindle_stale_ticks: 100,
            fade_ticks: 250,
            feed_smoothing: 4,
            require_spindle_load: false,
            joint_limits_nm: [(i64::MIN, i64::MAX); AXES],
            correction_slew_nm_per_s: NO_VELOCITY_CAP,
            correction_acceleration_nm_per_s2: NO_ACCELERATION_CAP,
        }
    }

    /// [`Settings::at_1_khz`] with the same times at another rate, and steps of 1 m/s; ranges are checked when a
    /// rewriter is made.
    pub fn at_rate(tick_hz: u32) -> Self {
        let slow = Self::at_1_khz();
        let hz = u64::from(tick_hz);
        let ticks = |at_1_khz: u32| {
            let scaled = u64::from(at_1_khz).saturating_mul(hz).div_ceil(u64::from(slow.tick_hz));
            u32::try_from(scaled).unwrap_or(u32::MAX).max(1)
        };
        let step = slow.max_step.nm().saturating_mul(slow.tick_hz.into()).checked_div(hz.cast_signed()).unwrap_or(0);
        Self {
            tick_hz,
            max_step: Offset::from_nm(step.clamp(1, LARGEST_STEP_NM)),
            hold_after_ticks: ticks(slow.hold_after_ticks).max(SHORTEST_HOLD),
            spindle_stale_ticks: ticks(slow.spindle_stale_ticks),
            fade_ticks: ticks(slow.fade_ticks).min(LONGEST_FADE),
            feed_smoothing: ticks(1 << slow.feed_smoothing).ilog2().min(MOST_SMOOTHING),
            ..slow
        }
    }

    /// The limits of an image with the caps of the machine.
    pub(super) fn capped(&self, image: &CorrectionLimits) -> CorrectionLimits {
        CorrectionLimits {
            slew_nm_per_s: image.slew_nm_per_s.min(self.correction_slew_nm_per_s),
            acceleration_nm_per_s2: image.acceleration_nm_per_s2.min(self.correction_acceleration_nm_per_s2),
            ..*image
        }
    }

    /// Every range as stated at the fields.
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let range = |name, value: i64, low: i64, high: i64| {
            if (low..=high).contains(&value) { Ok(()) } else { Err(SettingsError::Range { name, value, low, high }) }
        };
        range(Setting::TickRate, self.tick_hz.into(), 10, 100_000)?;
        range(Setting::LargestStep, self.max_step.nm(), 1, LARGEST_STEP_NM)?;
        range(Setting::LostFrames, self.max_lost_frames.into(), 0, 16)?;
        range(Setting::HoldAfter, self.hold_after_ticks.into(), SHORTEST_HOLD.into(), 1 << 31)?;
        range(Setting::Fade, self.fade_ticks.into(), 1, LONGEST_FADE.into())?;
        range(Setting::FeedSmoothing, self.feed_smoothing.into(), 0, MOST_SMOOTHING.into())?;
        range(Setting::CorrectionVelocity, self.correction_slew_nm_per_s.into(), 1, NO_VELOCITY_CAP.into())?;
        let acceleration = i64::try_from(self.correction_acceleration_nm_per_s2).unwrap_or(i64::MAX);
        range(Setting::CorrectionAcceleration, acceleration, 1, NO_ACCELERATION_CAP.cast_signed())?;
        for (axis, (low, high)) in self.joint_limits_nm.iter().enumerate() {
            if low > high {
                return Err(SettingsError::JointLimits { axis });
            }
        }
        Ok(())
    }
}

/// A setting with a range. Its sentence gives name and unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Setting {
    /// [`Settings::tick_hz`].
    TickRate,
    /// [`Settings::max_step`].
    LargestStep,
    /// [`Settings::max_lost_frames`].
    LostFrames,
    /// [`Settings::hold_after_ticks`].
    HoldAfter,
    /// [`Settings::fade_ticks`].
    Fade,
    /// [`Settings::feed_smoothing`].
    FeedSmoothing,
    /// [`Settings::correction_slew_nm_per_s`].
    CorrectionVelocity,
    /// [`Settings::correction_acceleration_nm_per_s2`].
    CorrectionAcceleration,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TickRate => "tick rate (Hz)",
            Self::LargestStep => "largest step (nm)",
            Self::LostFrames => "lost frames",
            Self::HoldAfter => "hold after (ticks)",
            Self::Fade => "fade (ticks)",
            Self::FeedSmoothing => "feed smoothing (binary logarithm of ticks)",
            Self::CorrectionVelocity => "velocity of the correction (nm/s)",
            Self::CorrectionAcceleration => "acceleration of the correction (nm/s2)",
        })
    }
}

/// Why a rewriter cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SettingsError {
    /// A value is outside its range.
    Range {
        /// Name and unit.
        name: Setting,
        /// The value.
        value: i64,
        /// Least permitted.
        low: i64,
        /// Greatest permitted.
        high: i64,
    },
    /// The lower joint limit of an axis is above the upper one.
    JointLimits {
        /// Index of the axis.
        axis: usize,
    },
    /// At this tick rate a limit of the correction is less than the smallest step.
    LimitVanishes {
        /// Velocity limit, 2⁻⁸ nm per tick.
        velocity: i64,
        /// Acceleration limit, 2⁻⁸ nm per tick².
        acceleration: i64,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Range { name, value, low, high } => write!(f, "{name} is {value}, permitted {low} to {high}"),
            Self::JointLimits { axis } => write!(f, "the lower limit of axis {axis} is above the upper one"),
            Self::LimitVanishes { velocity, acceleration } => write!(
                f,
                "at this tick rate the correction could not move: {velocity}/256 nm per tick, {acceleration}/256 nm per tick per tick"
            ),
        }
    }
}

impl core::error::Error for SettingsError {}
