//! What a check gives, and what several of them ask for.

use truepath_core::rewrite::{Flags, Mode};

use crate::attack::rule::{Alarm, Rule};

/// What a check gives.
pub type Verdict = Result<(), Box<Alarm>>;

/// An alarm; session and setpoint are put in by those who know them.
pub fn alarm(rule: Rule, found: impl Into<String>) -> Verdict {
    Err(Box::new(Alarm { rule, found: found.into(), session: 0, setpoint: 0 }))
}

/// The rule holds, or its alarm.
pub fn hold(holds: bool, rule: Rule, found: impl FnOnce() -> String) -> Verdict {
    if holds { Ok(()) } else { alarm(rule, found()) }
}

/// Flags that end an arming.
pub const STOPS: Flags = Flags::EMERGENCY_STOP.with(Flags::ABORT).with(Flags::TOOL_CHANGE).with(Flags::PROGRAM_END);

/// Whether there may be a correction.
pub const fn is_on(mode: Mode) -> bool {
    matches!(mode, Mode::Active | Mode::Hold | Mode::Fault)
}
