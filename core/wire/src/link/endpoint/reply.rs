//! The answer to a frame: given, withheld because it is late, or withdrawn because nobody fetched it.

use super::Endpoint;
use crate::link::answer::{write, write_packet};
use crate::link::counters::Counters;
use crate::link::error::LinkError;
use crate::rewrite::Output;

impl Endpoint {
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

    /// The last answer that was given did not reach the controller: it counts as withheld, as if it had never been
    /// given. For a link on which the controller fetches the answer (SPI); the board calls it when that has not
    /// happened by [`due_by_us`](Self::due_by_us), and before it gives the next frame. Once for an answer; without
    /// one nothing happens.
    #[inline]
    pub fn withdraw(&mut self) {
        if let Some(before) = self.given.take() {
            self.counters.answered = self.counters.answered.saturating_sub(1);
            self.unanswered = self.unanswered.saturating_add(before);
            self.withhold();
        }
    }

    /// The answer that is due.
    pub fn due(&self) -> Option<&Output> {
        self.due_us.map(|_| &self.output)
    }

    /// When the answer to the last accepted frame must have reached the controller, µs: its arrival and the deadline.
    #[inline]
    pub fn due_by_us(&self) -> u64 {
        self.heard_us.saturating_add(self.settings.deadline_us.into())
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
                self.given = Some(core::mem::take(&mut self.unanswered));
                Some(bytes)
            }
            Err(_) => {
                self.withhold();
                None
            }
        }
    }

    /// An answer that does not reach the controller in time.
    #[inline]
    pub(super) fn withhold(&mut self) {
        Counters::one_more(&mut self.counters.late);
        self.unanswered = self.unanswered.saturating_add(1);
    }
}
