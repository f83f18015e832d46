//! The on-board correction, as the desk sees it: collect what is needed, lend it out, write what was made.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::Image;
use truepath_core::link::{ComputeFailure, Computed, Denial, Item, Progress, Reply, Slot, Stage};

use super::Desk;
use super::office::{Office, idle};
use crate::servo::ServoAccess;
use crate::slots::Upload;
use crate::work::Work;

impl<'a, F: NorFlash> Desk<'a, F> {
    /// A computation that was asked for: to be run at the lowest priority and given to [`Desk::finish`].
    pub fn take_work(&mut self) -> Option<Work<'a>> {
        self.office.work.take()
    }

    /// Writes the image that was made to the idle slot, and lets requests use the buffers again. Takes as long as an
    /// upload does.
    pub fn finish(&mut self, work: Work<'a>, servo: &impl ServoAccess<'a>) {
        self.office.finish(work, servo);
    }
}

impl<'a, F: NorFlash> Office<'a, F> {
    pub fn compute<'s>(&mut self, servo: &impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        idle(servo)?;
        self.not_computing()?;
        let shelves = self.shelves.as_ref().ok_or(Denial::Busy)?;
        for (item, shelf) in
            [(Item::Program, &shelves.program), (Item::Job, &shelves.job), (Item::Probe, &shelves.probe)]
        {
            shelf.content().ok_or(Denial::Missing(item))?;
        }
        self.borrow_image(servo)?;
        self.current = None;
        self.upload = None;
        let (Some(shelves), Some(image)) = (self.shelves.take(), self.image.take()) else {
            return Err(Denial::Busy);
        };
        self.work = Some(Work::new(shelves, image, self.meter));
        self.computing = true;
        self.progress = Progress::default();
        Ok(Reply::Done)
    }

    fn finish(&mut self, work: Work<'a>, servo: &impl ServoAccess<'a>) {
        let Work { shelves, image, made, .. } = work;
        let not_run = ComputeFailure { stage: Stage::Job, code: 0, line: 0, column: 0 };
        let result = made.unwrap_or(Err(not_run)).and_then(|bytes| self.write(image.get(..bytes).unwrap_or(&[])));
        self.shelves = Some(shelves);
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
