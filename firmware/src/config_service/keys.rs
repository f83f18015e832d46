//! Whose images the device takes.
//!
//! Keys are added and never taken away; a device without one is open and takes every image. A key counts from the answer
//! on, after resets as well: it has a write-once place in the flash, beside the ledger.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{KeyRingError, PublicKey};
use truepath_core::link::{Denial, DeviceKeys, Reply};
use truepath_core::rewrite::Mode;

use super::handler::Handler;
use crate::ledger::NotProvisioned;
use crate::servo::ServoAccess;

impl From<NotProvisioned> for Denial {
    fn from(error: NotProvisioned) -> Self {
        match error {
            NotProvisioned::Ring(KeyRingError::Key(error)) => Self::Untrusted(error),
            NotProvisioned::Ring(KeyRingError::Full) => Self::KeysFull,
            NotProvisioned::Flash(failed) => failed.into(),
        }
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn keys(&self) -> DeviceKeys {
        DeviceKeys { class: self.board.class, present: self.board.present, keys: *self.ledger.keys() }
    }

    /// Trusts one more key. An image in use that is not signed with one of the keys is in use no more.
    pub fn provision<'s>(&mut self, key: PublicKey, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        match servo.with(|servo| servo.mode()) {
            Mode::Off => self.not_computing()?,
            mode => return Err(Denial::Mode(mode)),
        }
        if !self.board.present {
            return Err(Denial::NotPresent);
        }
        self.ledger.provision(&mut self.flash, key)?;
        if self.active.is_some() {
            let before = self.active;
            self.borrow_image(servo)?;
            self.back_to(before, servo);
        }
        Ok(Reply::Done)
    }
}
