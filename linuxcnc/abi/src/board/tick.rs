//! One tick of the controller's end, and the state that stays between ticks.

use truepath_core::link::{Deframer, Framed, MAX_ANSWER_BYTES, MAX_SETPOINT_BYTES, SetpointFrame, unstuff};
use truepath_core::rewrite::{AXES, Flags, Limits, Mode, Output, Setpoint, Status};

use super::answer::{Counters, Fault, Verdict, judge};
use super::follow::Follower;
use super::settings::{BoardSettings, BoardSettingsError};

/// Ticks in a row without an answer over which the last correction is held.
pub const HOLD_TICKS: u32 = 2;
/// Right answers in a row, with the drives off, after which a lost link is there again.
pub const RECOVERY_TICKS: u32 = 8;
/// Bytes that are looked at in one tick: eight answers of six axes. What is behind them waits for the next tick.
pub const BYTES_A_TICK: usize = 784;
/// Room for the bytes to send in one tick: a 0x00 that clears the line, COBS, the frame, 0x00.
pub const PACKET_BYTES: usize = MAX_SETPOINT_BYTES + 3;

/// Why the link counts as lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Cause {
    /// It does not.
    None = 0,
    /// No answer came yet since the start.
    Start = 1,
    /// More than [`HOLD_TICKS`] ticks in a row without a right answer.
    Silence = 2,
    /// The board went to `Off` (reset, silence) while a correction was on.
    BoardOff = 3,
    /// The port failed.
    Port = 4,
    /// There was no setpoint to send: a position was no length.
    Setpoint = 5,
}

/// What goes to the drives in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Driven {
    /// To be added to the commanded position of each axis, nm.
    pub correction_nm: [i32; AXES],
    /// Whether the drive enable may be passed on.
    pub enable: bool,
    /// Whether the answer of this tick came.
    pub answered: bool,
    /// Why the link is lost.
    pub cause: Cause,
    /// The last right answer; before the first one that of a board in `Off`.
    pub board: Output,
    /// Warnings of that answer, with those of this end: lagging while the correction catches up, joint limited.
    pub status: Status,
    /// Flags of the setpoint that was sent.
    pub flags: Flags,
    /// Its sequence.
    pub sequence: u32,
}

/// The controller's end.
#[derive(Clone, Debug)]
pub struct Board {
    settings: BoardSettings,
    follower: Follower,
    deframer: Deframer<{ MAX_ANSWER_BYTES + 1 }>,
    counters: Counters,
    /// The setpoint of this tick, and whether its drives are on.
    setpoint: Setpoint,
    drives_on: bool,
    /// What came in answer to it: the first one counts.
    answer: Option<Verdict>,
    /// Bytes that may still be looked at in this tick.
    room: usize,
    /// The last frame went out in part only, or not at all.
    cut_off: bool,
    cause: Cause,
    /// Ticks in a row without a right answer; while lost, right ones in a row.
    missed: u32,
    good: u32,
    last: Output,
}

impl Board {
    /// Before the first tick: nothing was heard, so the link is lost.
    ///
    /// # Errors
    /// A setting is out of range.
    pub fn new(settings: BoardSettings) -> Result<Self, BoardSettingsError> {
        let limits = settings.checked()?;
        let limits = Limits::new(&limits, settings.tick_hz).map_err(BoardSettingsError::Limits)?;
        Ok(Self {
            follower: Follower::new(limits, settings.clamp_nm, settings.joint_limits_nm),
            settings,
            deframer: Deframer::new(),
            counters: Counters::default(),
            setpoint: Setpoint::default(),
            drives_on: false,
            answer: None,
            room: 0,
            cut_off: true,
            cause: Cause::Start,
            missed: 0,
            good: 0,
            last: Output::NONE,
        })
    }

    /// Begins a tick: gives the bytes to send. The sequence is counted here, one more each tick. `drives_on`: whether
    /// any drive may be enabled. On a lost link the board is told that none is.
    pub fn begin(&mut self, setpoint: &Setpoint, drives_on: bool, packet: &mut [u8; PACKET_BYTES]) -> usize {
        let sequence = self.setpoint.sequence.wrapping_add(1);
        self.drives_on = drives_on;
        let flags = if self.cause == Cause::None {
            setpoint.flags
        } else {
            Flags(setpoint.flags.0 & !Flags::DRIVES_ENABLED.0).with(Flags::ABORT)
        };
        self.setpoint = Setpoint { sequence, flags, ..*setpoint };
        self.answer = None;
        self.room = BYTES_A_TICK;
        let frame = SetpointFrame { axes: self.settings.axes, setpoint: self.setpoint };
        let lead = usize::from(self.cut_off);
        // A frame of checked axes fits; without one nothing is sent, and the tick stays without an answer.
        let bytes = packet.get_mut(lead..).map_or(0, |room| frame.encode_packet(room).unwrap_or(0));
        if let (true, Some(first)) = (self.cut_off, packet.first_mut()) {
            *first = 0;
        }
        self.cut_off = bytes == 0;
        bytes.wrapping_add(lead)
    }

    /// The bytes of this tick could not be sent as a whole: the next ones begin by clearing the line.
    pub fn not_sent(&mut self) {
        self.cut_off = true;
    }

    /// The port failed: the link is lost at once, as a drive would be.
    pub fn port_failed(&mut self) {
        self.cut_off = true;
        self.deframer = Deframer::new();
        self.lose(Cause::Port);
    }

    /// There is nothing to send in this tick: the link is lost at once.
    pub fn no_setpoint(&mut self) {
        self.cut_off = true;
        self.lose(Cause::Setpoint);
    }

    /// Takes bytes as they arrive, no more than [`BYTES_A_TICK`] in a tick; gives how many were taken.
    pub fn take(&mut self, bytes: &[u8]) -> usize {
        let mut rest = bytes.get(..self.room.min(bytes.len())).unwrap_or(&[]);
        let taken = rest.len();
        self.room = self.room.wrapping_sub(taken);
        let Self { deframer, counters, setpoint, settings, answer, .. } = self;
        while let Some(framed) = deframer.feed(&mut rest) {
            let raw = match framed {
                Framed::Packet(packet) => unstuff(packet),
                Framed::Overlong => None,
            };
            let Some(raw) = raw else {
                Counters::one_more(&mut counters.damaged);
                continue;
            };
            match judge(raw, settings.axes, setpoint, settings.clamp_nm) {
                Verdict::Damaged(_) => Counters::one_more(&mut counters.damaged),
                Verdict::Late => Counters::one_more(&mut counters.late),
                Verdict::Wrong(Fault::Sequence) => Counters::one_more(&mut counters.wrong),
                verdict => {
                    if matches!(verdict, Verdict::Wrong(_)) {
                        Counters::one_more(&mut counters.wrong);
                    }
                    // A second one is not better than the first.
                    answer.get_or_insert(verdict);
                }
            }
        }
        taken
    }

    /// How many bytes may still be looked at in this tick; 0 when none need to be waited for any more.
    pub const fn room(&self) -> usize {
        if self.answer.is_some() { 0 } else { self.room }
    }

    /// Ends the tick: what goes to the drives.
    pub fn finish(&mut self) -> Driven {
        let answer = match self.answer.take() {
            Some(Verdict::Answer(output)) => Some(output),
            _ => None,
        };
        match answer {
            Some(output) => {
                Counters::one_more(&mut self.counters.answered);
                self.missed = 0;
                self.last = output;
            }
            None => {
                Counters::one_more(&mut self.counters.missed);
                self.missed = self.missed.saturating_add(1);
            }
        }
        let reached = if self.cause == Cause::None { self.heard(answer) } else { self.lost(answer) };
        let (correction_nm, limited) = self.follower.added(&self.setpoint.axes);
        let mut status = self.last.status.0;
        status |= if reached { 0 } else { Status::LAGGING.0 };
        status |= if limited { Status::JOINT_LIMITED.0 } else { 0 };
        Driven {
            correction_nm,
            enable: self.cause == Cause::None && self.last.forward,
            answered: answer.is_some(),
            cause: self.cause,
            board: self.last,
            status: Status(status),
            flags: self.setpoint.flags,
            sequence: self.setpoint.sequence,
        }
    }

    /// Counters since the start.
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// A tick of a link that is there; says whether the correction is the board's.
    fn heard(&mut self, answer: Option<Output>) -> bool {
        match answer {
            Some(output) if output.forward => self.follower.follow(&output.correction_nm),
            // The board forgot the correction that is on: it must not go in one step.
            Some(_) if self.follower.is_on() => {
                self.lose(Cause::BoardOff);
                false
            }
            Some(_) => true,
            None => {
                if self.missed > HOLD_TICKS {
                    self.lose(Cause::Silence);
                }
                self.follower.stand();
                !self.follower.is_on()
            }
        }
    }

    /// A tick of a link that is lost.
    fn lost(&mut self, answer: Option<Output>) -> bool {
        if self.drives_on {
            self.good = 0;
            return !self.follower.is_on();
        }
        self.follower.drop_all();
        let idle = |output: &Output| matches!(output.mode, Mode::Off | Mode::Bypass);
        self.good = if answer.as_ref().is_some_and(idle) { self.good.saturating_add(1) } else { 0 };
        if self.good >= RECOVERY_TICKS {
            self.cause = Cause::None;
        }
        true
    }

    fn lose(&mut self, cause: Cause) {
        if self.cause == Cause::None {
            Counters::one_more(&mut self.counters.lost);
            self.follower.stand();
        }
        self.cause = cause;
        self.good = 0;
    }
}
