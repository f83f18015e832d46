//! Route B: the correction is computed by a board, and this is what the servo thread does for it.
//!
//! LinuxCNC's pins become the same setpoint as on the other route ([`Signals`], [`WorkFrame`]); it goes out, and what
//! comes back is judged by [`Board`]. Arming, images and the ledger are the board's; truepath-config asks for them over
//! the configuration link. What ends an arming here goes as a flag with the setpoint:
//!
//! | LinuxCNC | flag |
//! |---|---|
//! | pin `enable` or `trivial-kinematics` low, rising edge of `disarm` | program end: disarms, a correction ramps out |
//! | link lost | drives not enabled, abort |
//!
//! What ends an arming is said again in every period until one of them is answered, so that it is not lost with a frame.

use truepath_core::rewrite::{Flags, Mode, Reason, Setpoint};

use crate::board::{Board, BoardSettings, BoardSettingsError, Cause, Counters, Driven, PACKET_BYTES};
use crate::pc::{
    Inputs, JOINTS, Joints, Limits, OfferError, Outputs, PROBING, Running, Shift, Signals, Switches, WorkFrame,
};

/// Why there is no link to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemoteError {
    /// A limit of a joint.
    Limits(OfferError),
    /// The limits of the link.
    Board(BoardSettingsError),
}

impl RemoteError {
    /// Its number: that of an [`OfferError`], or 64 and more: axes, tick rate, clamp, speed or acceleration, joint limits,
    /// a correction that could not move.
    pub const fn code(self) -> u32 {
        match self {
            Self::Limits(error) => error.code(),
            Self::Board(BoardSettingsError::Axes(_)) => 64,
            Self::Board(BoardSettingsError::TickRate(_)) => 65,
            Self::Board(BoardSettingsError::Clamp(_)) => 66,
            Self::Board(BoardSettingsError::Caps) => 67,
            Self::Board(BoardSettingsError::JointLimits { .. }) => 68,
            Self::Board(BoardSettingsError::Limits(_)) => 69,
        }
    }
}

/// The servo side of Route B.
#[derive(Debug)]
pub struct Remote {
    board: Board,
    shift: Shift,
    signals: Signals,
    frame: WorkFrame,
    /// The setpoint of this period; the one before it when a position is no length.
    setpoint: Setpoint,
    /// The switches of the period before.
    before: Switches,
    /// State of the board in the period before.
    mode: Mode,
    armed_serial: u32,
    /// What is armed or on is for this.
    running: Option<Running>,
    /// A correction was on in the last period.
    on: bool,
    /// What ends an arming and was said in periods without an answer.
    unheard: Flags,
}

/// What ends an arming.
const ENDINGS: Flags = Flags::EMERGENCY_STOP.with(Flags::ABORT).with(Flags::TOOL_CHANGE).with(Flags::PROGRAM_END);

impl Remote {
    /// For a machine with these limits; `clamp_nm` is the largest correction that is taken from a board, nm. Divides and
    /// takes roots, so it belongs outside the servo thread.
    ///
    /// # Errors
    /// A limit is missing or out of range.
    pub fn new(limits: &Limits, joints: Joints, period_ns: u32, axes: u8, clamp_nm: u32) -> Result<Self, RemoteError> {
        let machine = limits.settings(&joints, period_ns).map_err(RemoteError::Limits)?;
        let settings = BoardSettings {
            axes,
            tick_hz: machine.tick_hz,
            clamp_nm: i32::try_from(clamp_nm).unwrap_or(i32::MAX),
            slew_nm_per_s: machine.correction_slew_nm_per_s,
            acceleration_nm_per_s2: machine.correction_acceleration_nm_per_s2,
            joint_limits_nm: machine.joint_limits_nm,
        };
        Ok(Self {
            board: Board::new(settings).map_err(RemoteError::Board)?,
            shift: Shift::new(joints),
            signals: Signals::default(),
            frame: WorkFrame::new(),
            setpoint: Setpoint::default(),
            before: Switches::default(),
            mode: Mode::Off,
            armed_serial: 0,
            running: None,
            on: false,
            unheard: Flags::default(),
        })
    }

    /// Before the motion controller: the measured position of each joint without the correction of the last period.
    pub fn feedback(&self, measured: &[f64; JOINTS], plain: &mut [f64; JOINTS]) {
        self.shift.feedback(measured, plain);
    }

    /// Behind the motion controller: the bytes to send. None are sent when a position is no length; the link is lost
    /// then, because there is nothing a correction could be added to.
    pub fn begin(&mut self, pins: &Inputs, packet: &mut [u8; PACKET_BYTES]) -> usize {
        let (inputs, kept) = self.in_unit(pins);
        let inputs = &inputs;
        self.frame.update(inputs);
        let ended = self.signals.flags(inputs, self.mode).with(self.endings(inputs, kept));
        let flags = ended.with(self.unheard);
        self.unheard = Flags(flags.0 & ENDINGS.0);
        let setpoint = self.shift.joints().setpoint(inputs, flags, self.frame.crc(), 0);
        let sent = setpoint.is_some();
        self.setpoint = setpoint.unwrap_or(Setpoint { flags, ..self.setpoint });
        let bytes = self.board.begin(&self.setpoint, inputs.switches.has(Switches::DRIVES_ON), packet);
        if sent {
            return bytes;
        }
        self.board.no_setpoint();
        0
    }

    /// The link, for what happens between begin and finish.
    pub const fn board(&mut self) -> &mut Board {
        &mut self.board
    }

    /// Ends the period: what goes to the drives and to the pins.
    pub fn finish(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> (Driven, &Counters) {
        let driven = self.board.finish();
        let mode = driven.board.mode;
        if mode == Mode::Armed && self.mode != Mode::Armed {
            self.armed_serial = inputs.part_serial;
        }
        self.running = matches!(mode, Mode::Armed | Mode::Active | Mode::Hold)
            .then(|| self.running.unwrap_or_else(|| Running::of(inputs)));
        if driven.answered {
            self.unheard = Flags::default();
        }
        self.mode = mode;
        self.put(inputs, &driven, outputs);
        (driven, self.board.counters())
    }

    /// The pins with the unit that what is armed or on is in, and whether that is the one of the pins.
    fn in_unit(&mut self, pins: &Inputs) -> (Inputs, bool) {
        self.shift.in_unit(pins, matches!(self.mode, Mode::Off | Mode::Bypass) && !self.on)
    }

    /// What ends an arming from this side.
    fn endings(&mut self, inputs: &Inputs, kept: bool) -> Flags {
        let other = self.running.map_or(Flags::default(), |running| running.ended(inputs));
        let unit = if kept { Flags::default() } else { Flags::ABORT };
        self.taken_back(inputs).with(other).with(unit)
    }

    fn taken_back(&mut self, inputs: &Inputs) -> Flags {
        let on = |switch| inputs.switches.has(switch);
        let disarmed = on(Switches::DISARM) && !self.before.has(Switches::DISARM);
        self.before = inputs.switches;
        if disarmed || !on(Switches::ENABLE) || !on(Switches::TRIVIAL_KINEMATICS) {
            Flags::PROGRAM_END
        } else {
            Flags::default()
        }
    }

    fn put(&mut self, inputs: &Inputs, driven: &Driven, outputs: &mut Outputs) {
        self.shift.put(inputs, &driven.correction_nm, outputs);
        self.on = driven.correction_nm != [0; JOINTS];
        let (state, reason) = told(driven);
        *outputs = Outputs {
            motor_pos_cmd: outputs.motor_pos_cmd,
            correction_nm: outputs.correction_nm,
            correction: outputs.correction,
            state: state as u32,
            reason: reason.code().into(),
            fault: reason.is_fault().into(),
            status: driven.status.0.into(),
            refusal: 0,
            forward: driven.enable.into(),
            armed_serial: self.armed_serial,
            image_ready: 0,
            image_crc: 0,
            node: driven.board.place.node,
            sequence: driven.sequence,
            flags: driven.flags.0.into(),
            feed_inhibit: (inputs.motion_type == PROBING
                && (self.on || matches!(self.mode, Mode::Active | Mode::Hold | Mode::Fault)))
            .into(),
        };
    }
}

/// State and reason for the pins: the board's, and of a lost link what it is for the drives.
fn told(driven: &Driven) -> (Mode, Reason) {
    match driven.cause {
        Cause::None | Cause::Start => (driven.board.mode, driven.board.reason),
        Cause::Silence | Cause::BoardOff | Cause::Port | Cause::Setpoint => (Mode::Off, Reason::Silence),
    }
}
