//! One tick: outer events, place and target, limiter, output.

use super::frame::{AXES, Mapping};
use super::state::{FADE_ONE, Mode, State};
use super::{Flags, Output, Plan, Reason, Rewriter, Setpoint, Status};
use crate::image::FineOffset;

impl Rewriter<'_> {
    /// Rewrites one setpoint. Cost is bounded; nothing in it can fail or panic.
    pub fn tick(&self, state: &mut State, setpoint: &Setpoint) -> Output {
        let mut correction_nm = [0; AXES];
        let mut status = Status::default();
        match state.mode {
            Mode::Off => state.drives_seen_enabled = setpoint.flags.has(Flags::DRIVES_ENABLED),
            Mode::Bypass => {}
            _ => self.run(state, setpoint, &mut correction_nm, &mut status),
        }
        state.sequence = setpoint.sequence;
        let mut axes = setpoint.axes;
        for (axis, correction) in axes.iter_mut().zip(correction_nm) {
            *axis = axis.saturating_add(correction.into());
        }
        Output {
            axes,
            correction_nm,
            forward: state.mode != Mode::Off,
            mode: state.mode,
            reason: state.reason,
            status,
            place: state.place,
            sequence: setpoint.sequence,
        }
    }

    fn run(&self, state: &mut State, setpoint: &Setpoint, correction_nm: &mut [i32; AXES], status: &mut Status) {
        let at_rest = state.axes.iter().all(|a| a.is_at_rest_at_zero());
        if state.is_ending() && at_rest {
            state.mode = Mode::Bypass;
            return;
        }
        let (Some(plan), Some(mapping)) = (&self.plan, state.mapping) else {
            // The image was taken away. Without it there are no limits to ramp by: the drives must stop first.
            state.reason = Reason::ImageChanged;
            state.mode = if at_rest { Mode::Bypass } else { Mode::Off };
            return;
        };
        if let Some(reason) = disturbance(plan, state, setpoint).filter(|_| !state.is_ending()) {
            state.end(reason);
        }
        if state.mode == Mode::Armed {
            self.wait(plan, &mapping, state, setpoint);
        }
        let wanted = match state.mode {
            Mode::Bypass | Mode::Armed => return,
            _ if state.is_ending() => (0, 0),
            _ => self.follow(plan, &mapping, state, setpoint),
        };
        let mut wanted = mapping.machine(wanted.0, wanted.1);
        if self.passes_joint_limit(&mapping, setpoint, wanted) {
            state.end(Reason::JointLimit);
            wanted = [0, 0];
        }
        for (index, (axis, goal)) in state.axes.iter_mut().zip(wanted).enumerate() {
            status.set(Status::SATURATED, plan.limits.step(axis, goal));
            status.set(Status::LAGGING, !axis.is_on_target());
            let nm = nanometres(axis.correction());
            let (held, limited) = self.within_joint_limits(&mapping, setpoint, index, nm);
            status.set(Status::JOINT_LIMITED, limited);
            status.set(Status::WARN, held.unsigned_abs() > plan.warn_nm);
            let place = mapping.plane().get(index).copied().and_then(|machine| correction_nm.get_mut(machine));
            if let Some(place) = place {
                *place = held;
            }
        }
        status.set(Status::FADED, state.fade < FADE_ONE);
    }

    /// Whether a setpoint with the correction wanted (2⁻⁸ nm) would pass a joint limit that the setpoint keeps.
    #[inline]
    fn passes_joint_limit(&self, mapping: &Mapping, setpoint: &Setpoint, wanted: [i32; 2]) -> bool {
        let mut passes = false;
        for (index, fine) in wanted.into_iter().enumerate() {
            passes |= self.within_joint_limits(mapping, setpoint, index, nanometres(FineOffset::from_bits(fine))).1;
        }
        passes
    }

    /// A correction held back so that it does not carry its axis over a limit, and whether it was.
    #[inline]
    fn within_joint_limits(&self, mapping: &Mapping, setpoint: &Setpoint, index: usize, nm: i32) -> (i32, bool) {
        let machine = mapping.plane().get(index).copied().unwrap_or(0);
        let position = setpoint.axes.get(machine).copied().unwrap_or(0);
        let (low, high) = self.settings.joint_limits_nm.get(machine).copied().unwrap_or((i64::MIN, i64::MAX));
        let corrected = position.saturating_add(nm.into());
        // A setpoint beyond a limit is the controller's affair; the correction does not carry it farther out.
        if corrected > high && nm > 0 {
            (high.max(position).wrapping_sub(position) as i32, true)
        } else if corrected < low && nm < 0 {
            (low.min(position).wrapping_sub(position) as i32, true)
        } else {
            (nm, false)
        }
    }
}

/// Whole nanometres of a correction; in range, a [`FineOffset`] ends at ±8.39 mm.
#[inline]
fn nanometres(fine: FineOffset) -> i32 {
    fine.offset().nm() as i32
}

/// An event from outside that ends every arming.
#[inline]
fn disturbance(plan: &Plan<'_>, state: &State, setpoint: &Setpoint) -> Option<Reason> {
    let flags = setpoint.flags;
    let armed_only = state.mode == Mode::Armed;
    // The most serious first.
    if flags.has(Flags::EMERGENCY_STOP) {
        Some(Reason::EmergencyStop)
    } else if flags.has(Flags::ABORT) {
        Some(Reason::Abort)
    } else if flags.has(Flags::TOOL_CHANGE) {
        Some(Reason::ToolChange)
    } else if !flags.has(Flags::DRIVES_ENABLED) && !armed_only {
        // Arming before the drives are enabled is usual; the gate asks for them.
        Some(Reason::DrivesDisabled)
    } else if setpoint.frame_crc != state.frame_crc {
        Some(Reason::FrameChanged)
    } else if plan.image.crc() != state.image_crc {
        Some(Reason::ImageChanged)
    } else if flags.has(Flags::PROGRAM_END) {
        Some(Reason::ProgramEnd)
    } else {
        None
    }
}
