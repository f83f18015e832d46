//! What the view of a run knows.

use std::collections::VecDeque;
use std::time::Duration;

use hdrhistogram::Histogram;
use truepath_bench::{Injected, RunStatus};
use truepath_core::link::{Counters, Timing};
use truepath_core::rewrite::Output;

use crate::monitor::growth::Growth;

/// Samples of the correction that are kept.
const MOST: usize = 2_048;

/// What a run has come to.
#[derive(Clone, Debug)]
pub struct Model {
    /// The board.
    pub board: String,
    /// What is being done.
    pub stage: String,
    /// Setpoints in all.
    pub count: u64,
    /// What the cable did.
    pub injected: Injected,
    /// What the host's own code counted.
    pub counters: Counters,
    /// Answers compared.
    pub answers: u64,
    /// Answers by mode.
    pub modes: [u64; 6],
    /// Parts armed.
    pub armed: u64,
    /// Largest correction, nm.
    pub largest_nm: i64,
    /// How regularly setpoints arrive at the board; nothing of a firmware that does not time them.
    pub timing: Option<Timing>,
    /// Time the board took.
    pub elapsed: Duration,
    /// The last answer that was compared.
    pub latest: Option<Output>,
    /// Sizes of the last corrections, nm: the larger of the axes.
    pub trail_nm: VecDeque<u32>,
    /// Answers that had arrived at the last look, of a board that tells of them one by one.
    arrived_before: u64,
    /// Answers that arrived since.
    pub since: u64,
    /// Setpoints over time.
    pub rate: Growth<1>,
}

impl Model {
    /// Before the first batch.
    pub fn new(board: String, count: u64) -> Self {
        Self {
            board,
            stage: "preparing the board".to_owned(),
            count,
            injected: Injected::default(),
            counters: Counters::default(),
            answers: 0,
            modes: [0; 6],
            armed: 0,
            largest_nm: 0,
            timing: None,
            elapsed: Duration::ZERO,
            latest: None,
            trail_nm: VecDeque::new(),
            arrived_before: 0,
            since: 0,
            rate: Growth::default(),
        }
    }
    /// Takes what a batch came to; `arrived` are all answers the board told of.
    pub fn see(&mut self, status: &RunStatus<'_>, arrived: u64) {
        self.stage = "setpoints under way".to_owned();
        (self.injected, self.counters, self.answers) = (*status.injected, *status.counters, status.answers);
        (self.modes, self.armed, self.largest_nm) = (*status.modes, status.armed, status.largest_nm);
        self.timing = status.timing.copied();
        (self.elapsed, self.arrived_before, self.since) = (status.elapsed, arrived, 0);
        self.latest = status.trail.last().copied().or(self.latest);
        for output in status.trail.iter().skip(status.trail.len().saturating_sub(MOST)) {
            let size = output.correction_nm.iter().map(|nm| nm.unsigned_abs()).max().unwrap_or(0);
            if self.trail_nm.len() == MOST {
                self.trail_nm.pop_front();
            }
            self.trail_nm.push_back(size);
        }
    }
    /// Takes the answers that arrived so far, at a time since the start of the view.
    pub fn tick(&mut self, at: Duration, arrived: u64) {
        self.since = arrived.saturating_sub(self.arrived_before);
        self.rate.take(at, [self.done()]);
    }
    /// Setpoints done: of whole batches, and answered since.
    pub fn done(&self) -> u64 {
        self.injected.frames + self.since
    }
    /// Setpoints per second over the last two.
    pub fn per_s(&self, now: Duration) -> f64 {
        self.rate.counts(now)[0].per_s
    }
}

/// Round trips so far, to 1 % of each.
#[derive(Clone, Debug)]
pub struct RoundTrips(Histogram<u64>);

impl RoundTrips {
    /// None yet.
    pub fn new() -> Option<Self> {
        // From 1 us to an hour in ns; larger ones count as that.
        Histogram::new_with_bounds(1_000, 3_600_000_000_000, 2).ok().map(Self)
    }
    /// Takes more of them, ns.
    pub fn take(&mut self, times_ns: &[u64]) {
        times_ns.iter().for_each(|ns| self.0.saturating_record(*ns));
    }
    /// Minimum, median, 99th percentile and maximum, µs; `None` without any.
    pub fn four(&self) -> Option<[f64; 4]> {
        let h = &self.0;
        let all = [h.min(), h.value_at_quantile(0.5), h.value_at_quantile(0.99), h.max()];
        (!h.is_empty()).then(|| all.map(|ns| ns as f64 / 1_000.0))
    }
}
