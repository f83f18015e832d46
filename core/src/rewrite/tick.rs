//! One tick: outer events, place and target, limiter, output.

use super::frame::AXES;
use super::locate::Place;
use super::state::{FADE_ONE, Mode, State};
use super::{Flags, Output, Plan, Reason, Rewriter, Setpoint, Status};
use crate::image::FineOffset;

impl Rewriter<'_> {
    /// Rewrites one setpoint. Cost is bounded; nothing in it can fail or panic.
    pub fn tick(&self, state: &mut State, setpoint: &Setpoint) -> Output {
        let mut out = Output {
            axes: setpoint.axes,
            correction_nm: [0; AXES],
            forward: true,
            mode: Mode::Off,
            reason: Reason::None,
            status: Status::default(),
            place: Place::default(),
            sequence: setpoint.sequence,
        };
        match state.mode {
            Mode::Off => state.drives_seen_enabled = setpoint.flags.has(Flags::DRIVES_ENABLED),
            Mode::Bypass => {}
            _ => self.run(state, setpoint, &mut out),
        }
        state.sequence = setpoint.sequence;
        out.forward = state.mode != Mode::Off;
        out.mode = state.mode;
        out.reason = state.reason;
        out.place = state.place;
        out
    }

    fn run(&self, state: &mut State, setpoint: &Setpoint, out: &mut Output) {
        let at_rest = state.axes.iter().all(|a| a.is_at_rest_at_zero());
        if state.is_ending() && at_rest {
            state.mode = Mode::Bypass;
            return;
        }
        let Some(plan) = &self.plan else {
            // The image was taken away. Without it there are no limits to ramp by: the drives must stop first.
            state.reason = Reason::ImageChanged;
            state.mode = if at_rest { Mode::Bypass } else { Mode::Off };
            return;
        };
        if let Some(reason) = disturbance(plan, state, setpoint).filter(|_| !state.is_ending()) {
            state.end(reason);
        }
        if state.mode == Mode::Armed {
            self.wait(plan, state, setpoint);
        }
        let (x, y) = match state.mode {
            Mode::Bypass | Mode::Armed => return,
            _ if state.is_ending() => (0, 0),
            _ => self.follow(plan, state, setpoint),
        };
        let (mut wanted, plane) = match &state.mapping {
            Some(mapping) => (mapping.machine(x, y), mapping.plane()),
            None => ([0; 2], [0, 1]),
        };
        let rooms = plane.map(|axis| self.room(setpoint, axis));
        if wanted.iter().zip(rooms).any(|(&fine, room)| room.hold(nanometres(FineOffset::from_bits(fine))).1) {
            state.end(Reason::JointLimit);
            wanted = [0; 2];
        }
        for (((axis, goal), room), machine) in state.axes.iter_mut().zip(wanted).zip(rooms).zip(plane) {
            out.status.set(Status::SATURATED, plan.limits.step(axis, goal));
            out.status.set(Status::LAGGING, !axis.is_on_target());
            let (nm, held) = room.hold(nanometres(axis.correction()));
            out.status.set(Status::JOINT_LIMITED, held);
            out.status.set(Status::WARN, nm.unsigned_abs() > plan.warn_nm);
            if let (Some(to), Some(axis)) = (out.correction_nm.get_mut(machine), out.axes.get_mut(machine)) {
                *to = nm;
                *axis = axis.saturating_add(nm.into());
            }
        }
        out.status.set(Status::FADED, state.fade < FADE_ONE);
    }

    /// How far a correction may carry an axis. A setpoint beyond a limit is the controller's affair; the correction
    /// then does not carry it farther out.
    #[inline]
    fn room(&self, setpoint: &Setpoint, machine: usize) -> Room {
        let position = setpoint.axes.get(machine).copied().unwrap_or(0);
        let (low, high) = self.settings.joint_limits_nm.get(machine).copied().unwrap_or((i64::MIN, i64::MAX));
        let narrow = |room: i64| room.clamp(0, i64::from(i32::MAX)) as i32;
        Room { down: narrow(position.saturating_sub(low)), up: narrow(high.saturating_sub(position)) }
    }
}

/// Way to the joint limits of an axis, nm, not negative.
#[derive(Clone, Copy)]
struct Room {
    down: i32,
    up: i32,
}

impl Room {
    /// A correction held back to the room, and whether it was.
    #[inline]
    fn hold(self, nm: i32) -> (i32, bool) {
        let held = nm.min(self.up).max(self.down.wrapping_neg());
        (held, held != nm)
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
