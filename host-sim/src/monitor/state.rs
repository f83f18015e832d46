//! The state of a device in words: what it is called, what goes to the axes, what to do.
//!
//! After `docs/safety.md`. What the device calls Active is shown as Ramp once the correction has ended and is on its way
//! out, and Bypass after a fault says so.

use truepath_core::link::DeviceStatus;
use truepath_core::rewrite::{Mode, Reason, Status};

use super::advice::{advice, while_active, while_off};
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
            Self::Pass => "Setpoints pass unchanged: nothing is corrected.",
            Self::Armed => "Setpoints pass unchanged until the gate of the contour.",
            Self::Active => "Corrected setpoints go to the drives.",
            Self::Ramp => "Correction ramps to zero, then setpoints pass unchanged.",
            Self::Hold => "Corrected setpoints; place and correction are held.",
            Self::Fault => "Correction ramps to zero, then setpoints pass unchanged.",
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
    /// What goes to the drives.
    pub goes_out: &'static str,
    /// Why the last correction ended, if it did.
    pub why: Option<String>,
    /// What the operator should do.
    pub advice: &'static str,
}

impl InWords {
    /// Of a status and the flags of late.
    pub fn of(status: &DeviceStatus, flags: Status) -> Self {
        let shown = Shown::of(status.mode, status.reason);
        let (reason, fault) = (status.reason, status.reason.is_fault());
        let why = (reason != Reason::None)
            .then(|| if fault { format!("FAULT {}: {reason}", reason.code()) } else { format!("Last end: {reason}") });
        let faded = shown == Shown::Active && flags.has(Status::FADED);
        let goes_out = if faded { "The correction is faded out, in part or whole." } else { shown.goes_out() };
        let tone = if fault && matches!(shown, Shown::Pass | Shown::Off) { Tone::Wrong } else { shown.tone() };
        let advice = match shown {
            Shown::Lost => "Check cable, port and power of the board.",
            Shown::Off => while_off(reason),
            Shown::Pass if fault => advice(reason),
            Shown::Pass if status.active.is_none() => "No image is active: truepath device upload IMAGE --activate.",
            Shown::Pass => "To correct the next part, the operator confirms part and pass at the controller.",
            Shown::Armed => "Start the program from its beginning, with stock on the wall.",
            Shown::Active => while_active(flags),
            Shown::Ramp => "Wait; this pass of this part is not armed again.",
            Shown::Hold => "See that the spindle turns, then resume the feed; or end the program. Do not jog.",
            Shown::Fault => advice(reason),
        };
        Self { shown, tone, goes_out, why, advice }
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::link::Counters;

    use super::*;

    fn words(mode: Mode, reason: Reason, flags: Status) -> InWords {
        let status = DeviceStatus {
            mode,
            reason,
            drive_enable: mode != Mode::Off,
            active: None,
            recording_frozen: false,
            counters: Counters::default(),
            uptime_us: 0,
        };
        InWords::of(&status, flags)
    }

    #[test]
    fn while_the_drive_enable_is_dropped_the_drives_are_to_be_disabled_whatever_the_reason_and_not_after_it() {
        for reason in Reason::ALL {
            let asks = |mode| words(mode, reason, Status(0)).advice.to_lowercase().contains("disable the drives");
            assert!(asks(Mode::Off), "{reason}");
            assert!(!asks(Mode::Bypass) && !asks(Mode::Fault), "{reason}");
        }
    }

    #[test]
    fn after_every_fault_the_cutter_is_to_leave_the_part() {
        for reason in Reason::ALL.into_iter().filter(|reason| reason.is_fault()) {
            for mode in [Mode::Bypass, Mode::Fault] {
                let advice = words(mode, reason, Status(0)).advice.to_lowercase();
                assert!(advice.contains("retract"), "{reason}: {advice}");
            }
        }
    }

    #[test]
    fn there_is_something_to_do_when_the_wall_is_not_corrected_as_it_should_be() {
        let fine = words(Mode::Active, Reason::None, Status(Status::WARN.0 | Status::LAGGING.0));
        assert_eq!((fine.advice, fine.goes_out), ("Nothing to do.", Shown::Active.goes_out()));
        let faded = words(Mode::Active, Reason::None, Status::FADED);
        assert!(faded.advice.contains("not corrected") && faded.goes_out.contains("faded"), "{faded:?}");
        assert!(words(Mode::Active, Reason::None, Status::SATURATED).advice.contains("Measure"));
        assert!(words(Mode::Hold, Reason::None, Status::FADED).advice.contains("spindle"));
    }
}
