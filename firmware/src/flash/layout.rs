//! Who lives in which sector of the bank: image slot A in 0…2, image slot B in 3…5, the ledger in 6 and 7.
//!
//! Slots and ledger share no sector, so that an erase for one can never cost the other anything.

use super::{SECTOR_BYTES, SECTORS};

/// Sectors of the image slots A and B.
pub const SLOT_SECTORS: [Region; 2] = [Region { first: 0, count: 3 }, Region { first: 3, count: 3 }];
/// Sectors of the ledger.
pub const LEDGER_SECTORS: Region = Region { first: 6, count: 2 };
/// Bytes of an image slot, head included.
pub const SLOT_BYTES: usize = 3 * SECTOR_BYTES;

const _: () = assert!(LEDGER_SECTORS.first + LEDGER_SECTORS.count == SECTORS);
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
