//! The flash in parts: some of its sectors as a flash of their own, and one flash for several.

use core::cell::RefCell;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use crate::flash::{BLANK, Region, SECTOR_BYTES, WORD_BYTES, Word};

/// What a flash refuses, without its own words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed(pub NorFlashErrorKind);

impl NorFlashError for Failed {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

/// What `error` says.
pub(super) fn failed(error: impl NorFlashError) -> Failed {
    Failed(error.kind())
}

/// A flash that others use, too, one after the other.
pub struct Shared<'f, F>(pub &'f RefCell<F>);

impl<F> Clone for Shared<'_, F> {
    fn clone(&self) -> Self {
        Self(self.0)
    }
}

impl<F> ErrorType for Shared<'_, F> {
    type Error = Failed;
}

impl<F: NorFlash> ReadNorFlash for Shared<'_, F> {
    const READ_SIZE: usize = F::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        self.0.borrow_mut().read(offset, bytes).map_err(failed)
    }
    fn capacity(&self) -> usize {
        self.0.borrow().capacity()
    }
}

impl<F: NorFlash> NorFlash for Shared<'_, F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        self.0.borrow_mut().erase(from, to).map_err(failed)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        self.0.borrow_mut().write(offset, bytes).map_err(failed)
    }
}

/// Sectors that programs are copied between.
///
/// A torn word reads as ones, so that damage to one program never keeps the loader from bringing the other one back; whether
/// a program is whole its digest says. A word of ones is not programmed, it reads the same.
pub struct Programs<F> {
    flash: F,
    region: Region,
}

impl<F> Programs<F> {
    /// Those of a region.
    pub const fn new(flash: F, region: Region) -> Self {
        Self { flash, region }
    }
    fn at(&self, offset: u32, length: usize) -> Result<u32, Failed> {
        let within = (offset as usize).checked_add(length).is_some_and(|end| end <= self.region.len());
        if within { Ok(self.region.start() + offset) } else { Err(Failed(NorFlashErrorKind::OutOfBounds)) }
    }
}

impl<F> ErrorType for Programs<F> {
    type Error = Failed;
}

impl<F: NorFlash> ReadNorFlash for Programs<F> {
    const READ_SIZE: usize = WORD_BYTES;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        let start = self.at(offset, bytes.len())?;
        for (piece, at) in bytes.chunks_mut(WORD_BYTES).zip((start..).step_by(WORD_BYTES)) {
            let word = Word::read(&mut self.flash, at).written().unwrap_or(BLANK);
            piece.copy_from_slice(word.get(..piece.len()).unwrap_or_default());
        }
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.region.len()
    }
}

impl<F: NorFlash> NorFlash for Programs<F> {
    const WRITE_SIZE: usize = WORD_BYTES;
    const ERASE_SIZE: usize = SECTOR_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        let length = to.checked_sub(from).ok_or(Failed(NorFlashErrorKind::OutOfBounds))?;
        let start = self.at(from, length as usize)?;
        self.flash.erase(start, start + length).map_err(failed)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        let start = self.at(offset, bytes.len())?;
        for (word, at) in bytes.chunks(WORD_BYTES).zip((start..).step_by(WORD_BYTES)) {
            if word != BLANK {
                self.flash.write(at, word).map_err(failed)?;
            }
        }
        Ok(())
    }
}
