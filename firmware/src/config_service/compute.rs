//! The on-board correction, as a request: collect what it needs, lend it out, write the image it made.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Image, SignatureError};
use truepath_core::link::{ComputeFailure, Computed, Denial, Item, Progress, Reply, Slot, Stage};

use super::handler::{Handler, idle};
use crate::computation::Computation;
use crate::servo::ServoAccess;
use crate::slots::Upload;

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn compute<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        self.slots_are_free()?;
        // Nobody could sign what is made here.
        if !self.ledger.keys().is_open() {
            return Err(Denial::Untrusted(SignatureError::Missing));
        }
        let ram_uploads = self.ram_uploads.as_ref().ok_or(Denial::Busy)?;
        for (item, upload) in
            [(Item::Program, &ram_uploads.program), (Item::Job, &ram_uploads.job), (Item::Probe, &ram_uploads.probe)]
        {
            upload.content().ok_or(Denial::Missing(item))?;
        }
        self.borrow_image(servo)?;
        self.current = None;
        self.image_upload = None;
        let (Some(ram_uploads), Some(image)) = (self.ram_uploads.take(), self.image.take()) else {
            return Err(Denial::Busy);
        };
        self.computation = Some(Computation::new(ram_uploads, image, self.meter));
        self.computing = true;
        self.progress = Progress::default();
        Ok(Reply::Done)
    }

    pub fn finish(&mut self, computation: Computation<'a>, servo: &mut impl ServoAccess<'a>) {
        let Computation { uploads, image, made, .. } = computation;
        let not_run = ComputeFailure { stage: Stage::Job, code: 0, line: 0, column: 0 };
        let result = made.unwrap_or(Err(not_run)).and_then(|bytes| self.write(image.get(..bytes).unwrap_or(&[])));
        self.ram_uploads = Some(uploads);
        self.image = Some(image);
        self.progress = Progress { stage: Stage::Ended, permille: 1000, result: Some(result) };
        self.computing = false;
        let before = self.active;
        self.back_to(before, servo);
    }

    /// The image into the idle slot, as by an upload.
    fn write(&mut self, bytes: &[u8]) -> Result<Computed, ComputeFailure> {
        let failed = |code| ComputeFailure { stage: Stage::Write, code, line: 0, column: 0 };
        let image = Image::new_checked(bytes).map_err(|_| failed(IMAGE_FAILED))?;
        let (length, crc) = (bytes.len() as u32, image.crc());
        let slots = self.list();
        let upload = Upload::begin(&mut self.flash, &slots, length, crc);
        let mut upload = match upload {
            Ok(upload) => upload,
            Err((slot, _)) => {
                self.slots[usize::from(slot)] = Slot::Damaged;
                return Err(failed(FLASH_FAILED));
            }
        };
        let rest = bytes.get(upload.next() as usize..).unwrap_or(&[]);
        let offset = upload.next();
        let held = upload
            .chunk(&mut self.flash, offset, rest)
            .and_then(|_| upload.commit_equal(&mut self.flash, bytes, image.settings().binding));
        self.slots[usize::from(upload.slot())] = held.unwrap_or(Slot::Damaged);
        held.map_err(|_| failed(FLASH_FAILED))?;
        Ok(Computed { slot: upload.slot(), crc, length })
    }
}

/// Code of an image that was made but does not pass its check, `I001` of the command line.
const IMAGE_FAILED: u16 = 3_001;
/// Code of an image that the flash did not take.
const FLASH_FAILED: u16 = 5_001;
