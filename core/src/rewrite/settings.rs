//! What a rewriter is told once, apart from its image.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::frame::AXES;
use crate::units::Offset;

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
}

impl Settings {
    /// 1 kHz, 1 mm per tick, two lost frames, hold after 20 ms, spindle stale after 100 ms, fade in 250 ms, smoothing
    /// over 16 ms, no load input, no joint limits.
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
        }
    }

    /// Every range as stated at the fields.
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        let range = |name, value: i64, low: i64, high: i64| {
            if (low..=high).contains(&value) { Ok(()) } else { Err(SettingsError::Range { name, value, low, high }) }
        };
        range(Setting::TickRate, self.tick_hz.into(), 10, 100_000)?;
        range(Setting::LargestStep, self.max_step.nm(), 1, 8_000_000)?;
        range(Setting::LostFrames, self.max_lost_frames.into(), 0, 16)?;
        range(Setting::HoldAfter, self.hold_after_ticks.into(), 2, 1 << 31)?;
        range(Setting::Fade, self.fade_ticks.into(), 1, 65_536)?;
        range(Setting::FeedSmoothing, self.feed_smoothing.into(), 0, 12)?;
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
