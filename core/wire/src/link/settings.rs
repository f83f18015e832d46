//! Settings of the device: those of the rewriter and those of the setpoint link.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::rewrite::{AXES, Settings, SettingsError};

/// What `Configure` sets; kept over resets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceSettings {
    /// Times and limits of the rewriter.
    pub rewriter: Settings,
    /// Axes of a setpoint frame, 1 … 6.
    pub axes: u8,
    /// An answer later than this after the arrival of its frame is withheld, µs, 10 … 1 000 000.
    pub deadline_us: u32,
    /// Without an accepted frame for this time the device goes to `Off`, µs: above the deadline, at least two ticks
    /// more than may be lost, up to 10 000 000.
    pub silence_us: u32,
}

impl DeviceSettings {
    /// 1 kHz, three axes, answers within 500 µs, silence after 20 ms.
    pub const fn at_1_khz() -> Self {
        Self { rewriter: Settings::at_1_khz(), axes: 3, deadline_us: 500, silence_us: 20_000 }
    }

    /// Every range as stated at the fields.
    ///
    /// # Errors
    /// The first value outside its range. Limits that depend on the image are checked when that is activated.
    pub fn check(&self) -> Result<(), DeviceSettingsError> {
        let range = |setting, value: u32, low: u32, high: u32| {
            let good = (low..=high).contains(&value);
            if good { Ok(()) } else { Err(DeviceSettingsError::Range { setting, value, low, high }) }
        };
        range(DeviceSetting::Axes, self.axes.into(), 1, AXES as u32)?;
        range(DeviceSetting::Deadline, self.deadline_us, 10, 1_000_000)?;
        self.rewriter.check().map_err(DeviceSettingsError::Rewriter)?;
        let ticks = self.rewriter.max_lost_frames.saturating_add(2);
        let patience = ticks.saturating_mul(1_000_000).div_ceil(self.rewriter.tick_hz.max(1));
        let least = self.deadline_us.saturating_add(1).max(patience);
        range(DeviceSetting::Silence, self.silence_us, least, 10_000_000)
    }
}

/// A setting of the setpoint link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeviceSetting {
    /// Axes of a setpoint frame.
    Axes,
    /// Deadline of an answer.
    Deadline,
    /// Silence.
    Silence,
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeviceSettingsError {
    /// Those of the rewriter.
    Rewriter(SettingsError),
    /// A value is outside its range.
    Range {
        /// Which one.
        setting: DeviceSetting,
        /// The value.
        value: u32,
        /// Least permitted.
        low: u32,
        /// Greatest permitted.
        high: u32,
    },
}

impl fmt::Display for DeviceSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Axes => "number of axes",
            Self::Deadline => "deadline of an answer (us)",
            Self::Silence => "silence (us)",
        })
    }
}

impl fmt::Display for DeviceSettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rewriter(error) => error.fmt(f),
            Self::Range { setting, value, low, high } => {
                write!(f, "{setting} is {value}, permitted {low} to {high}")
            }
        }
    }
}

impl core::error::Error for DeviceSettingsError {}
