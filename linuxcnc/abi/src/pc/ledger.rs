//! The file that remembers which passes of parts were armed, and the counters of signed images that were in use.
//!
//! Little endian: `TRUEPLDG`, version 2 (u32), bytes of the content (u32), the content ([`Remembered`] in postcard), CRC-32
//! of everything before it. Version 1 held no counters, and is read. The component writes a new file beside it and renames, so it is whole or the one before.

use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};
use truepath_core::checksum::crc32;
use truepath_core::rewrite::SpentList;

use super::trust::Counters;

/// Room for the longest file.
pub const LEDGER_BYTES: usize = 2048;
const MAGIC: [u8; 8] = *b"TRUEPLDG";
const VERSION: u32 = 2;
/// Without counters.
const BEFORE: u32 = 1;
const HEAD: usize = 16;

/// Why a file is no ledger. Nothing can be armed then: what it remembered would be forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LedgerError {
    /// It is not one, or damaged.
    Damaged = 1,
    /// It is of another version.
    Version = 2,
}

/// What the file remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Remembered {
    /// Armed passes of parts.
    pub spent: SpentList,
    /// Counters of signed images.
    pub counters: Counters,
}

/// The content of a file.
///
/// # Errors
/// It is damaged or of another version.
pub(super) fn read(file: &[u8]) -> Result<Remembered, LedgerError> {
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(*file.get(at..)?.first_chunk()?)) };
    if !file.starts_with(&MAGIC) {
        return Err(LedgerError::Damaged);
    }
    let version = word(8).filter(|&version| version == VERSION || version == BEFORE).ok_or(LedgerError::Version)?;
    let content = || {
        let (body, crc) = file.split_last_chunk::<4>()?;
        let content = body.get(HEAD..)?;
        let whole = u32::from_le_bytes(*crc) == crc32(body) && word(12) == u32::try_from(content.len()).ok();
        let content = if version == BEFORE {
            postcard::from_bytes(content).ok().map(|spent| Remembered { spent, ..Remembered::default() })
        } else {
            postcard::from_bytes(content).ok()
        };
        content.filter(|_| whole)
    };
    content().ok_or(LedgerError::Damaged)
}

/// The file; gives its bytes.
pub(super) fn write(content: &Remembered, file: &mut [u8; LEDGER_BYTES]) -> usize {
    let room = file.get_mut(HEAD..).unwrap_or(&mut []);
    // There is room: the longest takes 17 bytes for each of its 40 armings and 64 counters.
    let used = postcard::serialize_with_flavor(content, Room { room, used: 0 }).unwrap_or(0);
    let head = MAGIC.into_iter().chain(VERSION.to_le_bytes()).chain((used as u32).to_le_bytes());
    for (to, from) in file.iter_mut().zip(head) {
        *to = from;
    }
    let end = HEAD.saturating_add(used);
    let crc = crc32(file.get(..end).unwrap_or(&[])).to_le_bytes();
    for (to, from) in file.iter_mut().skip(end).zip(crc) {
        *to = from;
    }
    end.saturating_add(crc.len())
}

/// Where postcard writes. Its own slice subtracts addresses at the end, with a panic that the proof finds.
struct Room<'a> {
    room: &'a mut [u8],
    used: usize,
}

impl Flavor for Room<'_> {
    type Output = usize;
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        *self.room.get_mut(self.used).ok_or(postcard::Error::SerializeBufferFull)? = byte;
        self.used = self.used.saturating_add(1);
        Ok(())
    }
    fn finalize(self) -> postcard::Result<usize> {
        Ok(self.used)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing, clippy::unwrap_used, clippy::arithmetic_side_effects)]
    use super::*;
    use truepath_core::image::Counted;
    use truepath_core::rewrite::Spent;

    fn full() -> Remembered {
        let mut full = Remembered::default();
        for feature in 0..100 {
            let (program_crc, pass) = (u32::MAX, u32::MAX);
            full.counters.raise(Counted { program_crc, feature, pass, counter: u32::MAX - feature });
            full.spent.spend(Spent { part_serial: u32::MAX, program_crc: u32::MAX, feature, pass: u32::MAX });
        }
        full
    }

    #[test]
    fn every_list_comes_back_from_its_file() {
        for list in [Remembered::default(), full()] {
            let mut file = [0; LEDGER_BYTES];
            let bytes = write(&list, &mut file);
            assert!(bytes < LEDGER_BYTES);
            assert_eq!(read(&file[..bytes]), Ok(list));
        }
    }

    #[test]
    fn a_flipped_bit_a_missing_and_an_added_byte_are_noticed() {
        let mut file = [0; LEDGER_BYTES];
        let bytes = write(&full(), &mut file);
        for bit in 0..8 * bytes {
            file[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&file[..bytes]).is_err(), "bit {bit}");
            file[bit / 8] ^= 1 << (bit % 8);
        }
        for end in 0..bytes {
            assert!(read(&file[..end]).is_err(), "{end} bytes");
        }
        assert_eq!(read(&file[..bytes + 1]), Err(LedgerError::Damaged));
        assert_eq!(read(b"TRUEPLDG\x03\0\0\0"), Err(LedgerError::Version));
    }

    #[test]
    fn a_file_from_before_there_were_counters_keeps_its_parts() {
        let spent = full().spent;
        let mut file = [0; LEDGER_BYTES];
        let used = postcard::to_slice(&spent, &mut file[HEAD..]).unwrap().len();
        file[..8].copy_from_slice(&MAGIC);
        file[8] = 1;
        file[12..HEAD].copy_from_slice(&(used as u32).to_le_bytes());
        let crc = crc32(&file[..HEAD + used]);
        file[HEAD + used..HEAD + used + 4].copy_from_slice(&crc.to_le_bytes());
        assert_eq!(read(&file[..HEAD + used + 4]), Ok(Remembered { spent, ..Remembered::default() }));
    }
}
