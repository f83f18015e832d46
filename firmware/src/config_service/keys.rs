//! Whose images the device takes.
//!
//! Keys are added, and revoked for ever; a device that never had one is open and takes every image, one whose keys are all
//! revoked takes none. Both count from the answer on, after resets as well: they have a write-once place in the flash,
//! beside the ledger.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{KeyId, KeyRingError, PublicKey, Rights};
use truepath_core::link::{AccessError, Change, Denial, DeviceKeys, LogEntry, Reply};
use truepath_core::rewrite::Mode;

use super::handler::Handler;
use crate::ledger::NotProvisioned;
use crate::servo::ServoAccess;

impl From<NotProvisioned> for Denial {
    fn from(error: NotProvisioned) -> Self {
        match error {
            NotProvisioned::Ring(KeyRingError::Key(error)) => Self::Untrusted(error),
            NotProvisioned::Ring(KeyRingError::Full) => Self::KeysFull,
            NotProvisioned::Ring(KeyRingError::OtherRights { key }) => Self::Access(AccessError::OtherRights { key }),
            NotProvisioned::Flash(failed) => failed.into(),
        }
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn keys(&self) -> DeviceKeys {
        DeviceKeys { class: self.board.class, present: self.board.present, keys: *self.ledger.keys() }
    }

    /// Trusts one more key. An image in use that is not signed with one of the keys is in use no more.
    #[inline(never)]
    pub fn provision<'s>(
        &mut self,
        key: PublicKey,
        rights: Rights,
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<Reply<'s>, Denial> {
        self.attended(servo)?;
        let mut next = *self.ledger.keys();
        next.add_with(key, rights).map_err(NotProvisioned::Ring)?;
        if next != *self.ledger.keys() {
            self.note(LogEntry { key: Some(key.id()), ..self.entry(Change::Provisioned) })?;
        }
        self.ledger.provision(&mut self.flash, key, rights)?;
        self.verify_again(servo)
    }

    /// Trusts a key no more. An image in use that is signed with it is in use no more.
    #[inline(never)]
    pub fn revoke<'s>(&mut self, key: KeyId, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        self.attended(servo)?;
        if self.ledger.keys().iter().any(|trusted| trusted.id() == key) {
            self.note(LogEntry { key: Some(key), ..self.entry(Change::Revoked) })?;
        }
        self.ledger.revoke(&mut self.flash, key)?;
        self.access.revoke(key);
        self.verify_again(servo)
    }

    /// Refused unless in `Off`, with somebody at the device.
    fn attended(&self, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
        match servo.with(|servo| servo.mode()) {
            Mode::Off => self.not_computing()?,
            mode => return Err(Denial::Mode(mode)),
        }
        if self.board.present { Ok(()) } else { Err(Denial::NotPresent) }
    }

    fn verify_again<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        if self.active.is_some() {
            let before = self.active;
            self.borrow_image(servo)?;
            self.back_to(before, servo);
        }
        Ok(Reply::Done)
    }
}
