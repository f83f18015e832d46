//! What the device remembers over resets: the active image, its settings, the armed passes of parts, its boots, the keys
//! it trusts and those it trusts no more, the counters of signed images that were in use, the log of changes.
//!
//! All of it but keys, counters and log is one record of the journal, so that every change is whole or has not happened. A copy
//! in RAM is read; it changes only after the flash has taken the change. Keys, counters and log have pages of their own
//! (`keys`, `counters`, `log`); counters and log have no copy in RAM.

mod counters;
mod journal;
mod keys;
mod log;
mod place;

use embedded_storage::nor_flash::NorFlash;
use serde::{Deserialize, Serialize};
use truepath_core::image::{
    Binding, Counted, DeviceClass, KeyId, KeyRing, KeyRingError, PublicKey, Rights, SignatureError, Signed,
};
use truepath_core::link::{ActiveImage, DeviceSettings, LogEntry};
use truepath_core::rewrite::{Spent, SpentList};

pub use counters::MOST_COUNTED;
pub use journal::JournalFailed;
use journal::{Journal, PAYLOAD_BYTES};
use log::Log;
pub use log::{MOST_LOGGED, MOST_WAITING};
pub use place::{FIRST_COUNTER_PLACE, PLACES};

/// The record. The order is that of importance: of a record that another firmware has written, as much is taken as
/// can be read from the front.
/// The default is a device as it leaves the factory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remembered {
    /// Armed passes of parts.
    pub spent: SpentList,
    /// The image in use.
    pub active: Option<ActiveImage>,
    /// Settings; none before the first `Configure`, or when they cannot be used any more. Nothing is armed then.
    pub settings: Option<DeviceSettings>,
    /// Resets; it stands still at its end.
    pub boots: u32,
}

impl Remembered {
    /// A pass of a part was armed.
    pub fn spend(&mut self, pass: Spent) {
        self.spent.spend(pass);
    }
    /// Whether a pass of a part was armed.
    pub fn is_spent(&self, pass: &Spent) -> bool {
        self.spent.contains(pass)
    }
    /// The settings in use: those of a 1 kHz controller without joint limits while there are none, which is enough to
    /// pass setpoints on unchanged.
    pub fn settings_in_use(&self) -> DeviceSettings {
        self.settings.unwrap_or(DeviceSettings::at_1_khz())
    }
}

/// The record and the journal it is kept in.
#[derive(Clone, Debug)]
pub struct Ledger {
    journal: Journal,
    now: Remembered,
    /// The flash failed under the last record: it may be there all the same, and count after a reset.
    in_doubt: bool,
    keys: KeyRing,
    log: Log,
}

/// Why a key is not trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotProvisioned {
    /// It cannot be used, or there is no room.
    Ring(KeyRingError),
    /// The flash did not take it.
    Flash(JournalFailed),
}

impl Ledger {
    /// Reads the newest record; a device without one is as it left the factory. Settings that are out of range, or
    /// those of another firmware, count as none; the armed passes of parts are kept then.
    pub fn open<F: NorFlash>(flash: &mut F) -> Self {
        let mut payload = [0; PAYLOAD_BYTES];
        let (journal, length) = Journal::open(flash, &mut payload);
        let mut now = length.map(|length| read(&payload[..length])).unwrap_or_default();
        now.settings = now.settings.filter(|settings| settings.check().is_ok());
        let log = Log::behind(journal.logged(flash).last());
        Self { journal, now, in_doubt: false, keys: keys::read(flash), log }
    }
    /// What is remembered.
    pub const fn now(&self) -> &Remembered {
        &self.now
    }
    /// Whether a change that failed may count after the next reset, until something is written again.
    pub const fn is_in_doubt(&self) -> bool {
        self.in_doubt
    }
    /// Remembers something else. Takes up to 32 programmed words; once in [`PLACES`] changes a sector is erased first.
    ///
    /// # Errors
    /// The flash did not take it, or did not say so: what was remembered before is still remembered, and this may be after the next
    /// reset.
    pub fn change<F: NorFlash>(
        &mut self,
        flash: &mut F,
        change: impl FnOnce(&mut Remembered),
    ) -> Result<(), JournalFailed> {
        let mut next = self.now;
        change(&mut next);
        if next == self.now {
            return self.settle(flash);
        }
        self.append(flash, Some(&next))?;
        self.now = next;
        Ok(())
    }
    /// Writes a record, or what is remembered now.
    ///
    /// Not inlined: its payload is not to lie on the stack under what is written next.
    #[inline(never)]
    fn append<F: NorFlash>(&mut self, flash: &mut F, next: Option<&Remembered>) -> Result<(), JournalFailed> {
        let mut payload = [0; PAYLOAD_BYTES];
        let bytes = postcard::to_slice(next.unwrap_or(&self.now), &mut payload).map_err(|_| JournalFailed)?;
        let appended = self.journal.append(flash, bytes, &self.keys);
        self.in_doubt = appended.is_err();
        appended
    }
    /// Writes what is remembered behind a record that failed, so that it is this that counts after a reset, in the sector in which
    /// what is written beside it will be looked for.
    fn settle<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), JournalFailed> {
        if self.in_doubt { self.append(flash, None) } else { Ok(()) }
    }

    /// The keys whose images are taken; none while every image is.
    pub const fn keys(&self) -> &KeyRing {
        &self.keys
    }
    /// Trusts one more key, until it is revoked. Takes two programmed words.
    ///
    /// # Errors
    /// The key cannot be used or there is no room for it: nothing has changed. The flash did not take it: it is not
    /// trusted now, and may be after the next reset.
    pub fn provision<F: NorFlash>(
        &mut self,
        flash: &mut F,
        key: PublicKey,
        rights: Rights,
    ) -> Result<(), NotProvisioned> {
        let before = self.keys;
        self.keys.add_with(key, rights).map_err(NotProvisioned::Ring)?;
        let written = self.keys == before || self.settle(flash).is_ok() && self.journal.write_key(flash, &key, rights);
        self.keep_keys(flash, written, before)
    }
    /// Trusts a key no more, for ever. Takes one programmed word.
    ///
    /// # Errors
    /// The key is not one that is trusted, or was: nothing has changed. The flash did not take it: the key is still
    /// trusted now, and may not be after the next reset.
    pub fn revoke<F: NorFlash>(&mut self, flash: &mut F, key: KeyId) -> Result<(), NotProvisioned> {
        let before = self.keys;
        if before.is_revoked(key) {
            return Ok(());
        }
        if before.iter().all(|trusted| trusted.id() != key) {
            return Err(NotProvisioned::Ring(KeyRingError::Key(SignatureError::UnknownKey { key })));
        }
        self.keys.revoke(key).map_err(NotProvisioned::Ring)?;
        let written = self.settle(flash).is_ok() && self.journal.write_revoked(flash, key);
        self.keep_keys(flash, written, before)
    }
    /// What was not written into the page of keys, because it is worn or used up, goes with a record to the other sector.
    fn keep_keys<F: NorFlash>(&mut self, flash: &mut F, written: bool, before: KeyRing) -> Result<(), NotProvisioned> {
        if written {
            return Ok(());
        }
        self.change_sector(flash).map_err(|failed| {
            self.keys = before;
            NotProvisioned::Flash(failed)
        })
    }
    /// Writes all that is remembered into the other sector.
    #[inline(never)]
    fn change_sector<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), JournalFailed> {
        self.journal.leave_sector();
        self.append(flash, None)
    }

    /// Refused unless an image may be used here: any while no key is provisioned, else one that is signed for this class
    /// and not older than another of its pass that was in use. Gives its counter and the number of its key, of a signed one.
    ///
    /// Not inlined: the verification has frames of its own, which nothing else is to stand upon.
    ///
    /// # Errors
    /// A [`SignatureError`].
    #[inline(never)]
    pub fn admit<F: NorFlash>(
        &self,
        flash: &mut F,
        image: &[u8],
        binding: &Binding,
        class: DeviceClass,
    ) -> Result<Option<(Counted, KeyId)>, SignatureError> {
        let Some(found) = self.keys.admits(image, class)? else { return Ok(None) };
        let counted = Counted::of(binding, found);
        let least = counters::least(flash, &counted);
        if found < least {
            return Err(SignatureError::RolledBack { found, least });
        }
        Ok(Signed::of(image).map(|signed| (counted, signed.key)))
    }
    /// The counter below which no image of a pass, or no firmware, is taken.
    pub fn least<F: NorFlash>(&self, flash: &mut F, of: &Counted) -> u32 {
        counters::least(flash, of)
    }
    /// No image of this pass with a lower counter is taken any more. Takes up to two programmed words.
    ///
    /// # Errors
    /// The flash did not take it.
    #[inline(never)]
    pub fn raise<F: NorFlash>(&mut self, flash: &mut F, to: &Counted) -> Result<(), JournalFailed> {
        if self.settle(flash).is_ok() && self.journal.raise(flash, to) {
            return Ok(());
        }
        // The page is used up: what still counts goes to the other sector, and leaves room there.
        self.change_sector(flash)?;
        if self.journal.raise(flash, to) { Ok(()) } else { Err(JournalFailed) }
    }

    /// Writes an entry of the log, behind those that waited; it gets the next number. Takes two programmed words each, and
    /// once in a while a sector is erased.
    ///
    /// # Errors
    /// The flash did not take it: there is no such entry.
    #[inline(never)]
    pub fn note<F: NorFlash>(&mut self, flash: &mut F, entry: LogEntry) -> Result<(), JournalFailed> {
        self.write_waiting(flash)?;
        self.log.keep(entry);
        self.write_waiting(flash).inspect_err(|_| self.log.waiting.clear())
    }
    /// Lets an entry of the log wait until the flash may be written. Where there is no room it is dropped, and its number
    /// with it.
    pub fn keep(&mut self, entry: LogEntry) {
        self.log.keep(entry);
    }
    /// Whether entries of the log wait.
    pub fn has_waiting(&self) -> bool {
        !self.log.waiting.is_empty()
    }
    /// Writes the entries of the log that wait.
    ///
    /// # Errors
    /// The flash did not take one: it and those behind it still wait.
    pub fn write_waiting<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), JournalFailed> {
        if self.has_waiting() {
            self.settle(flash)?;
        }
        while let Some(entry) = self.log.waiting.front().copied() {
            if !self.journal.log(flash, &entry) {
                // The page is used up: the newest go to the other sector, and leave room there.
                self.change_sector(flash)?;
                if !self.journal.log(flash, &entry) {
                    return Err(JournalFailed);
                }
            }
            let _ = self.log.waiting.pop_front();
        }
        Ok(())
    }
    /// The entries of the log that are in the flash, oldest first.
    pub fn logged<F: NorFlash>(&self, flash: &mut F) -> impl Iterator<Item = LogEntry> {
        self.journal.logged(flash)
    }
    /// Number of the next entry of the log.
    pub const fn next_entry(&self) -> u32 {
        self.log.next
    }
}

fn read(payload: &[u8]) -> Remembered {
    let mut now = Remembered::default();
    if let Ok(whole) = postcard::from_bytes(payload) {
        now = whole;
    } else if let Ok((spent, _)) = postcard::take_from_bytes(payload) {
        now.spent = spent;
    }
    now
}
