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
//!
//! All limits are kept per tick; they hold per second only while frames come at the rate of the settings. The pace of
//! accepted frames is therefore measured: nothing is armed before it is known, and too fast a pace ends the correction.

use super::counters::Counters;
use super::error::LinkError;
use super::setpoint::SetpointFrame;
use super::settings::DeviceSettings;
use super::stuffing::unstuff;
use crate::rewrite::{Mode, Output, Reason, Rewriter, Setpoint, SpentList, State};

mod command;
mod pace;
mod reply;

use pace::Pace;

pub use pace::RESTART_AFTER;

/// Sequences before the last accepted one that are taken for late frames and not for another count.
pub const BEHIND: u32 = 63;
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

/// Refused frames that follow each other.
#[derive(Clone, Copy, Debug, Default)]
struct Stray {
    /// Sequence of the last one.
    sequence: u32,
    /// How many there are.
    run: u32,
    /// When the first one arrived, µs.
    since_us: u64,
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
    /// What they were before the last answer, until that is withdrawn.
    given: Option<u32>,
    stray: Stray,
    pace: Pace,
    /// A fault that has not been asked for.
    fault: Option<Reason>,
}

impl Endpoint {
    /// After power-up or reset: `Off`, with the armed passes of parts from before.
    ///
    /// The settings must have passed [`DeviceSettings::check`].
    pub fn new(settings: DeviceSettings, spent: SpentList) -> Self {
        Self {
            state: State::remembering(spent),
            settings,
            counters: Counters::default(),
            last: None,
            heard_us: 0,
            output: Output::NONE,
            due_us: None,
            unanswered: 0,
            given: None,
            stray: Stray::default(),
            pace: Pace::new(settings.rewriter.tick_hz),
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
        let verdict = self.judge(setpoint.sequence, most, arrived_us);
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
        self.stray.run = 0;
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
        if verdict == Verdict::Jump {
            self.pace.forget();
        } else if self.pace.is_too_fast(arrived_us) {
            rewriter.break_off(&mut self.state, Reason::FrameRate);
        }
        rewriter.tick_into(&mut self.state, setpoint, &mut self.output);
        self.due_us = Some(arrived_us);
        let reason = self.output.reason;
        if reason != before && reason.is_fault() {
            self.note(reason);
        }
        verdict
    }

    /// The verdict on a sequence.
    #[inline]
    fn judge(&mut self, sequence: u32, most: u32, arrived_us: u64) -> Verdict {
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
        if self.stray.run > 0 && sequence.wrapping_sub(self.stray.sequence) == 1 {
            self.stray.run = self.stray.run.wrapping_add(1);
        } else {
            self.stray = Stray { sequence, run: 1, since_us: arrived_us };
        }
        self.stray.sequence = sequence;
        // Old frames in a burst follow each other as well, but at no controller's pace, or between good ones.
        let silent_us = arrived_us.saturating_sub(self.heard_us);
        let taken_us = arrived_us.saturating_sub(self.stray.since_us);
        if self.stray.run >= RESTART_AFTER && self.pace.is_restart(silent_us, taken_us) {
            Verdict::Jump
        } else if ahead == 0 {
            Verdict::Repeated
        } else {
            Verdict::OutOfOrder
        }
    }

    /// Drops the drives when no frame was accepted for too long; says whether it did so now. In `Off` too the link begins
    /// anew then.
    #[inline]
    pub fn watch(&mut self, rewriter: &Rewriter<'_>, now_us: u64) -> bool {
        if !self.is_silent(now_us) {
            return false;
        }
        // What comes next is a beginning, with any sequence; an answer that was due belongs to the time before.
        self.forget();
        if self.state.mode() == Mode::Off {
            return false;
        }
        rewriter.power_off(&mut self.state, Reason::Silence);
        Counters::one_more(&mut self.counters.silences);
        self.note(Reason::Silence);
        true
    }

    /// The link begins anew.
    #[inline]
    fn forget(&mut self) {
        self.last = None;
        self.due_us = None;
        self.unanswered = 0;
        self.given = None;
        self.stray = Stray::default();
        self.pace.forget();
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
