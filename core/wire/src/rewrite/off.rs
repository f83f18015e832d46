//! Ends that come from the link and not from a setpoint: too many are missing, or none come any more.

use super::{Mode, Reason, Rewriter, State};

impl Rewriter<'_> {
    /// `Armed` → `Bypass`, `Active` and `Hold` → `Fault`, from which the correction ramps out with the next ticks.
    /// In other states, and on the way out, nothing happens.
    #[inline]
    pub fn break_off(&self, state: &mut State, reason: Reason) {
        if matches!(state.mode, Mode::Armed | Mode::Active | Mode::Hold) && !state.is_ending() {
            state.end(reason);
        }
    }

    /// Any state → `Off`, whatever correction there was: nothing goes out until the controller acknowledges that the
    /// drives are disabled. A ramp needs setpoints, and there are none; the drives stop by themselves. The passes of
    /// parts that were armed stay spent.
    #[inline]
    pub fn power_off(&self, state: &mut State, reason: Reason) {
        // What the controller last said about its drives is old: it has to say it again.
        *state = State { mode: Mode::Off, reason, drives_seen_enabled: true, ..State::remembering(state.spent) };
    }
}
