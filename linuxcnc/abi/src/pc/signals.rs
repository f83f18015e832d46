//! LinuxCNC's signals as flags of a setpoint: the same for either route.
//!
//! | LinuxCNC | flag |
//! |---|---|
//! | drives on and all joints homed | drives enabled; while armed only in a running program, and not during a probing move |
//! | drives or homing lost while armed | abort |
//! | program no longer runs | abort with a correction on, otherwise program end |
//! | probing move with a correction on | abort |
//!
//! Without "drives enabled" the gate stays shut, so jogging, a line typed by hand or a probing move never goes through it.

use truepath_core::rewrite::{Flags, Mode};

use super::pins::{Inputs, Switches};

/// motion.motion-type of G38.
pub const PROBING: i32 = 5;

/// What was the period before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    drives: bool,
    running: bool,
}

impl Signals {
    /// The flags of a period; `mode` is that before it.
    #[inline]
    pub fn flags(&mut self, inputs: &Inputs, mode: Mode) -> Flags {
        let on = |switch| inputs.switches.has(switch);
        let drives = on(Switches::DRIVES_ON) && on(Switches::ALL_HOMED);
        let running = on(Switches::PROGRAM_RUNNING);
        let probing = inputs.motion_type == PROBING;
        let (armed, active) = (mode == Mode::Armed, matches!(mode, Mode::Active | Mode::Hold));
        let ended = self.running && !running;
        let lost = self.drives && !drives;
        *self = Self { drives, running };
        [
            (drives && !(armed && (probing || !running)), Flags::DRIVES_ENABLED),
            (on(Switches::FEED_HOLD), Flags::FEED_HOLD),
            (on(Switches::SPINDLE_LOADED), Flags::SPINDLE_LOADED),
            (on(Switches::EMERGENCY_STOP), Flags::EMERGENCY_STOP),
            (on(Switches::TOOL_CHANGE), Flags::TOOL_CHANGE),
            (ended && !active, Flags::PROGRAM_END),
            ((ended || probing) && active || lost && armed, Flags::ABORT),
        ]
        .into_iter()
        .filter(|&(is, _)| is)
        .fold(Flags::default(), |flags, (_, flag)| flags.with(flag))
    }
}
