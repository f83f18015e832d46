//! The log of changes, as requests make and read it.
//!
//! What changes the flash is noted there before: without its entry it does not happen. What happens in RAM alone, also in
//! modes in which the flash is not written, is noted in RAM and written by [`Handler::rest`] in `Off` and `Bypass`.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::link::{Change, Denial, LOG_ENTRIES, LogEntry, Reply};

use super::handler::{Handler, idle};
use crate::servo::ServoAccess;

impl<'a, F: NorFlash> Handler<'a, F> {
    /// An entry of now; who asks is put in when it is kept.
    pub fn entry(&self, change: Change) -> LogEntry {
        let since_us = |at: u64| self.now_us.saturating_sub(at);
        let told = |(unix_s, at): (u32, u64)| unix_s.saturating_add((since_us(at) / 1_000_000) as u32);
        LogEntry {
            sequence: 0,
            boots: self.ledger.now().boots,
            uptime_us: since_us(self.started_us),
            host_s: self.told_time.map(told),
            by: None,
            refused: 0,
            change,
            key: None,
            value: 0,
            counter: 0,
        }
    }
    /// Writes an entry ahead of what it tells of.
    pub fn note(&mut self, entry: LogEntry) -> Result<(), Denial> {
        let entry = self.access.sign(entry);
        self.ledger.note(&mut self.flash, entry)?;
        self.log_fails = false;
        Ok(())
    }
    /// Keeps an entry until the flash may be written.
    pub fn keep(&mut self, entry: LogEntry) {
        let entry = self.access.sign(entry);
        self.ledger.keep(entry);
    }
    /// Writes the entries that wait, if the flash may be written. One that it does not take is tried again with the next that
    /// is noted, not each time: a word that fails wears the flash.
    pub fn rest(&mut self, servo: &mut impl ServoAccess<'a>) {
        if self.ledger.has_waiting() && !self.log_fails && idle(servo).is_ok() {
            self.log_fails = self.ledger.write_waiting(&mut self.flash).is_err();
        }
    }
    pub fn log<'s>(&mut self, from: u32, servo: &mut impl ServoAccess<'a>) -> Reply<'s> {
        self.rest(servo);
        let entries =
            self.ledger.logged(&mut self.flash).filter(|entry| entry.sequence >= from).take(LOG_ENTRIES).collect();
        Reply::Log { next: self.ledger.next_entry(), entries }
    }
}
