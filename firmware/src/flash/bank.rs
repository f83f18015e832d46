//! The flash: its sectors and words, and who lives in which sector: image slot A in 0…2, image slot B in 3…5, the
//! ledger in 6 and 7, what the loader remembers in 8 and 9, the program in 10…14.
//!
//! Slots and ledger share no sector, so that an erase for one can never cost the other anything. The bank, 0…9, is what the
//! program writes; the program itself is written by the loader alone. A flash that ends with the bank is that of a device
//! without a loader. A firmware update lies in both image slots, which have one sector more than a program: the loader
//! needs it to swap both.

use embedded_storage::nor_flash::ReadNorFlash;
use truepath_core::image::crc32;

/// Bytes of a sector, the least that can be erased.
pub const SECTOR_BYTES: usize = 128 * 1024;
/// Sectors of the bank.
pub const SECTORS: usize = 10;
/// Bytes of the bank.
pub const BANK_BYTES: usize = SECTORS * SECTOR_BYTES;
/// Bytes of a word, the least that can be programmed.
pub const WORD_BYTES: usize = 32;
/// Words of the bank.
pub const BANK_WORDS: usize = BANK_BYTES / WORD_BYTES;
/// A word as an erase leaves it.
pub const BLANK: [u8; WORD_BYTES] = [0xFF; WORD_BYTES];

/// Sectors of the image slots A and B.
pub const SLOT_SECTORS: [Region; 2] = [Region { first: 0, count: 3 }, Region { first: 3, count: 3 }];
/// Sectors of the ledger.
pub const LEDGER_SECTORS: Region = Region { first: 6, count: 2 };
/// Sectors of what the loader remembers.
pub const LOADER_SECTORS: Region = Region { first: 8, count: 2 };
/// Sectors of the program.
pub const PROGRAM_SECTORS: Region = Region { first: 10, count: 5 };
/// Sectors of an update: both image slots.
pub const UPDATE_SECTORS: Region = Region { first: 0, count: 6 };
/// Bytes of the whole flash, the program included.
pub const FLASH_BYTES: usize = PROGRAM_SECTORS.end() as usize;
/// Words of the whole flash.
pub const FLASH_WORDS: usize = FLASH_BYTES / WORD_BYTES;
/// Bytes of an image slot, head included.
pub const SLOT_BYTES: usize = 3 * SECTOR_BYTES;

const _: () = assert!(LOADER_SECTORS.first == LEDGER_SECTORS.first + LEDGER_SECTORS.count);
const _: () = assert!(LOADER_SECTORS.first + LOADER_SECTORS.count == SECTORS && PROGRAM_SECTORS.first == SECTORS);
const _: () = assert!(UPDATE_SECTORS.first == 0 && UPDATE_SECTORS.count == LEDGER_SECTORS.first);
const _: () = assert!(UPDATE_SECTORS.count == PROGRAM_SECTORS.count + 1);
const _: () = assert!(SLOT_SECTORS[0].count * SECTOR_BYTES == SLOT_BYTES);
const _: () = assert!(SLOT_SECTORS[1].first == SLOT_SECTORS[0].first + SLOT_SECTORS[0].count);
const _: () = assert!(LEDGER_SECTORS.first == SLOT_SECTORS[1].first + SLOT_SECTORS[1].count);

/// Neighbouring sectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Number of the first sector in the bank.
    pub first: usize,
    /// How many.
    pub count: usize,
}

/// Offset of a sector from the start of the bank, bytes.
pub const fn sector_start(sector: usize) -> u32 {
    (sector * SECTOR_BYTES) as u32
}

impl Region {
    /// Offset of its first byte.
    pub const fn start(self) -> u32 {
        sector_start(self.first)
    }
    /// Offset of the byte after its last.
    pub const fn end(self) -> u32 {
        sector_start(self.first + self.count)
    }
    /// Bytes.
    pub const fn len(self) -> usize {
        self.count * SECTOR_BYTES
    }
    /// Whether it has no sector.
    pub const fn is_empty(self) -> bool {
        self.count == 0
    }
}

/// What a word holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// Ones: erased, or programmed with ones, which nobody can tell apart. Words of ones are therefore never
    /// programmed.
    Blank,
    /// Something else.
    Written([u8; WORD_BYTES]),
    /// It cannot be read.
    Torn,
}

impl Word {
    /// The word at an offset, a multiple of 32.
    pub fn read<F: ReadNorFlash>(flash: &mut F, offset: u32) -> Self {
        let mut bytes = BLANK;
        match flash.read(offset, &mut bytes) {
            Ok(()) if bytes == BLANK => Self::Blank,
            Ok(()) => Self::Written(bytes),
            Err(_) => Self::Torn,
        }
    }
    /// Its bytes, if it holds some.
    pub fn written(self) -> Option<[u8; WORD_BYTES]> {
        match self {
            Self::Written(bytes) => Some(bytes),
            _ => None,
        }
    }
    /// Whether it can be programmed.
    pub fn is_blank(self) -> bool {
        self == Self::Blank
    }
}

/// Fields of a sealed word.
pub const FIELDS: usize = WORD_BYTES / 4 - 2;

/// A word that tells what it is and whether it is whole, little endian: 0 magic, 4 fields, 28 CRC-32 of the 28 bytes before.
pub fn sealed(magic: [u8; 4], fields: [u32; FIELDS]) -> [u8; WORD_BYTES] {
    let mut word = [0; WORD_BYTES];
    let (places, _) = word.as_chunks_mut::<4>();
    for (place, field) in places.iter_mut().zip([u32::from_le_bytes(magic)].into_iter().chain(fields)) {
        *place = field.to_le_bytes();
    }
    let sum = crc32(&word[..WORD_BYTES - 4]);
    word[WORD_BYTES - 4..].copy_from_slice(&sum.to_le_bytes());
    word
}

/// The fields of a sealed word of this magic; none of any other word.
pub fn opened(magic: [u8; 4], word: &[u8; WORD_BYTES]) -> Option<[u32; FIELDS]> {
    let fields = core::array::from_fn(|k| u32::from_le_bytes(core::array::from_fn(|byte| word[4 + 4 * k + byte])));
    (sealed(magic, fields) == *word).then_some(fields)
}
