//! What the device remembers over resets: the active image, its settings, the armed passes of parts, its boots, the keys
//! it trusts.
//!
//! All of it but the keys is one record of the journal, so that every change is whole or has not happened. A copy in RAM
//! is read; it changes only after the flash has taken the change. The keys have a page of their own (`keys`).

mod journal;
mod keys;
mod place;

use embedded_storage::nor_flash::NorFlash;
use serde::{Deserialize, Serialize};
use truepath_core::image::{KeyRing, KeyRingError, PublicKey};
use truepath_core::link::{ActiveImage, DeviceSettings};
use truepath_core::rewrite::{Spent, SpentList};

pub use journal::JournalFailed;
use journal::{Journal, PAYLOAD_BYTES};
pub use place::PLACES;

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
#[derive(Clone, Copy, Debug)]
pub struct Ledger {
    journal: Journal,
    now: Remembered,
    keys: KeyRing,
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
        Self { journal, now, keys: keys::read(flash) }
    }
    /// What is remembered.
    pub const fn now(&self) -> &Remembered {
        &self.now
    }
    /// Remembers something else. Takes up to 32 programmed words; once in [`PLACES`] changes a sector is erased first.
    ///
    /// # Errors
    /// The flash did not take it: what was remembered before is still remembered.
    pub fn change<F: NorFlash>(
        &mut self,
        flash: &mut F,
        change: impl FnOnce(&mut Remembered),
    ) -> Result<(), JournalFailed> {
        let mut next = self.now;
        change(&mut next);
        if next == self.now {
            return Ok(());
        }
        self.append(flash, &next)?;
        self.now = next;
        Ok(())
    }
    fn append<F: NorFlash>(&mut self, flash: &mut F, next: &Remembered) -> Result<(), JournalFailed> {
        let mut payload = [0; PAYLOAD_BYTES];
        let bytes = postcard::to_slice(next, &mut payload).map_err(|_| JournalFailed)?;
        self.journal.append(flash, bytes, &self.keys)
    }

    /// The keys whose images are taken; none while every image is.
    pub const fn keys(&self) -> &KeyRing {
        &self.keys
    }
    /// Trusts one more key, for ever. Takes two programmed words.
    ///
    /// # Errors
    /// The key cannot be used or there is no room for it: nothing has changed. The flash did not take it: it is not
    /// trusted now, and may be after the next reset.
    pub fn provision<F: NorFlash>(&mut self, flash: &mut F, key: PublicKey) -> Result<(), NotProvisioned> {
        let before = self.keys;
        self.keys.add(key).map_err(NotProvisioned::Ring)?;
        if self.keys == before || self.journal.write_key(flash, &key) {
            return Ok(());
        }
        // The page is worn or used: the keys go with a record to the other sector.
        self.journal.leave_sector();
        let now = self.now;
        self.append(flash, &now).map_err(|failed| {
            self.keys = before;
            NotProvisioned::Flash(failed)
        })
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
