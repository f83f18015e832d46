//! Which image is in use, and whose turn it is with the image buffer.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Counted, KeyId};
use truepath_core::link::{ActiveImage, Change, Denial, DeviceSettingsError, LogEntry, Reply, Slot};
use truepath_core::rewrite::Settings;

use super::handler::{Handler, idle};
use crate::active::{LoadError, Loaded};
use crate::servo::ServoAccess;
use crate::slots;

impl From<LoadError> for Denial {
    fn from(error: LoadError) -> Self {
        match error {
            LoadError::Image(error) => Self::Image(error),
            LoadError::Settings(error) => Self::Settings(DeviceSettingsError::Rewriter(error)),
        }
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    /// Uses an image, after resets as well, and no older one of its pass from then on. An image that does not pass leaves
    /// everything as it was.
    ///
    /// Its counter is raised behind the record that makes it the image in use: when the power fails in between, the next
    /// start raises it.
    pub fn activate<'s>(&mut self, wanted: ActiveImage, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        let before = self.active;
        let settings = self.settings().rewriter;
        let done = self.load(wanted, &settings, servo).and_then(|counted| {
            if self.ledger.now().active != Some(wanted) || self.ledger.is_in_doubt() {
                let (counter, key) = counted.map_or((0, None), |(counted, key)| (counted.counter, Some(key)));
                self.note(LogEntry { value: wanted.crc, counter, key, ..self.entry(Change::Activated) })?;
            }
            self.ledger.change(&mut self.flash, |now| now.active = Some(wanted))?;
            Ok(counted)
        });
        match done {
            Ok(counted) => self.count(counted, servo).map(|()| Reply::Done),
            Err(denial) => {
                self.back_to(before, servo);
                Err(denial)
            }
        }
    }

    /// Raises the counter of the image that was put in use. If the flash does not take it, none is in use.
    #[inline(never)]
    fn count(&mut self, counted: Option<(Counted, KeyId)>, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
        let Some((counted, _)) = counted else { return Ok(()) };
        if let Err(failed) = self.ledger.raise(&mut self.flash, &counted) {
            self.active = None;
            self.borrow_image(servo)?;
            return Err(failed.into());
        }
        Ok(())
    }

    pub fn deactivate<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        if let Some(active) = self.ledger.now().active {
            self.note(LogEntry { value: active.crc, ..self.entry(Change::Deactivated) })?;
        }
        self.ledger.change(&mut self.flash, |now| now.active = None)?;
        self.borrow_image(servo)?;
        self.active = None;
        Ok(Reply::Done)
    }

    /// Takes the image buffer back from the servo, which then passes setpoints on without an image.
    pub fn borrow_image(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
        if self.image.is_none() {
            let loaded = servo.with(|servo| servo.take_image());
            let Some(loaded) = loaded else { return Err(Denial::Mode(servo.with(|servo| servo.mode()))) };
            self.image = Some(loaded.unload());
        }
        Ok(())
    }

    /// Reads the image of a slot into the buffer and puts it in use; gives counter and key of a signed one.
    ///
    /// Not inlined, as what else is done seldom: every request stands upon the frame of the service.
    #[inline(never)]
    pub fn load(
        &mut self,
        wanted: ActiveImage,
        settings: &Settings,
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<Option<(Counted, KeyId)>, Denial> {
        self.borrow_image(servo)?;
        self.active = None;
        let buffer = self.image.take().ok_or(Denial::Busy)?;
        let counted = match slots::read(&mut self.flash, wanted.slot, wanted.crc, buffer) {
            Ok((length, binding)) => {
                let image = buffer.get(..length).unwrap_or(&[]);
                let counted = match self.ledger.admit(&mut self.flash, image, &binding, self.board.class) {
                    Ok(counted) => counted,
                    Err(error) => {
                        self.image = Some(buffer);
                        return Err(Denial::Untrusted(error));
                    }
                };
                self.put_in_use(buffer, length, settings, servo)?;
                counted
            }
            Err(denial) => {
                self.image = Some(buffer);
                if matches!(denial, Denial::Image(_) | Denial::Checksum { .. } | Denial::Flash { .. })
                    && let Some(slot) = self.slots.get_mut(usize::from(wanted.slot))
                {
                    *slot = Slot::Damaged;
                }
                return Err(denial);
            }
        };
        self.active = Some(wanted);
        Ok(counted)
    }

    /// Makes the rewriter anew for other settings, from the image in the buffer.
    pub fn reload(&mut self, settings: &Settings, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
        let Some(active) = self.active else { return Ok(()) };
        self.borrow_image(servo)?;
        let Some(&Slot::Image { length, .. }) = self.slots.get(usize::from(active.slot)) else {
            return Err(Denial::NoImage { slot: active.slot });
        };
        let buffer = self.image.take().ok_or(Denial::Busy)?;
        self.put_in_use(buffer, length as usize, settings, servo)
    }

    /// The image that was in use, read anew after the buffer served for something else. If the flash does not give it
    /// any more, none is in use.
    pub fn back_to(&mut self, before: Option<ActiveImage>, servo: &mut impl ServoAccess<'a>) {
        let settings = self.settings().rewriter;
        self.active = None;
        if let Some(before) = before {
            let _ = self.load(before, &settings, servo).and_then(|counted| self.count(counted, servo));
        }
    }

    fn put_in_use(
        &mut self,
        buffer: &'a mut [u8],
        length: usize,
        settings: &Settings,
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<(), Denial> {
        let loaded = Loaded::load(buffer, length, settings).map_err(|(buffer, error)| {
            self.image = Some(buffer);
            Denial::from(error)
        })?;
        let (back, mode) = servo.with(|servo| (servo.give_image(loaded), servo.mode()));
        match back {
            None => Ok(()),
            Some(loaded) => {
                self.image = Some(loaded.unload());
                Err(Denial::Mode(mode))
            }
        }
    }
}
