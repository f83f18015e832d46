//! What must hold of every answer, whatever the host's own code says: judged from the frames alone.
//!
//! * It answers a frame that was sent and arrived whole, each at most once, in the order of delivery.
//! * Position = setpoint + correction, to the nanometre; no correction in `Off`, `Bypass`, `Armed`.
//! * |correction| ≤ clamp; its change and the change of that within the limits per tick, axis by axis.
//! * `forward` is set in every state but `Off`.
//! * Modes follow each other as the safety contract says; `Fault` ends within the stated number of ticks.
//! * No reason is `FrameRate`: on the bench no frame follows another sooner than a tick.

use std::collections::VecDeque;

use truepath_core::rewrite::{AXES, Limits, Mode, Output, Reason, Setpoint, Status};

use super::traffic::Command;

/// What happened on the way to the device, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Happened {
    /// A setpoint came out of the cable whole. (Of those that did not there is nothing to be judged but the absence of
    /// an answer.)
    Delivered(Setpoint),
    /// A command was carried out.
    Commanded(Command),
    /// Nothing came for so long that the device has gone to `Off`.
    Silent,
}

/// The rule that an answer breaks.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Violation {
    /// To no frame.
    #[error("an answer to sequence {sequence}, of which no whole frame was delivered")]
    NoFrame {
        /// Sequence of the answer.
        sequence: u32,
    },
    /// Position is not setpoint + correction.
    #[error("axis {axis}: position {position} nm is not setpoint {setpoint} + correction {correction} nm")]
    Sum {
        /// Index of the axis.
        axis: usize,
        /// Of the answer.
        position: i64,
        /// Of the frame.
        setpoint: i64,
        /// Of the answer.
        correction: i32,
    },
    /// Beyond a limit.
    #[error("axis {axis}: {what} of the correction is {found} nm, permitted {limit} nm")]
    Limit {
        /// Index of the axis.
        axis: usize,
        /// Size, change or change of change.
        what: &'static str,
        /// What it is.
        found: i64,
        /// What it may be.
        limit: i64,
    },
    /// A correction where there must be none, or `forward` wrong.
    #[error("in {mode} the correction is {correction:?} nm, forward {forward}")]
    State {
        /// Mode of the answer.
        mode: Mode,
        /// Corrections of the axes.
        correction: [i32; AXES],
        /// Whether it is forwarded.
        forward: bool,
    },
    /// A transition that does not exist.
    #[error("from {from} to {to} without a reason")]
    Transition {
        /// Mode before.
        from: Mode,
        /// Mode after.
        to: Mode,
    },
    /// A fault that cannot have happened.
    #[error("the reason is \"{reason}\", but no frame followed another sooner than a tick")]
    Reason {
        /// Of the answer.
        reason: Reason,
    },
    /// A fault that does not end.
    #[error("in Fault for {ticks} ticks, {most} permitted")]
    Ramp {
        /// Ticks so far.
        ticks: u32,
        /// Most.
        most: u32,
    },
}

/// The judge.
#[derive(Clone, Debug)]
pub struct Judge {
    limits: Limits,
    axes: usize,
    mode: Mode,
    correction: [i64; AXES],
    change: [i64; AXES],
    fault_ticks: u32,
    /// Greatest correction seen, nm.
    largest_nm: i64,
    /// Answers by mode.
    modes: [u64; 6],
}

impl Judge {
    /// For a device with these limits and axes, after a reset.
    pub fn new(limits: Limits, axes: u8) -> Self {
        Self {
            limits,
            axes: usize::from(axes).min(AXES),
            mode: Mode::Off,
            correction: [0; AXES],
            change: [0; AXES],
            fault_ticks: 0,
            largest_nm: 0,
            modes: [0; 6],
        }
    }
    /// Greatest correction seen, nm.
    pub const fn largest_nm(&self) -> i64 {
        self.largest_nm
    }
    /// Answers in `Off`, `Bypass`, `Armed`, `Active`, `Hold`, `Fault`.
    pub const fn modes(&self) -> &[u64; 6] {
        &self.modes
    }

    fn happened(&mut self, happened: &Happened) {
        match happened {
            Happened::Silent => self.restart(Mode::Off),
            Happened::Commanded(Command::Acknowledge) => self.restart(Mode::Bypass),
            Happened::Commanded(Command::Arm(_)) => self.mode = Mode::Armed,
            Happened::Commanded(Command::Disarm) if self.mode == Mode::Armed => self.mode = Mode::Bypass,
            Happened::Commanded(_) | Happened::Delivered(_) => {}
        }
    }
    fn restart(&mut self, mode: Mode) {
        (self.correction, self.change, self.fault_ticks) = ([0; AXES], [0; AXES], 0);
        self.mode = mode;
    }

    /// One answer. What happened up to the frame it answers is taken off `log`.
    ///
    /// # Errors
    /// The rule it breaks.
    pub fn answer(&mut self, output: &Output, log: &mut VecDeque<Happened>) -> Result<Setpoint, Violation> {
        let sequence = output.sequence;
        let setpoint = loop {
            match log.pop_front() {
                Some(Happened::Delivered(setpoint)) if setpoint.sequence == sequence => break setpoint,
                Some(other) => self.happened(&other),
                None => return Err(Violation::NoFrame { sequence }),
            }
        };
        self.sums(output, &setpoint)?;
        self.transition(output)?;
        self.sizes(output)?;
        if let Some(count) = self.modes.get_mut(output.mode as usize) {
            *count += 1;
        }
        self.mode = output.mode;
        Ok(setpoint)
    }

    fn sums(&self, output: &Output, setpoint: &Setpoint) -> Result<(), Violation> {
        for axis in 0..self.axes {
            let (position, commanded, correction) =
                (output.axes[axis], setpoint.axes[axis], output.correction_nm[axis]);
            if position != commanded.saturating_add(correction.into()) {
                return Err(Violation::Sum { axis, position, setpoint: commanded, correction });
            }
        }
        let plain = matches!(output.mode, Mode::Off | Mode::Bypass | Mode::Armed);
        if (plain && output.correction_nm != [0; AXES]) || output.forward == (output.mode == Mode::Off) {
            let (mode, correction, forward) = (output.mode, output.correction_nm, output.forward);
            return Err(Violation::State { mode, correction, forward });
        }
        Ok(())
    }

    fn transition(&mut self, output: &Output) -> Result<(), Violation> {
        use Mode::{Active, Armed, Bypass, Fault, Hold, Off};
        let (from, to) = (self.mode, output.mode);
        let permitted = match from {
            Off => &[Off][..],
            Bypass => &[Bypass],
            Armed => &[Armed, Bypass, Active, Fault],
            Active => &[Active, Hold, Fault, Bypass],
            // Straight to Bypass when the fault finds the correction faded to nothing.
            Hold => &[Hold, Active, Fault, Bypass],
            Fault => &[Fault, Bypass],
        };
        if output.reason == Reason::FrameRate {
            return Err(Violation::Reason { reason: output.reason });
        }
        let on = self.correction != [0; AXES];
        if !permitted.contains(&to) || (to == Bypass && on) {
            return Err(Violation::Transition { from, to });
        }
        self.fault_ticks = if to == Fault { self.fault_ticks + 1 } else { 0 };
        let most = self.limits.ramp_ticks();
        if self.fault_ticks > most + 1 {
            return Err(Violation::Ramp { ticks: self.fault_ticks, most });
        }
        Ok(())
    }

    fn sizes(&mut self, output: &Output) -> Result<(), Violation> {
        // Corrections are told in whole nanometres: half a one of rounding for each value that is compared.
        let limit = |bits: i32, rounding: i64| (i64::from(bits) + 255) / 256 + rounding;
        let clamp = limit(self.limits.clamp().bits(), 0);
        let velocity = limit(self.limits.velocity().bits(), 1);
        let acceleration = limit(self.limits.acceleration().bits(), 2);
        for axis in 0..self.axes {
            let correction = i64::from(output.correction_nm[axis]);
            let change = correction - self.correction[axis];
            let step = change - self.change[axis];
            let held = output.status.has(Status::JOINT_LIMITED);
            for (what, found, limit) in [
                ("size", correction, clamp),
                ("change per tick", change, velocity),
                ("change of change per tick", step, acceleration),
            ] {
                if found.abs() > limit && (what == "size" || !held) {
                    return Err(Violation::Limit { axis, what, found, limit });
                }
            }
            self.largest_nm = self.largest_nm.max(correction.abs());
            (self.correction[axis], self.change[axis]) = (correction, change);
        }
        Ok(())
    }
}
