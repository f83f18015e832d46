//! What the sessions so far were.

use std::collections::BTreeMap;

use truepath_core::rewrite::Reason;

use super::rule::SETTLED;

/// What the sessions so far were.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Images and settings tried.
    pub sessions: u64,
    /// Setpoints sent.
    pub setpoints: u64,
    /// Answers judged.
    pub answers: u64,
    /// Commands judged.
    pub commands: u64,
    /// Parts armed.
    pub armed: u64,
    /// Answers in `Off`, `Bypass`, `Armed`, `Active`, `Hold`, `Fault`.
    pub modes: [u64; 6],
    /// Corrections that ended, by their reason.
    pub ended: BTreeMap<u16, u64>,
    /// Largest share of the limits of size, speed and acceleration that was used, 1/1000.
    pub used: [u64; 3],
    /// How often a rule that is stricter than the contract would have raised an alarm, in the order of [`SETTLED`].
    pub settled: [u64; SETTLED.len()],
}

impl Tally {
    /// How often a correction ended for a reason.
    pub fn ended_by(&self, reason: Reason) -> u64 {
        self.ended.get(&reason.code()).copied().unwrap_or(0)
    }
}
