//! What somebody who looks on sees of a run under way, and how he ends it.
//!
//! A batch over streams takes seconds, so the board tells of its answers as they arrive ([`Watch`]); what was compared is
//! told after every batch ([`RunStatus`]). Neither waits for the one who looks.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use truepath_core::link::{Counters, Timing};
use truepath_core::rewrite::Output;

use super::injector::Injected;

/// One answer in so many is in the trail of a [`RunStatus`].
pub const TRAIL_EVERY: u64 = 8;
/// Round trips that are kept for somebody who does not fetch them.
const MOST: usize = 1 << 16;

/// A run as it is after a batch.
#[derive(Clone, Copy, Debug)]
pub struct RunStatus<'a> {
    /// What the cable did so far; its frames are the setpoints sent.
    pub injected: &'a Injected,
    /// Counters as the host's own code has them. Those of the device are compared at the end.
    pub counters: &'a Counters,
    /// Answers compared, all identical.
    pub answers: u64,
    /// Answers by mode, `Off` first.
    pub modes: &'a [u64; 6],
    /// Parts armed.
    pub armed: u64,
    /// Largest correction, nm.
    pub largest_nm: i64,
    /// Time the board took for the batches.
    pub elapsed: Duration,
    /// How regularly setpoints arrive at the board, as it says; nothing of a firmware that does not time them.
    pub timing: Option<&'a Timing>,
    /// One answer in [`TRAIL_EVERY`] of the batch.
    pub trail: &'a [Output],
}

/// Between a board and the one who looks on.
#[derive(Debug, Default)]
pub struct Watch {
    answered: AtomicU64,
    round_trips_ns: Mutex<Vec<u64>>,
    stop: AtomicBool,
    leave: AtomicBool,
}

impl Watch {
    /// An answer arrived.
    pub fn answer(&self, round_trip_ns: u64) {
        self.answered.fetch_add(1, Ordering::Relaxed);
        let mut kept = self.round_trips_ns.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() < MOST {
            kept.push(round_trip_ns);
        }
    }
    /// Answers that arrived so far; 0 of a board that does not tell.
    pub fn answered(&self) -> u64 {
        self.answered.load(Ordering::Relaxed)
    }
    /// Round trips since the last time, ns.
    pub fn round_trips_ns(&self) -> Vec<u64> {
        std::mem::take(&mut *self.round_trips_ns.lock().unwrap_or_else(PoisonError::into_inner))
    }
    /// Ends the run with the batch that is under way.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
    /// Whether it is to end so.
    pub fn is_stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
    /// Ends the run within the batch, without a report.
    pub fn leave(&self) {
        self.leave.store(true, Ordering::Relaxed);
    }
    /// Whether it is to end so.
    pub fn is_leaving(&self) -> bool {
        self.leave.load(Ordering::Relaxed)
    }
}
