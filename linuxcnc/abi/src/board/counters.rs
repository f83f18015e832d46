//! What happened on the link, counted; every counter stops at its end.

/// Counters of the controller's end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Right answers in their tick.
    pub answered: u32,
    /// Ticks without one.
    pub missed: u32,
    /// Answers to an earlier tick; dropped.
    pub late: u32,
    /// Packets that are no undamaged answer; dropped.
    pub damaged: u32,
    /// Undamaged answers that cannot be true, see [`Fault`](super::Fault); dropped.
    pub wrong: u32,
    /// How often the link was lost.
    pub lost: u32,
}

impl Counters {
    /// One more, up to the end.
    pub(super) fn one_more(counter: &mut u32) {
        *counter = counter.saturating_add(1);
    }
}
