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
    ///
    /// Its stages are functions of their own, because one large one spends a sixth of its instructions on keeping
    /// values that no register has room for.
    pub fn tick(&self, state: &mut State, setpoint: &Setpoint) -> Output {
        match state.mode {
            Mode::Off => {
                state.drives_seen_enabled = setpoint.flags.has(Flags::DRIVES_ENABLED);
                output(state, setpoint, [(0, 0), (1, 0)], Status(0))
            }
            Mode::Bypass => output(state, setpoint, [(0, 0), (1, 0)], Status(0)),
            _ => self.run(state, setpoint),
        }
    }

    #[inline(never)]
    fn run(&self, state: &mut State, setpoint: &Setpoint) -> Output {
        let mut added = [(0, 0), (1, 0)];
        let mut status = Status(0);
        if let Some((plan, (x, y))) = self.wanted(state, setpoint)
            && let Some(mapping) = &state.mapping
        {
            let goal = mapping.machine(x, y);
            let [mx, my] = mapping.plane();
            status.set(Status::FADED, state.fade < FADE_ONE);
            let [ax, ay] = &mut state.axes;
            let (nm_x, status_x) = self.carry(plan, setpoint, mx, ax, goal.0);
            let (nm_y, status_y) = self.carry(plan, setpoint, my, ay, goal.1);
            added = [(mx, nm_x), (my, nm_y)];
            status = status.with(status_x).with(status_y);
            if status.has(Status::JOINT_LIMITED) && !state.is_ending() {
                state.end(Reason::JointLimit);
            }
        }
        output(state, setpoint, added, status)
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

    /// Moves the correction of an axis one tick towards its goal; gives what of it may be added, nm.
    #[inline(always)]
    fn carry(
        &self,
        plan: &Plan<'_>,
        setpoint: &Setpoint,
        machine: usize,
        axis: &mut AxisState,
        goal: i32,
    ) -> (i32, Status) {
        let mut status = Status(0);
        status.set(Status::SATURATED, plan.limits.step(axis, goal));
        status.set(Status::LAGGING, !axis.is_on_target());
        let (nm, limited) = self.held(setpoint, machine, nanometres(axis.correction().bits()));
        status.set(Status::JOINT_LIMITED, limited);
        status.set(Status::WARN, nm.unsigned_abs() > plan.warn_nm);
        (nm, status)
    }

    /// A correction held back to the way that is left to the joint limits of its axis, and whether it was. A setpoint
    /// beyond a limit is the controller's affair; the correction then does not carry it farther out.
    #[inline(always)]
    fn held(&self, setpoint: &Setpoint, machine: usize, nm: i32) -> (i32, bool) {
        let (Some(&position), Some(&(low, high))) = (setpoint.axes.get(machine), self.joints.get(machine)) else {
            return (nm, false);
        };
        let to = position.wrapping_add(nm.into());
        if to >= low && to <= high { (nm, false) } else { held_back(position, low, high, nm) }
    }
}

/// What leaves with a correction of two axes.
#[inline(always)]
fn output(state: &mut State, setpoint: &Setpoint, added: [(usize, i32); 2], status: Status) -> Output {
    state.sequence = setpoint.sequence;
    let mut axes = setpoint.axes;
    let mut correction_nm = [0; AXES];
    for (machine, nm) in added {
        if let (Some(to), Some(axis)) = (correction_nm.get_mut(machine), axes.get_mut(machine)) {
            *to = nm;
            // Within the joint limits, or not farther out than the setpoint.
            *axis = axis.wrapping_add(nm.into());
        }
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

#[cold]
fn held_back(position: i64, low: i64, high: i64, nm: i32) -> (i32, bool) {
    let room = |room: i64| room.clamp(0, i32::MAX.into()) as i32;
    let (down, up) = (room(position.saturating_sub(low)), room(high.saturating_sub(position)));
    let held = nm.min(up).max(down.wrapping_neg());
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
