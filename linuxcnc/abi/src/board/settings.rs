//! What the controller's end is told once.

use core::fmt;

use truepath_core::image::{CorrectionLimits, MAX_CLAMP_NM};
use truepath_core::rewrite::{AXES, SettingsError};
use truepath_core::units::Offset;

/// Limits of the machine for what comes from the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardSettings {
    /// Axes of a frame, 1 … 6; that of the board's settings.
    pub axes: u8,
    /// Ticks per second, 10 … 100 000.
    pub tick_hz: u32,
    /// A larger correction is not taken, nm, 1 … 4 000 000.
    pub clamp_nm: i32,
    /// Largest speed of the correction that the machine has left, nm/s, not 0.
    pub slew_nm_per_s: u32,
    /// Largest acceleration that it has left, nm/s², 1 … 10¹².
    pub acceleration_nm_per_s2: u64,
    /// Least and greatest position of each axis, nm: no correction carries an axis over one.
    pub joint_limits_nm: [(i64, i64); AXES],
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardSettingsError {
    /// The number of axes is not 1 … 6.
    Axes(u8),
    /// The tick rate is not 10 … 100 000 Hz.
    TickRate(u32),
    /// The clamp is not 1 nm … 4 mm.
    Clamp(i32),
    /// A limit of speed or acceleration is 0 or above its range.
    Caps,
    /// The lower limit of an axis is above the upper one.
    JointLimits {
        /// Index of the axis.
        axis: usize,
    },
    /// At this tick rate the correction could not move.
    Limits(SettingsError),
}

impl BoardSettings {
    /// Every range as stated at the fields; gives the limits as the limiter takes them.
    ///
    /// # Errors
    /// The first value outside its range.
    pub(super) fn checked(&self) -> Result<CorrectionLimits, BoardSettingsError> {
        if !(1..=AXES as u8).contains(&self.axes) {
            return Err(BoardSettingsError::Axes(self.axes));
        }
        if !(10..=100_000).contains(&self.tick_hz) {
            return Err(BoardSettingsError::TickRate(self.tick_hz));
        }
        if !(1..=MAX_CLAMP_NM).contains(&i64::from(self.clamp_nm)) {
            return Err(BoardSettingsError::Clamp(self.clamp_nm));
        }
        let speed = self.slew_nm_per_s > 0;
        let acceleration = (1..=1_000_000_000_000).contains(&self.acceleration_nm_per_s2);
        if !speed || !acceleration {
            return Err(BoardSettingsError::Caps);
        }
        if let Some(axis) = self.joint_limits_nm.iter().position(|(low, high)| low > high) {
            return Err(BoardSettingsError::JointLimits { axis });
        }
        Ok(self.limits())
    }

    /// The limits of the limiter, with room for what whole nanometres make of a correction that the board limited in
    /// finer steps: ±1 nm a tick in speed, ±2 nm a tick in its change, and a clamp that is not braked for.
    fn limits(&self) -> CorrectionLimits {
        let hz = self.tick_hz;
        let rounding = u64::from(hz).saturating_mul(hz.into()).saturating_mul(2);
        let clamp = i64::from(self.clamp_nm).saturating_mul(2).min(MAX_CLAMP_NM);
        CorrectionLimits {
            clamp: Offset::from_nm(clamp),
            warn: Offset::from_nm(clamp),
            slew_nm_per_s: self.slew_nm_per_s.saturating_add(hz),
            acceleration_nm_per_s2: self.acceleration_nm_per_s2.saturating_add(rounding),
        }
    }
}

impl fmt::Display for BoardSettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axes(axes) => write!(f, "{axes} axes in a frame, permitted 1 to 6"),
            Self::TickRate(hz) => write!(f, "{hz} ticks per second, permitted 10 to 100000"),
            Self::Clamp(nm) => write!(f, "clamp of {nm} nm, permitted 1 to {MAX_CLAMP_NM}"),
            Self::Caps => f.write_str("the machine leaves no speed or acceleration to the correction, or too much"),
            Self::JointLimits { axis } => write!(f, "the lower limit of axis {axis} is above the upper one"),
            Self::Limits(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BoardSettingsError {}
