//! Uploads: an image to the idle slot, the other items to RAM.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::link::{CHUNK_BYTES, Denial, Item, Reply, Slot};

use super::handler::{Handler, idle};
use crate::ram_upload::RamUpload;
use crate::servo::ServoAccess;
use crate::slots::{SLOT_IMAGE_BYTES, Upload};

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn begin<'s>(
        &mut self,
        item: Item,
        length: u32,
        crc: u32,
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        self.current = None;
        self.image_upload = None;
        self.program_upload = None;
        let offset = match item {
            Item::Image => self.begin_image(length, crc)?,
            Item::Firmware => self.begin_update(length, servo)?,
            Item::Program | Item::Job | Item::Probe => self.ram_upload(item)?.begin(length, crc)?,
        };
        self.current = Some(item);
        Ok(Reply::Next { offset })
    }

    fn begin_image(&mut self, length: u32, crc: u32) -> Result<u32, Denial> {
        self.slots_are_free()?;
        let most = SLOT_IMAGE_BYTES as u32;
        if length == 0 || length > most {
            return Err(Denial::TooLong { item: Item::Image, length, most });
        }
        let slots = self.list();
        let upload = match Upload::begin(&mut self.flash, &slots, length, crc) {
            Ok(upload) => upload,
            Err((slot, denial)) => {
                self.slots[usize::from(slot)] = Slot::Damaged;
                return Err(denial);
            }
        };
        if !upload.is_committed() {
            self.slots[usize::from(upload.slot())] = upload.held();
        }
        let next = upload.next();
        self.image_upload = Some(upload);
        Ok(next)
    }

    pub fn chunk<'s>(
        &mut self,
        offset: u32,
        bytes: &[u8],
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        let item = self.current.ok_or(Denial::NoUpload)?;
        let too_long = bytes.len() > CHUNK_BYTES;
        if let Some(upload) = self.program_upload.filter(|_| item == Item::Firmware) {
            if too_long {
                return Err(Denial::Offset { expected: upload.next(), found: offset, bytes: bytes.len() as u32 });
            }
            return Ok(Reply::Next { offset: self.update_chunk(offset, bytes, servo)? });
        }
        let Some(upload) = self.image_upload.as_mut().filter(|_| item == Item::Image) else {
            let ram_upload = self.ram_upload(item)?;
            if too_long {
                return Err(Denial::Offset { expected: ram_upload.next(), found: offset, bytes: bytes.len() as u32 });
            }
            return Ok(Reply::Next { offset: ram_upload.chunk(offset, bytes)? });
        };
        if too_long {
            return Err(Denial::Offset { expected: upload.next(), found: offset, bytes: bytes.len() as u32 });
        }
        let done = upload.chunk(&mut self.flash, offset, bytes);
        // An image that was there before stays one.
        let (slot, held) = (upload.slot(), (!upload.is_committed()).then(|| upload.held()));
        if let Err(Denial::Flash { .. }) = done {
            // What is in the slot is found out by the next `Begin`.
            self.current = None;
            self.image_upload = None;
        }
        if let Some(held) = held {
            self.slots[usize::from(slot)] = held;
        }
        Ok(Reply::Next { offset: done? })
    }

    pub fn commit<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        let item = self.current.ok_or(Denial::NoUpload)?;
        if item == Item::Firmware {
            return Ok(Reply::Committed { slot: 0, crc: self.commit_update(servo)? });
        }
        if item != Item::Image {
            let crc = self.ram_upload(item)?.commit()?;
            return Ok(Reply::Committed { slot: 0, crc });
        }
        let before = self.active;
        let mut upload = self.image_upload.ok_or(Denial::NoUpload)?;
        upload.is_complete()?;
        if before.is_some() {
            self.borrow_image(servo)?;
        }
        let buffer = self.image.as_deref_mut().ok_or(Denial::Busy)?;
        let (ledger, class) = (&self.ledger, self.board.class);
        let done = upload.commit(&mut self.flash, buffer, |flash, bytes, binding| {
            ledger.admit(flash, bytes, binding, class).map(|_| ())
        });
        self.back_to(before, servo);
        self.slots[usize::from(upload.slot())] = match done {
            Ok(held) => held,
            Err(_) => Slot::Damaged,
        };
        self.current = None;
        self.image_upload = None;
        done.map(|_| Reply::Committed { slot: upload.slot(), crc: upload.crc() })
    }

    fn ram_upload(&mut self, item: Item) -> Result<&mut RamUpload<'a>, Denial> {
        let ram_uploads = self.ram_uploads.as_mut().ok_or(Denial::Busy)?;
        match item {
            Item::Program => Ok(&mut ram_uploads.program),
            Item::Job => Ok(&mut ram_uploads.job),
            Item::Probe => Ok(&mut ram_uploads.probe),
            Item::Image | Item::Firmware => Err(Denial::NoUpload),
        }
    }
}
