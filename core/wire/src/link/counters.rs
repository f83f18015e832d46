//! What is counted on the setpoint link.

use serde::{Deserialize, Serialize};

use crate::rewrite::Reason;

/// Counts since the reset or `ClearCounters`; each stands still at its end instead of wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Frames accepted.
    pub accepted: u32,
    /// Answers given in time.
    pub answered: u32,
    /// Frames that were damaged, of another length, kind, version or number of axes.
    pub damaged: u32,
    /// Frames with the sequence of the last accepted one.
    pub repeated: u32,
    /// Frames with one of the 63 sequences before the last accepted one.
    pub out_of_order: u32,
    /// Frames missing in gaps that were small enough.
    pub lost: u32,
    /// Sequences from elsewhere: larger gaps, restarts of the controller.
    pub jumps: u32,
    /// Answers withheld because they were late.
    pub late: u32,
    /// Times at which no frame came for too long.
    pub silences: u32,
    /// Faults by their reason: the number of a reason less [`Reason::FIRST_FAULT`] is the index.
    pub faults: [u32; Reason::FAULTS],
    /// Requests of the configuration link that arrived undamaged.
    pub messages: u32,
    /// Messages of the configuration link that were damaged.
    pub messages_damaged: u32,
}

impl Counters {
    /// Counts one more.
    #[inline]
    pub(super) fn one_more(counter: &mut u32) {
        *counter = counter.saturating_add(1);
    }
    /// Counts a fault by its reason; regular ends are not counted.
    #[inline]
    pub(super) fn fault(&mut self, reason: Reason) {
        let index = usize::from(reason.code().wrapping_sub(Reason::FIRST_FAULT));
        if let Some(counter) = self.faults.get_mut(index) {
            Self::one_more(counter);
        }
    }
    /// Every fault with how often it happened, in the order of their numbers.
    pub fn by_fault(&self) -> impl Iterator<Item = (Reason, u32)> {
        let faults = Reason::ALL.into_iter().filter(|reason| reason.is_fault());
        faults.map(|reason| (reason, self.faults_of(reason)))
    }
    /// How often a fault happened; 0 for a regular end.
    pub fn faults_of(&self, reason: Reason) -> u32 {
        self.faults.get(usize::from(reason.code().wrapping_sub(Reason::FIRST_FAULT))).copied().unwrap_or(0)
    }
}
