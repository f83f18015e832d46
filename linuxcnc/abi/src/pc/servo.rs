//! The servo side: what the two functions of the component do in a period.
//!
//! Called by LinuxCNC's servo thread alone. Work is bounded; the most is an arming, which copies the state and compares
//! six numbers. Floats are in [`convert`](crate::convert) only.

use core::sync::atomic::{AtomicU32, Ordering};

use truepath_core::image::Binding;
use truepath_core::rewrite::{
    AXES, ArmRequest, Flags, Mode, Output, Reason, Refusal, Rewriter, Setpoint, SpentList, State, Status,
};

use super::arming::{Refused, Running};
use super::limits::Joints;
use super::mailbox::{Loaded, ServoEnds};
use super::pins::{Inputs, JOINTS, Outputs, Switches};
use super::setpoint::{PROBING, Signals, WorkFrame};
use super::shift::Shift;

/// An arming that waits for the ledger.
#[derive(Clone, Copy, Debug)]
struct Arming {
    request: ArmRequest,
    running: Running,
    /// Something happened that would have ended it.
    overtaken: bool,
}

/// The servo side.
pub struct Servo {
    ends: ServoEnds,
    shift: Shift,
    period_ns: &'static AtomicU32,
    /// Passes positions on while there is no image.
    bare: Rewriter<'static>,
    loaded: Option<Loaded>,
    state: State,
    signals: Signals,
    frame: WorkFrame,
    sequence: u32,
    /// The switches of the period before.
    before: Switches,
    /// The correction of the last period, nm.
    correction_nm: [i32; AXES],
    /// What the last part was armed for.
    running: Option<Running>,
    /// An arming that waits for the ledger.
    arming: Option<Arming>,
    refusal: u32,
    armed_serial: u32,
}

impl Servo {
    pub(super) fn new(
        ends: ServoEnds,
        joints: Joints,
        period_ns: &'static AtomicU32,
        bare: Rewriter<'static>,
        spent: SpentList,
    ) -> Self {
        Self {
            ends,
            shift: Shift::new(joints),
            period_ns,
            bare,
            loaded: None,
            state: State::remembering(spent),
            signals: Signals::default(),
            frame: WorkFrame::new(),
            sequence: 0,
            before: Switches::default(),
            correction_nm: [0; AXES],
            running: None,
            arming: None,
            refusal: 0,
            armed_serial: 0,
        }
    }

    /// Before the motion controller: the measured position of each joint without the correction of the last period.
    pub fn feedback(&self, measured: &[f64; JOINTS], plain: &mut [f64; JOINTS]) {
        self.shift.feedback(measured, plain);
    }

    /// Behind the motion controller: a period.
    pub fn command(&mut self, pins: &Inputs, outputs: &mut Outputs) {
        let (inputs, kept) = self.in_unit(pins);
        let inputs = &inputs;
        if self.period_ns.load(Ordering::Relaxed) != inputs.period_ns {
            self.period_ns.store(inputs.period_ns, Ordering::Relaxed);
        }
        self.sequence = self.sequence.wrapping_add(1);
        self.exchange();
        let flags = self.signals.flags(inputs, self.state.mode()).with(self.ended(inputs, kept));
        self.frame.update(inputs);
        self.commands(inputs, flags);
        match self.shift.joints().setpoint(inputs, flags, self.frame.crc(), self.sequence) {
            Some(setpoint) => {
                let output = self.tick(&setpoint);
                if output.mode == Mode::Off && !inputs.switches.has(Switches::DRIVES_ON) {
                    self.acknowledge();
                }
                self.put(inputs, flags, &output, outputs);
            }
            None => self.pass(inputs, flags, outputs),
        }
    }

    /// The pins with the unit that what is armed or on is in, and whether that is the one of the pins.
    fn in_unit(&mut self, pins: &Inputs) -> (Inputs, bool) {
        let idle = matches!(self.state.mode(), Mode::Off | Mode::Bypass) && self.correction_nm == [0; AXES];
        self.shift.in_unit(pins, idle && self.arming.is_none())
    }

    /// What ends an arming because it was for something else.
    fn ended(&self, inputs: &Inputs, kept: bool) -> Flags {
        let unit = if kept { Flags::default() } else { Flags::ABORT };
        match (self.state.mode(), self.running, &self.arming) {
            (Mode::Armed | Mode::Active | Mode::Hold, Some(running), _) => unit.with(running.ended(inputs)),
            (.., Some(arming)) => unit.with(arming.running.ended(inputs)),
            _ => unit,
        }
    }

    /// Takes a new image where no correction is on or waiting.
    fn exchange(&mut self) {
        let idle = matches!(self.state.mode(), Mode::Off | Mode::Bypass) && self.arming.is_none();
        if idle
            && self.ends.returned.is_free()
            && let Some(offer) = self.ends.offer.take()
            && let Some(old) = core::mem::replace(&mut self.loaded, offer)
        {
            // There is room, and nobody else writes to it.
            let _ = self.ends.returned.send(old.bytes);
        }
    }

    /// What the operator wants.
    fn commands(&mut self, inputs: &Inputs, flags: Flags) {
        const STOPS: Flags = Flags::EMERGENCY_STOP.with(Flags::ABORT).with(Flags::TOOL_CHANGE).with(Flags::PROGRAM_END);
        let rises = |switch| inputs.switches.has(switch) && !self.before.has(switch);
        let falls = |switch| self.before.has(switch) && !inputs.switches.has(switch);
        let (arm, disarm) = (rises(Switches::ARM), rises(Switches::DISARM));
        let lost = falls(Switches::DRIVES_ON) || falls(Switches::ALL_HOMED);
        self.before = inputs.switches;
        let permitted = inputs.switches.has(Switches::ENABLE) && inputs.switches.has(Switches::TRIVIAL_KINEMATICS);
        let taken_back = disarm || !permitted;
        if let Some(arming) = &mut self.arming {
            arming.overtaken |= taken_back || lost || flags.has(STOPS);
        }
        if taken_back {
            // Refused where nothing is armed or the correction is on its way out.
            let _ = self.loaded.as_ref().map_or(&self.bare, |l| &l.rewriter).disarm(&mut self.state);
        }
        if let Some(done) = self.ends.written.take()
            && let Some(arming) = self.arming.take()
        {
            let result = if !done {
                Err(Refused::Ledger)
            } else if arming.overtaken {
                Err(Refused::Overtaken)
            } else {
                self.arm(&arming)
            };
            self.refusal = result.err().map_or(0, Refused::code);
        }
        if arm {
            let asked = if disarm { Err(Refused::Overtaken) } else { self.ask(inputs) };
            self.refusal = asked.err().map_or(0, Refused::code);
        }
    }

    /// Looks whether the part may be armed; if so, has it written into the ledger first.
    fn ask(&mut self, inputs: &Inputs) -> Result<(), Refused> {
        if self.arming.is_some() {
            return Err(Refused::Busy);
        }
        if !inputs.switches.has(Switches::ENABLE) {
            return Err(Refused::NotEnabled);
        }
        if !inputs.switches.has(Switches::TRIVIAL_KINEMATICS) {
            return Err(Refused::Kinematics);
        }
        if inputs.motion_type == PROBING {
            return Err(Refused::Probing);
        }
        let Some(&frame) = self.frame.update(inputs) else {
            return Err(Refusal::FrameDamaged { stored: 0, computed: 0 }.into());
        };
        let binding = Binding {
            program_crc: inputs.program_crc,
            feature: inputs.feature,
            pass: inputs.pass,
            // Negative ones are no numbers of a tool; an image has none of them.
            tool: u32::try_from(inputs.tool).unwrap_or(u32::MAX),
            tool_offset: u32::try_from(inputs.tool_offset).unwrap_or(u32::MAX),
            setup: inputs.setup,
        };
        let request = ArmRequest { binding, part_serial: inputs.part_serial, frame };
        let mut trial = self.state;
        self.rewriter().arm(&mut trial, &request)?;
        let part = trial.spent().last().ok_or(Refused::Ledger)?;
        self.ends.spending.send(part).map_err(|_| Refused::Busy)?;
        self.arming = Some(Arming { request, running: Running::of(inputs), overtaken: false });
        Ok(())
    }

    fn arm(&mut self, arming: &Arming) -> Result<(), Refused> {
        let rewriter = self.loaded.as_ref().map_or(&self.bare, |l| &l.rewriter);
        rewriter.arm(&mut self.state, &arming.request)?;
        self.armed_serial = arming.request.part_serial;
        self.running = Some(arming.running);
        Ok(())
    }

    fn rewriter(&self) -> &Rewriter<'static> {
        self.loaded.as_ref().map_or(&self.bare, |loaded| &loaded.rewriter)
    }

    #[inline(never)]
    fn tick(&mut self, setpoint: &Setpoint) -> Output {
        let rewriter = self.loaded.as_ref().map_or(&self.bare, |loaded| &loaded.rewriter);
        rewriter.tick(&mut self.state, setpoint)
    }

    fn acknowledge(&mut self) {
        let rewriter = self.loaded.as_ref().map_or(&self.bare, |loaded| &loaded.rewriter);
        // Refused in the period in which the drives are still said to be on.
        let _ = rewriter.acknowledge_drives_disabled(&mut self.state);
    }

    /// A position that is no length goes on as it is: a correction that is on goes with the drives, because there is
    /// nothing it could follow.
    #[cold]
    fn pass(&mut self, inputs: &Inputs, flags: Flags, outputs: &mut Outputs) {
        let rewriter = self.loaded.as_ref().map_or(&self.bare, |loaded| &loaded.rewriter);
        match self.state.mode() {
            Mode::Armed => rewriter.break_off(&mut self.state, Reason::Jump),
            Mode::Off | Mode::Bypass => {}
            Mode::Active | Mode::Hold | Mode::Fault => rewriter.power_off(&mut self.state, Reason::Jump),
        }
        let output = Output {
            axes: [0; AXES],
            correction_nm: [0; AXES],
            forward: self.state.mode() != Mode::Off,
            mode: self.state.mode(),
            reason: self.state.reason(),
            status: Status::default(),
            place: self.state.place(),
            sequence: self.sequence,
        };
        self.put(inputs, flags, &output, outputs);
    }

    /// The output of the core for the pins. In `Off` the correction that was on stays until the drives are off: their
    /// enable is dropped, and none of them is to jump by it on the way.
    fn put(&mut self, inputs: &Inputs, flags: Flags, output: &Output, outputs: &mut Outputs) {
        if output.mode != Mode::Off || !inputs.switches.has(Switches::DRIVES_ON) {
            self.correction_nm = output.correction_nm;
        }
        self.shift.put(inputs, &self.correction_nm, outputs);
        // After an acknowledgement the state is already that of the next period.
        outputs.state = self.state.mode() as u32;
        outputs.reason = self.state.reason().code().into();
        outputs.fault = self.state.reason().is_fault().into();
        outputs.status = output.status.0.into();
        outputs.refusal = self.refusal;
        outputs.forward = output.forward.into();
        outputs.armed_serial = self.armed_serial;
        let image = self.loaded.as_ref().and_then(|loaded| loaded.rewriter.image());
        outputs.image_ready = image.is_some().into();
        outputs.image_crc = image.map_or(0, |image| image.crc());
        outputs.node = output.place.node;
        outputs.sequence = self.sequence;
        outputs.flags = flags.0.into();
        let out = outputs.correction_nm == [0; 3] && matches!(output.mode, Mode::Off | Mode::Bypass | Mode::Armed);
        outputs.feed_inhibit = (inputs.motion_type == PROBING && !out).into();
    }
}
