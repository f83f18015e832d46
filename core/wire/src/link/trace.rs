//! A bounded queue of samples for a live trace.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::counters::Counters;
use crate::rewrite::{Mode, Output, Place, Reason, State, Status};

/// Samples in one reply.
pub const TRACE_SAMPLES: usize = 16;

/// What a live trace shows of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TraceSample {
    /// Of the setpoint.
    pub sequence: u32,
    /// State of the rewriter.
    pub mode: Mode,
    /// Why the last correction ended or failed.
    pub reason: Reason,
    /// Warnings.
    pub status: Status,
    /// Place on the path.
    pub place: Place,
    /// Correction on the machine axes of the program's X and Y, nm.
    pub correction_nm: [i32; 2],
    /// Live feed per tooth over the nominal one, units of 2⁻¹⁶.
    pub feed_ratio: u32,
}

impl TraceSample {
    /// Of the tick that has just been made.
    #[inline]
    pub fn of(state: &State, output: &Output) -> Self {
        let correction_nm = state.plane().map(|axis| output.correction_nm.get(axis).copied().unwrap_or(0));
        Self {
            sequence: output.sequence,
            mode: output.mode,
            reason: output.reason,
            status: output.status,
            place: output.place,
            correction_nm,
            feed_ratio: state.feed_ratio(),
        }
    }
}

/// Up to N samples, one every so many ticks. When nobody fetches them the oldest are dropped and counted.
#[derive(Clone, Debug)]
pub struct Trace<const N: usize> {
    samples: [TraceSample; N],
    /// Index of the oldest, and how many there are.
    oldest: usize,
    count: usize,
    dropped: u32,
    /// Ticks from sample to sample, less one.
    skip: u32,
    to_skip: u32,
}

impl<const N: usize> Trace<N> {
    /// An empty queue that takes one tick in `every` (0 counts as 1).
    pub fn new(every: u32) -> Self {
        let samples = [TraceSample::default(); N];
        Self { samples, oldest: 0, count: 0, dropped: 0, skip: every.saturating_sub(1), to_skip: 0 }
    }

    /// Takes the sample of a tick, or lets it pass.
    #[inline]
    pub fn record(&mut self, state: &State, output: &Output) {
        if self.to_skip > 0 {
            self.to_skip = self.to_skip.wrapping_sub(1);
            return;
        }
        self.to_skip = self.skip;
        if self.count == N {
            self.oldest = Self::after(self.oldest, 1);
            self.count = self.count.wrapping_sub(1);
            Counters::one_more(&mut self.dropped);
        }
        if let Some(place) = self.samples.get_mut(Self::after(self.oldest, self.count)) {
            *place = TraceSample::of(state, output);
            self.count = self.count.wrapping_add(1);
        }
    }

    /// The oldest samples and how many were dropped since the last time; both are gone from here then.
    pub fn drain(&mut self) -> (u32, Vec<TraceSample, TRACE_SAMPLES>) {
        let mut fetched = Vec::new();
        while self.count > 0 {
            let Some(sample) = self.samples.get(self.oldest) else { break };
            if fetched.push(*sample).is_err() {
                break;
            }
            self.oldest = Self::after(self.oldest, 1);
            self.count = self.count.wrapping_sub(1);
        }
        (core::mem::take(&mut self.dropped), fetched)
    }

    /// The index so many places on, at most N of them.
    #[inline]
    fn after(index: usize, places: usize) -> usize {
        let on = index.wrapping_add(places);
        if on < N { on } else { on.wrapping_sub(N) }
    }
}
