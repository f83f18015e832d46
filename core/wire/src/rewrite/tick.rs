//! One tick: outer events, place and target, limiter, output.

use super::frame::AXES;
use super::limit::AxisState;
use super::mode::Mode;
use super::state::{FADE_ONE, State};
use super::{Flags, Output, Plan, Reason, Rewriter, Setpoint, Status};
use crate::image::FineOffset;
use truepath_units::shift_rounded_i31;

impl Rewriter<'_> {
    /// Rewrites one setpoint. Cost is bounded; nothing in it can fail or panic.
    #[inline]
    pub fn tick(&self, state: &mut State, setpoint: &Setpoint) -> Output {
        let mut output = Output::NONE;
        self.tick_into(state, setpoint, &mut output);
        output
    }

    /// The same, with the output written where it stays, every part of it: a copy of it costs a tenth of a tick.
    ///
    /// Its stages are functions of their own, because one large one spends a sixth of its instructions on keeping
    /// values that no register has room for.
    pub fn tick_into(&self, state: &mut State, setpoint: &Setpoint, output: &mut Output) {
        output.axes = setpoint.axes;
        output.correction_nm = [0; AXES];
        output.status = Status(0);
        match state.mode {
            Mode::Off => state.drives_seen_enabled = setpoint.flags.has(Flags::DRIVES_ENABLED),
            Mode::Bypass => {}
            _ => self.run(state, setpoint, output),
        }
        state.sequence = setpoint.sequence;
        output.sequence = setpoint.sequence;
        output.forward = state.mode != Mode::Off;
        output.mode = state.mode;
        output.reason = state.reason;
        output.place = state.place;
    }

    /// The tick of a correction that is armed, on, or on its way out.
    #[inline(never)]
    fn run(&self, state: &mut State, setpoint: &Setpoint, output: &mut Output) {
        if let Some((plan, (x, y))) = self.wanted(state, setpoint)
            && let Some(mapping) = &state.mapping
        {
            let goal = mapping.machine(x, y);
            let [mx, my] = mapping.plane();
            let [ax, ay] = &mut state.axes;
            let status = self.carry(plan, ax, goal.0, mx, output).with(self.carry(plan, ay, goal.1, my, output));
            output.status = status;
            output.status.set(Status::FADED, state.fade < FADE_ONE);
            if status.has(Status::JOINT_LIMITED) && !state.is_ending() {
                state.end(Reason::JointLimit);
            }
        }
    }

    /// The correction wanted, in program coordinates, 2⁻⁸ nm; none where nothing is to be added.
    #[inline(always)]
    fn wanted(&self, state: &mut State, setpoint: &Setpoint) -> Option<(&Plan<'_>, (i32, i32))> {
        let ending = state.is_ending();
        if ending && state.is_at_rest() {
            state.mode = Mode::Bypass;
            return None;
        }
        let Some(plan) = &self.plan else {
            // The image was taken away. Without it there are no limits to ramp by: the drives must stop first.
            state.reason = Reason::ImageChanged;
            state.mode = if state.is_at_rest() { Mode::Bypass } else { Mode::Off };
            state.drives_seen_enabled = setpoint.flags.has(Flags::DRIVES_ENABLED);
            return None;
        };
        if ending {
            return Some((plan, (0, 0)));
        }
        if let Some(reason) = disturbance(plan, state, setpoint) {
            state.end(reason);
            return (state.mode != Mode::Bypass).then_some((plan, (0, 0)));
        }
        if state.mode == Mode::Armed && !self.enters(plan, state, setpoint) {
            return None;
        }
        Some((plan, self.follow(plan, state, setpoint)))
    }

    /// Moves the correction of an axis one tick towards its goal and adds what of it may be added.
    #[inline(never)]
    fn carry(&self, plan: &Plan<'_>, axis: &mut AxisState, goal: i32, machine: usize, output: &mut Output) -> Status {
        let mut status = Status(0);
        status.set(Status::SATURATED, plan.limits.step(axis, goal));
        status.set(Status::LAGGING, !axis.is_on_target());
        let mut nm = nanometres(axis.correction().bits());
        if let (Some(position), Some(correction), Some(&(low, high))) =
            (output.axes.get_mut(machine), output.correction_nm.get_mut(machine), self.joints.get(machine))
        {
            let to = position.wrapping_add(nm.into());
            if to >= low && to <= high {
                *position = to;
            } else {
                let limited;
                (nm, limited) = held_back(position, low, high, nm);
                status.set(Status::JOINT_LIMITED, limited);
            }
            *correction = nm;
        }
        status.set(Status::WARN, nm.unsigned_abs() > plan.warn_nm);
        status
    }
}

/// Adds to a position what of a correction is within the way that is left to the joint limits of its axis; gives that, and whether it is
/// less. A setpoint beyond a limit is the controller's affair; the correction then does not carry it farther out.
#[cold]
#[inline(never)]
fn held_back(position: &mut i64, low: i64, high: i64, nm: i32) -> (i32, bool) {
    let room = |room: i64| room.clamp(0, i32::MAX.into()) as i32;
    let (down, up) = (room(position.saturating_sub(low)), room(high.saturating_sub(*position)));
    let held = nm.min(up).max(down.wrapping_neg());
    // Within the joint limits, or not farther out than the setpoint.
    *position = position.wrapping_add(held.into());
    (held, held != nm)
}

/// Whole nanometres of a correction in steps of 2⁻⁸ nm; in range, a clamp is below 2³⁰ of them.
#[inline(always)]
fn nanometres(fine: i32) -> i32 {
    shift_rounded_i31(fine, FineOffset::FRACTION_BITS)
}

/// An event from outside that ends every arming.
#[inline(always)]
fn disturbance(plan: &Plan<'_>, state: &State, setpoint: &Setpoint) -> Option<Reason> {
    const STOPS: Flags = Flags::EMERGENCY_STOP.with(Flags::ABORT).with(Flags::TOOL_CHANGE).with(Flags::PROGRAM_END);
    let flags = setpoint.flags;
    // Arming before the drives are enabled is usual; the gate asks for them.
    let drives = flags.has(Flags::DRIVES_ENABLED) || state.mode == Mode::Armed;
    let same = setpoint.frame_crc == state.frame_crc && plan.image.crc() == state.image_crc;
    if drives && same && !flags.has(STOPS) {
        return None;
    }
    // The most serious first.
    Some(if flags.has(Flags::EMERGENCY_STOP) {
        Reason::EmergencyStop
    } else if flags.has(Flags::ABORT) {
        Reason::Abort
    } else if flags.has(Flags::TOOL_CHANGE) {
        Reason::ToolChange
    } else if !drives {
        Reason::DrivesDisabled
    } else if setpoint.frame_crc != state.frame_crc {
        Reason::FrameChanged
    } else if plan.image.crc() != state.image_crc {
        Reason::ImageChanged
    } else {
        Reason::ProgramEnd
    })
}
