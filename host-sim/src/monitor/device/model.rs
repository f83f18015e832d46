//! What the view of a device knows; messages and keys change it.

use std::time::Duration;

use truepath_core::image::{Image, NODE_BYTES, SIGNATURE_BYTES, image_bytes};
use truepath_core::link::{DeviceStatus, Slot, Timing, TraceSample};
use truepath_core::rewrite::{Reason, Status};

use crate::coprocessor::Info;
use crate::monitor::counts::Row;
use crate::monitor::growth::{Count, Growth};
use crate::monitor::history::History;
use crate::monitor::screen::Key;
use crate::monitor::state::InWords;

/// An image whose file was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its name.
    pub crc: u32,
    /// Largest correction, nm.
    pub clamp_nm: u32,
}

impl Known {
    /// Of an image.
    pub fn of(image: &Image<'_>) -> Self {
        let clamp = image.settings().limits.clamp.nm();
        Self { crc: image.crc(), clamp_nm: u32::try_from(clamp).unwrap_or(u32::MAX) }
    }
}

/// What changes the view.
#[derive(Clone, Debug)]
pub enum Message {
    /// Who is there, and what the slots hold.
    Identity {
        /// Who.
        info: Box<Info>,
        /// What.
        slots: [Slot; 2],
    },
    /// An answer.
    Look {
        /// When it arrived, since the start of the view.
        at: Duration,
        /// Mode, reason, counters.
        status: Box<DeviceStatus>,
        /// Samples dropped before those that were fetched.
        dropped: u32,
        /// Samples since the look before. Empty after a connection was made: their age is not known then.
        samples: Vec<TraceSample>,
        /// How regularly setpoints arrive; nothing of a firmware that does not count it.
        timing: Option<Box<Timing>>,
        /// Time from question to answer.
        round_trip: Duration,
    },
    /// No answer.
    Silent {
        /// Why.
        why: String,
    },
}

/// Counters of the setpoint link, of the configuration link, and of faults.
const COUNTERS: usize = 11 + Reason::FAULTS;
/// Names of the first, and whether they are of trouble.
const NAMES: [(&str, bool); 11] = [
    ("accepted", false),
    ("answered", false),
    ("damaged", true),
    ("repeated", true),
    ("out of order", true),
    ("lost", true),
    ("jumps", true),
    ("late", true),
    ("silences", true),
    ("requests", false),
    ("req. damaged", true),
];
/// So long after a look is due the device counts as lost.
const GRACE: Duration = Duration::from_millis(1_000);
/// So long without samples they are not those of now.
const FRESH: Duration = Duration::from_millis(1_500);
/// The worst round trip is that of so long.
const WORST_OF: Duration = Duration::from_secs(10);
/// A restart is told for so long.
const TOLD: Duration = Duration::from_secs(60);

/// The view of a device.
#[derive(Clone, Debug)]
pub struct ViewModel {
    pub(super) port: String,
    pub(super) identity: Option<(Info, [Slot; 2])>,
    pub(super) status: Option<DeviceStatus>,
    pub(super) failure: Option<String>,
    pub(super) newest: Option<(Duration, TraceSample)>,
    /// Flags of all samples of a look, for as long as they are of now: one in a single sample can be read.
    flagged: std::collections::VecDeque<(Duration, Status)>,
    pub(super) dropped: u64,
    pub(super) round_trip: Duration,
    pub(super) timing: Option<Timing>,
    pub(super) help: bool,
    known: Option<Known>,
    every: Duration,
    answered_at: Option<Duration>,
    restarted_at: Option<Duration>,
    history: History,
    /// History and time of a pause.
    paused: Option<(Duration, History)>,
    growth: Growth<COUNTERS>,
    round_trips: std::collections::VecDeque<(Duration, Duration)>,
}

impl ViewModel {
    /// Before the first answer; `every` is the time between two looks.
    pub fn new(port: String, every: Duration, known: Option<Known>) -> Self {
        Self {
            port,
            identity: None,
            status: None,
            failure: None,
            newest: None,
            flagged: std::collections::VecDeque::new(),
            dropped: 0,
            round_trip: Duration::ZERO,
            timing: None,
            help: false,
            known,
            every,
            answered_at: None,
            restarted_at: None,
            history: History::default(),
            paused: None,
            growth: Growth::default(),
            round_trips: std::collections::VecDeque::new(),
        }
    }

    /// Takes a message.
    pub fn update(&mut self, message: Message) {
        match message {
            Message::Identity { info, slots } => self.identity = Some((*info, slots)),
            Message::Silent { why } => self.failure = Some(why),
            Message::Look { at, status, dropped, samples, timing, round_trip } => {
                if self.status.is_some_and(|before| status.uptime_us < before.uptime_us) {
                    self.restarted_at = Some(at);
                }
                self.history.take(self.answered_at.unwrap_or(at), at, dropped, &samples);
                if let Some(newest) = samples.last() {
                    self.newest = Some((at, *newest));
                }
                self.flagged
                    .push_back((at, samples.iter().fold(Status(0), |all, sample| Status(all.0 | sample.status.0))));
                let old = self.old();
                while self.flagged.front().is_some_and(|(then, _)| *then + old < at) {
                    self.flagged.pop_front();
                }
                self.dropped += u64::from(dropped);
                self.timing = timing.map(|timing| *timing);
                self.growth.take(at, counters(&status));
                self.round_trips.push_back((at, round_trip));
                while self.round_trips.front().is_some_and(|(then, _)| *then + WORST_OF < at) {
                    self.round_trips.pop_front();
                }
                (self.round_trip, self.status, self.answered_at, self.failure) =
                    (round_trip, Some(*status), Some(at), None);
            }
        }
    }

    /// Takes a key; whether the view is left.
    pub fn press(&mut self, key: Key, now: Duration) -> bool {
        match key {
            Key::Leave => return true,
            Key::Back if self.help => self.help = false,
            Key::Back => return true,
            Key::Help => self.help = !self.help,
            Key::Clear => {
                self.history.clear();
                self.growth.clear();
                self.round_trips.clear();
                (self.paused, self.dropped) = (None, 0);
            }
            Key::Pause => {
                self.paused = if self.paused.is_some() { None } else { Some((now, self.history.clone())) };
            }
        }
        false
    }

    /// Since when there is no answer, when there should be one.
    pub fn lost_for(&self, now: Duration) -> Option<Duration> {
        let since = now.saturating_sub(self.answered_at.unwrap_or_default());
        (since > self.every + GRACE || (self.failure.is_some() && since > self.every)).then_some(since)
    }
    /// Why there is no answer.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }
    /// The state in words, of the last answer.
    pub(super) fn words(&self, now: Duration) -> Option<InWords> {
        let flags = self.flags(now).unwrap_or(Status(0));
        self.status.as_ref().map(|status| InWords::of(status, flags))
    }
    /// The flags of late, if there are samples of now.
    pub(super) fn flags(&self, now: Duration) -> Option<Status> {
        self.fresh(now)?;
        let of_late = self.flagged.iter().filter(|(at, _)| now.saturating_sub(*at) <= self.old());
        Some(of_late.fold(Status(0), |all, (_, flags)| Status(all.0 | flags.0)))
    }
    /// What is older than this is not of now.
    fn old(&self) -> Duration {
        FRESH.max(self.every * 2)
    }
    /// The newest sample, if it is of now.
    pub(super) fn fresh(&self, now: Duration) -> Option<&TraceSample> {
        let (at, sample) = self.newest.as_ref()?;
        let old = now.saturating_sub(*at) > self.old() || self.lost_for(now).is_some();
        (!old).then_some(sample)
    }
    /// The samples shown, the time at the right edge, and since when they stand.
    pub(super) fn shown(&self, now: Duration) -> (&History, Duration, Option<Duration>) {
        match &self.paused {
            Some((at, history)) => (history, *at, Some(now.saturating_sub(*at))),
            None => (&self.history, now, None),
        }
    }
    /// The clamp of the active image, when its file was given.
    pub(super) fn clamp_nm(&self) -> Option<u32> {
        let active = self.status.as_ref()?.active?;
        self.known.filter(|known| known.crc == active.crc).map(|known| known.clamp_nm)
    }
    /// Nodes of the active image, from its length.
    pub(super) fn nodes(&self) -> Option<u32> {
        let active = self.status.as_ref()?.active?;
        match self.identity.as_ref()?.1.get(usize::from(active.slot))? {
            Slot::Image { length, crc, .. } if *crc == active.crc => {
                // With a signature or without: what is behind the nodes is no multiple of them.
                let body = (*length as usize).checked_sub(image_bytes(0))?;
                let body = if body % NODE_BYTES == 0 { body } else { body.checked_sub(SIGNATURE_BYTES)? };
                Some((body / NODE_BYTES) as u32)
            }
            _ => None,
        }
    }
    /// When the device was restarted, if that is not long ago.
    pub(super) fn restarted(&self, now: Duration) -> Option<Duration> {
        self.restarted_at.map(|at| now.saturating_sub(at)).filter(|since| *since < TOLD)
    }
    /// The longest round trip of late.
    pub(super) fn worst(&self) -> Duration {
        self.round_trips.iter().map(|(_, time)| *time).max().unwrap_or_default()
    }
    /// The table of counters.
    pub(super) fn counters(&self, now: Duration) -> Vec<Row> {
        let (counts, live) = (self.growth.counts(now), self.lost_for(now).is_none());
        let of_faults = &counts[NAMES.len()..];
        let count = Count {
            value: of_faults.iter().map(|count| count.value).sum(),
            per_s: of_faults.iter().map(|count| count.per_s).sum(),
            grew: of_faults.iter().any(|count| count.grew),
        };
        let faults = Row { name: "faults", count, bad: true, live };
        NAMES.iter().zip(counts).map(|(&(name, bad), count)| Row { name, count, bad, live }).chain([faults]).collect()
    }
    /// Faults that were counted, and whether one grew of late.
    pub(super) fn faults(&self, now: Duration) -> (String, bool) {
        let counts = self.growth.counts(now);
        let mut grew = false;
        let faults = Reason::ALL.into_iter().filter(|reason| reason.is_fault()).zip(&counts[NAMES.len()..]);
        let found = faults.filter(|(_, count)| count.value > 0).map(|(reason, count)| {
            grew |= count.grew;
            format!("{} x {reason}{}", count.value, if count.grew { " ▲" } else { "" })
        });
        let found: Vec<String> = found.collect();
        (if found.is_empty() { "none".to_owned() } else { found.join("; ") }, grew)
    }
}

/// The counters in the order of the table.
fn counters(status: &DeviceStatus) -> [u64; COUNTERS] {
    let c = &status.counters;
    let mut all = [0; COUNTERS];
    let first = [
        c.accepted,
        c.answered,
        c.damaged,
        c.repeated,
        c.out_of_order,
        c.lost,
        c.jumps,
        c.late,
        c.silences,
        c.messages,
        c.messages_damaged,
    ];
    for (place, count) in all.iter_mut().zip(first.iter().chain(&c.faults)) {
        *place = u64::from(*count);
    }
    all
}
