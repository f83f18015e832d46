//! Rules of the setpoint link: which frames may be answered, when, and what gaps and pace end.

use std::collections::VecDeque;

use truepath_core::link::{BEHIND, DeviceSettings, RESTART_AFTER};
use truepath_core::rewrite::{Flags, Output, Setpoint};

use super::verdict::{Verdict, alarm, hold};
use crate::attack::rule::{Alarm, Rule};

/// Frames that may still come out of the cable.
const KEPT: usize = 64;
/// Frames of a window of the pace, and answers within which a whole window lies, wherever it begins.
const WINDOW: usize = 32;
const NOTICED: usize = 2 * WINDOW - 1;

/// A frame that was answered, and what lies between it and the answer before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ticks {
    pub setpoint: Setpoint,
    /// Setpoint of the answer before, if the link has not begun anew since.
    pub before: Option<Setpoint>,
    /// Frames that arrived whole since the answer before, this one included: so many ticks at most.
    pub most: u32,
    /// Sequences from that answer to this one.
    pub ahead: Option<u32>,
    too_fast: bool,
}

impl Ticks {
    /// Whether just one tick was made since the answer before.
    pub const fn is_one(&self) -> bool {
        self.most == 1
    }
}

#[derive(Clone, Debug)]
struct Arrived {
    setpoint: Option<Setpoint>,
    touched: bool,
}

/// The link as seen from outside.
#[derive(Clone, Debug)]
pub(super) struct Link {
    deadline_us: u64,
    silence_us: u64,
    max_lost: u32,
    /// A window of 32 intervals that is shorter is too fast, µs.
    shortest_us: u64,
    /// Bytes since the last delimiter.
    partial: Vec<u8>,
    sent: VecDeque<(Vec<u8>, Setpoint)>,
    arrived: Option<Arrived>,
    arrived_us: u64,
    /// When the last frame that was whole arrived.
    whole_us: Option<u64>,
    /// Frames that arrived whole since the link began.
    whole: u64,
    /// The last answer: setpoint, and the arrival of its frame.
    last: Option<(Setpoint, u64)>,
    /// Frames that arrived whole since, and how the newest of them follow each other.
    since: u32,
    /// Their sequences, but for the one under way.
    hidden: Vec<u32>,
    run: u32,
    run_sequence: u32,
    /// Whether a frame since the last answer, or its own, said that the drives are disabled.
    disabled: bool,
    watched_us: u64,
    /// Arrivals of frames that were answered one after the other.
    answered_us: VecDeque<u64>,
    /// Arrivals of frames that were whole.
    wholes_us: VecDeque<u64>,
    touched: bool,
    hid: bool,
}

impl Link {
    pub fn new(settings: &DeviceSettings) -> Self {
        Self {
            deadline_us: settings.deadline_us.into(),
            silence_us: settings.silence_us.into(),
            max_lost: settings.rewriter.max_lost_frames,
            shortest_us: shortest_us(settings),
            partial: vec![],
            sent: VecDeque::new(),
            arrived: None,
            arrived_us: 0,
            whole_us: None,
            whole: 0,
            last: None,
            since: 0,
            hidden: vec![],
            run: 0,
            run_sequence: 0,
            disabled: false,
            watched_us: 0,
            answered_us: VecDeque::new(),
            wholes_us: VecDeque::new(),
            touched: false,
            hid: false,
        }
    }

    /// Other settings: the pace is to be known anew.
    pub fn configured(&mut self, settings: &DeviceSettings) {
        self.deadline_us = settings.deadline_us.into();
        self.silence_us = settings.silence_us.into();
        self.max_lost = settings.rewriter.max_lost_frames;
        self.shortest_us = shortest_us(settings);
        self.whole = 0;
        self.answered_us.clear();
        self.wholes_us.clear();
    }

    pub fn sent(&mut self, packet: &[u8], setpoint: &Setpoint) {
        let content = packet.strip_suffix(&[0]).unwrap_or(packet);
        self.sent.push_back((content.to_vec(), *setpoint));
        if self.sent.len() > KEPT {
            self.sent.pop_front();
        }
    }

    pub fn delivered(&mut self, bytes: &[u8], now_us: u64, touched: bool) {
        self.arrived = None;
        self.partial.extend_from_slice(bytes);
        if self.partial.pop_if(|last| *last == 0).is_none() {
            return;
        }
        let piece = std::mem::take(&mut self.partial);
        if piece.is_empty() {
            return;
        }
        let whole = self.sent.iter().rev().find(|(content, _)| *content == piece).map(|(_, setpoint)| *setpoint);
        self.arrived_us = now_us;
        self.arrived = Some(Arrived { setpoint: whole, touched });
        if let Some(setpoint) = whole {
            self.whole_us = Some(now_us);
            self.whole += 1;
            self.since += 1;
            let follows = setpoint.sequence.wrapping_sub(self.run_sequence) == 1;
            self.run = if follows { self.run + 1 } else { 1 };
            self.run_sequence = setpoint.sequence;
            self.disabled |= !setpoint.flags.has(Flags::DRIVES_ENABLED);
            remember(&mut self.wholes_us, now_us);
        }
    }

    pub fn unanswered(&mut self) {
        if let Some(Arrived { setpoint: Some(setpoint), .. }) = self.arrived.take() {
            self.answered_us.clear();
            self.hidden.push(setpoint.sequence);
        }
    }

    /// An answer: what it is to; none when no frame was under way.
    pub fn answered(&mut self, output: &Output, at_us: u64) -> Result<Option<Ticks>, Box<Alarm>> {
        let Some(Arrived { setpoint, touched }) = self.arrived.take() else { return Ok(None) };
        let Some(setpoint) = setpoint.filter(|setpoint| setpoint.sequence == output.sequence) else {
            alarm(Rule::Damaged, format!("sequence {} is answered, and no such frame arrived whole", output.sequence))?;
            return Ok(None);
        };
        self.touched = touched;
        self.hid = self.since > 1;
        let ahead = self.last.map(|(before, _)| setpoint.sequence.wrapping_sub(before.sequence));
        if let Some(behind) = ahead.map(u32::wrapping_neg).filter(|&behind| behind <= BEHIND) {
            // A controller that counts anew is heard after some frames in a row, and so is one after a silence. A frame
            // whose answer was withheld may have been followed: then it counts from there.
            let quiet = self.last.is_some_and(|(_, us)| self.watched_us.saturating_sub(us) >= self.silence_us);
            let from_hidden = self.hidden.iter().any(|hidden| hidden.wrapping_sub(setpoint.sequence) > BEHIND);
            hold(self.run >= RESTART_AFTER || quiet || from_hidden, Rule::Old, || {
                format!("sequence {} is answered {behind} behind the last one", output.sequence)
            })?;
        }
        let delay_us = at_us.saturating_sub(self.arrived_us);
        hold(delay_us <= self.deadline_us, Rule::Late, || {
            format!("answered after {delay_us} us, the deadline is {} us", self.deadline_us)
        })?;
        remember(&mut self.answered_us, self.arrived_us);
        let ticks = Ticks {
            setpoint,
            before: self.last.map(|(before, _)| before),
            most: self.since,
            ahead,
            too_fast: self.is_too_fast(),
        };
        self.last = Some((setpoint, self.arrived_us));
        (self.since, self.run) = (0, 0);
        self.hidden.clear();
        self.disabled = !setpoint.flags.has(Flags::DRIVES_ENABLED);
        Ok(Some(ticks))
    }

    /// What is armed or on goes on behind an answer: no gap beyond the limit lies before it, and the pace is permitted.
    pub fn may_go_on(&self, ticks: &Ticks) -> Verdict {
        if let Some(ahead) = ticks.ahead {
            let missing = ahead.wrapping_sub(1);
            hold(missing <= self.max_lost, Rule::Gap, || {
                format!("{missing} setpoints without an answer in a row, {} permitted", self.max_lost)
            })?;
        }
        hold(!ticks.too_fast, Rule::Pace, || format!("32 intervals in less than {} us, all the time", self.shortest_us))
    }

    /// Whether every window of 32 intervals among the last 63 is too short.
    fn is_too_fast(&self) -> bool {
        let at = |k: usize| self.answered_us.get(k).copied().unwrap_or(0);
        self.answered_us.len() > NOTICED && (0..WINDOW).all(|k| at(k + WINDOW).saturating_sub(at(k)) < self.shortest_us)
    }

    /// Whether the pace can be known: 33 frames have come, and not all windows among the last 63 intervals were too short.
    pub fn may_know_pace(&self) -> bool {
        let at = |k: usize| self.wholes_us.get(k).copied().unwrap_or(0);
        let known = self.wholes_us.len() > NOTICED;
        let fast = known && (0..WINDOW).all(|k| at(k + WINDOW).saturating_sub(at(k)) < self.shortest_us);
        self.whole > WINDOW as u64 && !fast
    }

    /// The pace in words.
    pub fn pace(&self) -> String {
        let took_us = self.wholes_us.back().zip(self.wholes_us.front()).map_or(0, |(to, from)| to - from);
        format!("{} frames since the link began, the last {} in {took_us} us", self.whole, self.wholes_us.len())
    }

    pub fn watched(&mut self, now_us: u64) {
        self.watched_us = now_us;
        if self.is_silent(now_us) {
            self.begin();
        }
    }
    pub fn is_silent(&self, now_us: u64) -> bool {
        self.quiet_us(now_us) >= self.silence_us
    }
    pub fn quiet_us(&self, now_us: u64) -> u64 {
        self.whole_us.map_or(u64::MAX, |us| now_us.saturating_sub(us))
    }
    /// Whether setpoints come, and one of them may have said that the drives are disabled.
    pub fn said_disabled(&self, now_us: u64) -> bool {
        !self.is_silent(now_us) && self.disabled
    }
    /// Whether a tick without an answer may lie between the last two answers.
    pub const fn hid_ticks(&self) -> bool {
        self.hid
    }
    /// Whether the cable had changed what the last answered frame came with.
    pub const fn was_touched(&self) -> bool {
        self.touched
    }

    pub fn reset(&mut self) {
        self.partial.clear();
        self.begin();
        self.whole_us = None;
    }
    /// What comes next is a beginning.
    fn begin(&mut self) {
        self.last = None;
        (self.whole, self.since, self.run) = (0, 0, 0);
        self.hidden.clear();
        self.disabled = false;
        self.answered_us.clear();
        self.wholes_us.clear();
    }
}

/// Two thirds of 32 nominal intervals, less what whole microseconds hide.
fn shortest_us(settings: &DeviceSettings) -> u64 {
    (64_000_000 / (3 * u64::from(settings.rewriter.tick_hz))).saturating_sub(1)
}

fn remember(times: &mut VecDeque<u64>, us: u64) {
    times.push_back(us);
    if times.len() > NOTICED + 1 {
        times.pop_front();
    }
}
