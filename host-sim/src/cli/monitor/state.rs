//! The state of a device in words: what it is called, what goes to the axes, what to do.
//!
//! After `docs/safety.md`. What the device calls Active is shown as Ramp once the correction has ended and is on its way
//! out, and Bypass after a fault says so.

use truepath_core::link::DeviceStatus;
use truepath_core::rewrite::{Mode, Reason};

use super::advice::advice;
use super::theme::Tone;

/// A state as it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The device does not answer.
    Lost,
    Off,
    Pass,
    Armed,
    Active,
    /// A regular end: the correction is on its way out.
    Ramp,
    Hold,
    /// A fault: the correction is on its way out.
    Fault,
}

impl Shown {
    /// Of a mode and why the last correction ended.
    pub const fn of(mode: Mode, reason: Reason) -> Self {
        match (mode, reason) {
            (Mode::Off, _) => Self::Off,
            (Mode::Bypass, _) => Self::Pass,
            (Mode::Armed, _) => Self::Armed,
            (Mode::Active, Reason::None) => Self::Active,
            (Mode::Active, _) => Self::Ramp,
            (Mode::Hold, _) => Self::Hold,
            (Mode::Fault, _) => Self::Fault,
        }
    }
    /// In letters.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Lost => "LOST",
            Self::Off => "OFF",
            Self::Pass => "PASS",
            Self::Armed => "ARMED",
            Self::Active => "ACTIVE",
            Self::Ramp => "RAMP",
            Self::Hold => "HOLD",
            Self::Fault => "FAULT",
        }
    }
    /// In colour.
    pub const fn tone(self) -> Tone {
        match self {
            Self::Lost => Tone::Unknown,
            Self::Off | Self::Pass => Tone::Plain,
            Self::Armed => Tone::Waiting,
            Self::Active => Tone::Good,
            Self::Ramp => Tone::Passing,
            Self::Hold => Tone::Held,
            Self::Fault => Tone::Wrong,
        }
    }
    /// What goes to the drives.
    pub const fn goes_out(self) -> &'static str {
        match self {
            Self::Lost => "No answer: what goes to the drives is not known here.",
            Self::Off => "Nothing goes to the drives; the drive enable is dropped.",
            Self::Pass => "Setpoints pass unchanged.",
            Self::Armed => "Setpoints pass unchanged until the gate of the contour.",
            Self::Active => "Corrected setpoints go to the drives.",
            Self::Ramp => "The correction ramps to zero, then setpoints pass unchanged.",
            Self::Hold => "Corrected setpoints; place and correction are held.",
            Self::Fault => "The correction ramps to zero within its limits.",
        }
    }
    /// Whether a correction is on, so that place and feed are those of this moment.
    pub const fn is_on(self) -> bool {
        matches!(self, Self::Active | Self::Ramp | Self::Hold | Self::Fault)
    }
}

/// What a status is in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InWords {
    /// The state.
    pub shown: Shown,
    /// Its colour: of a fault also after it.
    pub tone: Tone,
    /// Why the last correction ended, if it did.
    pub why: Option<String>,
    /// What the operator should do.
    pub advice: &'static str,
}

impl InWords {
    /// Of a status.
    pub fn of(status: &DeviceStatus) -> Self {
        let shown = Shown::of(status.mode, status.reason);
        let (reason, fault) = (status.reason, status.reason.is_fault());
        let why = (reason != Reason::None)
            .then(|| if fault { format!("FAULT {}: {reason}", reason.code()) } else { format!("Last end: {reason}") });
        let tone = if fault && matches!(shown, Shown::Pass | Shown::Off) { Tone::Wrong } else { shown.tone() };
        let advice = match shown {
            Shown::Lost => "Check cable, port and power of the board.",
            Shown::Off if fault => advice(reason),
            Shown::Off => "Disable the drives; the controller acknowledges that, then setpoints pass.",
            Shown::Pass if fault => advice(reason),
            Shown::Pass if status.active.is_none() => "No image is active: truepath device upload IMAGE --activate.",
            Shown::Pass => "To correct the next part, the operator confirms part and pass at the controller.",
            Shown::Armed => "Start the program from its beginning, with stock on the wall.",
            Shown::Active => "Nothing to do.",
            Shown::Ramp => "Wait; this pass of this part is not armed again.",
            Shown::Hold => "Resume the feed, or end the program. Do not jog.",
            Shown::Fault => advice(reason),
        };
        Self { shown, tone, why, advice }
    }
}
