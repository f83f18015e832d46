//! The device's end of the setpoint link: what becomes of a frame, when an answer is withheld, when silence drops the
//! drives. A state machine without I/O and clock; `docs/link.md` has its table, `docs/safety.md` what follows for the
//! axes.
//!
//! Called once a tick: [`Endpoint::packet`] or [`Endpoint::frame`] when a frame has arrived, then
//! [`Endpoint::answer_packet`] or [`Endpoint::answer`], and [`Endpoint::watch`] from a timer at least every
//! millisecond. Commands of the operator go through here as well, so that nothing else touches the state.
//!
//! A tick whose answer is withheld has been made: the correction of the next answer has moved by what two ticks
//! permit, in the time of two ticks. Ticks without an answer count like lost ones, and more of them in a row than
//! `max_lost_frames` end the correction, because the drives then stood still on old positions.

use super::answer::{write, write_packet};
use super::counters::Counters;
use super::error::LinkError;
use super::setpoint::SetpointFrame;
use super::settings::DeviceSettings;
use super::stuffing::unstuff;
use crate::rewrite::{AXES, Mode, Output, Place, Reason, Rewriter, SPENT_CAPACITY, Setpoint, Spent, State, Status};

mod command;

/// Sequences before the last accepted one that are taken for late frames and not for another count.
pub const BEHIND: u32 = 63;
/// So many refused frames in a row that follow each other are the controller counting anew, not late ones.
pub const RESTART_AFTER: u32 = 4;

/// Before the first tick.
const NOTHING: Output = Output {
    axes: [0; AXES],
    correction_nm: [0; AXES],
    forward: false,
    mode: Mode::Off,
    reason: Reason::None,
    status: Status(0),
    place: Place { node: 0, fraction: 0 },
    sequence: 0,
};

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The next sequence, or the first one: the tick was made.
    Accepted,
    /// As many frames are missing before this one, not more than permitted: the tick was made.
    Lost(u32),
    /// A larger gap, or the controller counts anew: the tick was made, nothing stays armed or active.
    Jump,
    /// The sequence of the last accepted frame. Nothing was done.
    Repeated,
    /// One of the [`BEHIND`] sequences before the last accepted one. Nothing was done.
    OutOfOrder,
    /// Not a frame of this link, or not as it was sent. Nothing was done.
    Damaged(LinkError),
}

impl Verdict {
    /// Whether the tick was made, so that there is an answer.
    pub const fn is_accepted(self) -> bool {
        matches!(self, Self::Accepted | Self::Lost(_) | Self::Jump)
    }
}

/// State of the rewriter, sequence, counters.
#[derive(Clone, Debug)]
pub struct Endpoint {
    state: State,
    settings: DeviceSettings,
    counters: Counters,
    /// Sequence of the last accepted frame.
    last: Option<u32>,
    /// When it arrived, µs.
    heard_us: u64,
    /// The output of the last tick, and when its frame arrived while its answer is due.
    output: Output,
    due_us: Option<u64>,
    /// Ticks since the last answer, lost ones included.
    unanswered: u32,
    /// Sequence of the last refused frame, and how many such followed each other.
    stray: (u32, u32),
    /// A fault that has not been asked for.
    fault: Option<Reason>,
}

impl Endpoint {
    /// After power-up or reset: `Off`, with the armed passes of parts from before, newest first.
    ///
    /// The settings must have passed [`DeviceSettings::check`].
    pub fn new(settings: DeviceSettings, spent: [Option<Spent>; SPENT_CAPACITY]) -> Self {
        Self {
            state: State::remembering(spent),
            settings,
            counters: Counters::default(),
            last: None,
            heard_us: 0,
            output: NOTHING,
            due_us: None,
            unanswered: 0,
            stray: (0, 0),
            fault: None,
        }
    }

    /// A packet of a byte stream, as the deframer gives it, that was complete at `arrived_us`.
    #[inline]
    pub fn packet(&mut self, rewriter: &Rewriter<'_>, packet: &mut [u8], arrived_us: u64) -> Verdict {
        match unstuff(packet) {
            Some(raw) => self.frame(rewriter, raw, arrived_us),
            None => self.damaged(LinkError::Stuffing),
        }
    }

    /// A frame as it travels on SPI, that was complete at `arrived_us`.
    #[inline]
    pub fn frame(&mut self, rewriter: &Rewriter<'_>, raw: &[u8], arrived_us: u64) -> Verdict {
        match SetpointFrame::decode(raw, self.settings.axes) {
            Ok(setpoint) => self.setpoint(rewriter, &setpoint, arrived_us),
            Err(error) => self.damaged(error),
        }
    }

    /// Counts a packet that could not even be collected.
    #[inline]
    pub fn damaged(&mut self, error: LinkError) -> Verdict {
        Counters::one_more(&mut self.counters.damaged);
        Verdict::Damaged(error)
    }

    #[inline]
    fn setpoint(&mut self, rewriter: &Rewriter<'_>, setpoint: &Setpoint, arrived_us: u64) -> Verdict {
        let most = rewriter.settings().max_lost_frames;
        let verdict = self.judge(setpoint.sequence, most);
        let missing = match verdict {
            Verdict::Repeated => {
                Counters::one_more(&mut self.counters.repeated);
                return verdict;
            }
            Verdict::OutOfOrder => {
                Counters::one_more(&mut self.counters.out_of_order);
                return verdict;
            }
            Verdict::Lost(missing) => {
                self.counters.lost = self.counters.lost.saturating_add(missing);
                missing
            }
            Verdict::Jump => {
                Counters::one_more(&mut self.counters.jumps);
                u32::MAX
            }
            Verdict::Accepted | Verdict::Damaged(_) => 0,
        };
        Counters::one_more(&mut self.counters.accepted);
        self.stray = (0, 0);
        self.last = Some(setpoint.sequence);
        self.heard_us = arrived_us;
        if self.due_us.is_some() {
            self.withhold();
        }
        self.unanswered = self.unanswered.saturating_add(missing);
        let before = self.state.reason();
        if self.unanswered > most {
            rewriter.break_off(&mut self.state, Reason::SequenceBroken);
        }
        self.output = rewriter.tick(&mut self.state, setpoint);
        self.due_us = Some(arrived_us);
        let reason = self.output.reason;
        if reason != before && reason.is_fault() {
            self.note(reason);
        }
        verdict
    }

    /// The verdict on a sequence.
    #[inline]
    fn judge(&mut self, sequence: u32, most: u32) -> Verdict {
        let Some(last) = self.last else {
            return Verdict::Accepted;
        };
        let ahead = sequence.wrapping_sub(last);
        if ahead == 1 {
            return Verdict::Accepted;
        }
        let missing = ahead.wrapping_sub(1);
        if ahead != 0 && missing <= most {
            return Verdict::Lost(missing);
        }
        if ahead.wrapping_neg() > BEHIND {
            return Verdict::Jump;
        }
        let (before, run) = self.stray;
        let run = if run > 0 && sequence.wrapping_sub(before) == 1 { run.wrapping_add(1) } else { 1 };
        self.stray = (sequence, run);
        if run >= RESTART_AFTER {
            Verdict::Jump
        } else if ahead == 0 {
            Verdict::Repeated
        } else {
            Verdict::OutOfOrder
        }
    }

    /// The answer to the last accepted frame as it travels on SPI; gives its bytes. `None` when there is none to
    /// give, when it is later than the deadline (counted), or when `raw` is too short.
    #[inline]
    pub fn answer(&mut self, now_us: u64, raw: &mut [u8]) -> Option<usize> {
        self.in_time(now_us)?;
        let bytes = write(&self.output, self.settings.axes, raw);
        self.sent(bytes)
    }

    /// The same as it travels on a byte stream, with COBS and the 0x00 at its end.
    #[inline]
    pub fn answer_packet(&mut self, now_us: u64, packet: &mut [u8]) -> Option<usize> {
        self.in_time(now_us)?;
        let bytes = write_packet(&self.output, self.settings.axes, packet);
        self.sent(bytes)
    }

    #[inline]
    fn in_time(&mut self, now_us: u64) -> Option<()> {
        let arrived_us = self.due_us.take()?;
        if now_us.saturating_sub(arrived_us) > u64::from(self.settings.deadline_us) {
            self.withhold();
            return None;
        }
        Some(())
    }

    #[inline]
    fn sent(&mut self, bytes: Result<usize, LinkError>) -> Option<usize> {
        match bytes {
            Ok(bytes) => {
                Counters::one_more(&mut self.counters.answered);
                self.unanswered = 0;
                Some(bytes)
            }
            Err(_) => {
                self.withhold();
                None
            }
        }
    }

    /// An answer that does not leave in time.
    #[inline]
    fn withhold(&mut self) {
        Counters::one_more(&mut self.counters.late);
        self.unanswered = self.unanswered.saturating_add(1);
    }

    /// Drops the drives when no frame was accepted for too long; says whether it did so now.
    #[inline]
    pub fn watch(&mut self, rewriter: &Rewriter<'_>, now_us: u64) -> bool {
        if self.state.mode() == Mode::Off || !self.is_silent(now_us) {
            return false;
        }
        rewriter.power_off(&mut self.state, Reason::Silence);
        Counters::one_more(&mut self.counters.silences);
        self.note(Reason::Silence);
        // What comes next is a beginning, with any sequence; an answer that was due belongs to the time before.
        self.last = None;
        self.due_us = None;
        self.unanswered = 0;
        true
    }

    #[inline]
    fn is_silent(&self, now_us: u64) -> bool {
        self.last.is_none() || now_us.saturating_sub(self.heard_us) >= u64::from(self.settings.silence_us)
    }

    #[inline]
    fn note(&mut self, reason: Reason) {
        self.counters.fault(reason);
        self.fault = Some(reason);
    }
}
