//! What the loader remembers: the state that embassy-boot keeps, in two sectors that take turns.
//!
//! embassy-boot keeps a word that says what is to be done, a word that says that its record is about to be erased, and a word
//! for each sector that was copied. It erases all of them at once, and takes what an erase that was interrupted leaves for its
//! record: on a flash on which such an erase may leave anything, a swap would begin in the middle. Here an erase is one word:
//!
//! - A record is in the sector with the greatest generation in its first word ([`sealed`], `TPB1`: generation, zeros). An erase
//!   erases the *other* sector and programs that word there; before that the old record counts, behind it a blank one.
//! - So the word that tells of an erase says nothing, and is not programmed: with it, a power cut between it and the erase
//!   would be taken for a program that was rolled back.
//! - A word that was being programmed when the power failed reads as zeros: as "nothing is to be done" the first, as "was
//!   copied" one of the others, which are programmed behind the copy.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

use super::part::{Failed, failed};
use crate::flash::{BLANK, LOADER_SECTORS, SECTOR_BYTES, WORD_BYTES, Word, opened, sealed, sector_start};

const MAGIC: [u8; 4] = *b"TPB1";
/// Bytes of a record.
const RECORD_BYTES: usize = SECTOR_BYTES - WORD_BYTES;
/// Where embassy-boot says that its record is about to be erased.
const ERASING: u32 = WORD_BYTES as u32;

/// The record, as a flash of one sector whose erase is never interrupted.
pub struct Memory<F>(pub F);

impl<F: NorFlash> Memory<F> {
    /// Sector of the record, of the two, and its generation.
    fn current(&mut self) -> Option<(usize, u32)> {
        let generation = |sector: usize| {
            let word = Word::read(&mut self.0, start(sector)).written()?;
            opened(MAGIC, &word).map(|[generation, ..]| (sector, generation))
        };
        (0..LOADER_SECTORS.count).filter_map(generation).max_by_key(|&(_, generation)| generation)
    }
}

/// Where one of the two sectors begins.
const fn start(sector: usize) -> u32 {
    sector_start(LOADER_SECTORS.first + sector)
}

/// Refused unless these are whole words of the record.
fn check(offset: u32, length: usize) -> Result<(), Failed> {
    let end = (offset as usize).checked_add(length);
    match end {
        Some(end) if end > RECORD_BYTES => Err(Failed(NorFlashErrorKind::OutOfBounds)),
        Some(end) if end.is_multiple_of(WORD_BYTES) && length.is_multiple_of(WORD_BYTES) => Ok(()),
        _ => Err(Failed(NorFlashErrorKind::NotAligned)),
    }
}

impl<F> ErrorType for Memory<F> {
    type Error = Failed;
}

impl<F: NorFlash> ReadNorFlash for Memory<F> {
    const READ_SIZE: usize = WORD_BYTES;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        check(offset, bytes.len())?;
        let Some((sector, _)) = self.current() else {
            bytes.fill(0xFF);
            return Ok(());
        };
        let first = start(sector) + WORD_BYTES as u32 + offset;
        for (piece, at) in bytes.chunks_mut(WORD_BYTES).zip((first..).step_by(WORD_BYTES)) {
            let word = match Word::read(&mut self.0, at) {
                Word::Blank => BLANK,
                Word::Written(word) => word,
                Word::Torn => [0; WORD_BYTES],
            };
            piece.copy_from_slice(&word);
        }
        Ok(())
    }
    fn capacity(&self) -> usize {
        RECORD_BYTES
    }
}

impl<F: NorFlash> NorFlash for Memory<F> {
    const WRITE_SIZE: usize = WORD_BYTES;
    const ERASE_SIZE: usize = RECORD_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        if (from, to as usize) != (0, RECORD_BYTES) {
            return Err(Failed(NorFlashErrorKind::NotAligned));
        }
        let (sector, generation) = self.current().map_or((0, 1), |(sector, last)| (1 - sector, last.saturating_add(1)));
        let at = start(sector);
        self.0.erase(at, at + SECTOR_BYTES as u32).map_err(failed)?;
        self.0.write(at, &sealed(MAGIC, [generation, 0, 0, 0, 0, 0])).map_err(failed)?;
        if self.current() == Some((sector, generation)) { Ok(()) } else { Err(Failed(NorFlashErrorKind::Other)) }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        check(offset, bytes.len())?;
        if offset == ERASING && bytes.len() == WORD_BYTES {
            return Ok(());
        }
        let (sector, _) = self.current().ok_or(Failed(NorFlashErrorKind::Other))?;
        self.0.write(start(sector) + WORD_BYTES as u32 + offset, bytes).map_err(failed)
    }
}
