//! What comes in and what goes out, once per tick.

use serde::{Deserialize, Serialize};

use super::frame::AXES;
use super::locate::Place;
use super::{Mode, Reason};

/// Bits that come with a setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Flags(pub u16);

impl Flags {
    /// The drives are enabled.
    pub const DRIVES_ENABLED: Self = Self(1);
    /// The controller is in feed hold, or on the way into it.
    pub const FEED_HOLD: Self = Self(1 << 1);
    /// The spindle load says that the cutter cuts.
    pub const SPINDLE_LOADED: Self = Self(1 << 2);
    /// The program was aborted.
    pub const ABORT: Self = Self(1 << 3);
    /// Emergency stop.
    pub const EMERGENCY_STOP: Self = Self(1 << 4);
    /// The program ended (M2, M30).
    pub const PROGRAM_END: Self = Self(1 << 5);
    /// A tool change is under way.
    pub const TOOL_CHANGE: Self = Self(1 << 6);

    /// Whether any bit of `other` is set.
    #[inline]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
    /// These bits and those of `other`.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// One setpoint of the interpolator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Setpoint {
    /// Commanded positions, machine coordinates, nm.
    pub axes: [i64; AXES],
    /// Spindle speed, thousandths of a revolution per minute.
    pub spindle_millirpm: u32,
    /// Ticks since the spindle speed was measured or commanded.
    pub spindle_age_ticks: u32,
    /// Number of the setpoint, one more each tick, wrapping.
    pub sequence: u32,
    /// Checksum of the frame in force, see [`Frame`](super::Frame).
    pub frame_crc: u32,
    /// Flags.
    pub flags: Flags,
}

/// Bits that go out with a corrected setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Status(pub u16);

impl Status {
    /// The correction of an axis is above the warn level.
    pub const WARN: Self = Self(1);
    /// The clamp cut the correction.
    pub const SATURATED: Self = Self(1 << 1);
    /// The correction is not yet where it should be: its speed or acceleration is limited.
    pub const LAGGING: Self = Self(1 << 2);
    /// The correction is faded: spindle stopped, stale or unloaded, or the feed is outside its window.
    pub const FADED: Self = Self(1 << 3);
    /// A corrected position was held back by a joint limit.
    pub const JOINT_LIMITED: Self = Self(1 << 4);

    /// Whether any bit of `other` is set.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
    #[inline]
    pub(super) const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
    #[inline]
    pub(super) fn set(&mut self, other: Self, on: bool) {
        if on {
            self.0 |= other.0;
        }
    }
}

/// What leaves the rewriter in the same tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Output {
    /// Positions for the drives, machine coordinates, nm; the setpoint itself in `Off`, `Bypass` and `Armed`.
    pub axes: [i64; AXES],
    /// What was added to each axis, nm.
    pub correction_nm: [i32; AXES],
    /// Whether the positions may be sent on. Without it the drive enable is dropped.
    pub forward: bool,
    /// State of the rewriter.
    pub mode: Mode,
    /// Why the last correction ended or failed; stays until the next arming.
    pub reason: Reason,
    /// Warnings.
    pub status: Status,
    /// Place on the path.
    pub place: Place,
    /// Number of the setpoint it belongs to.
    pub sequence: u32,
}

impl Output {
    /// Before the first tick: that of a device in `Off`, at the origin.
    pub const NONE: Self = Self {
        axes: [0; AXES],
        correction_nm: [0; AXES],
        forward: false,
        mode: Mode::Off,
        reason: Reason::None,
        status: Status(0),
        place: Place { node: 0, fraction: 0 },
        sequence: 0,
    };
    /// A measured position with the correction taken out again, for feedback, display and probing.
    #[must_use]
    pub fn uncorrected(&self, measured: &[i64; AXES]) -> [i64; AXES] {
        let mut plain = *measured;
        for (axis, correction) in plain.iter_mut().zip(self.correction_nm) {
            *axis = axis.saturating_sub(correction.into());
        }
        plain
    }
}
