//! Flash: the rules of the STM32H743's second bank, a model of it in RAM, and who lives in which sector.
//!
//! Everything above this module uses the traits of embedded-storage, so that the bank of a board and the model are
//! interchangeable. The model belongs to the product: the virtual board stores in it, and the tests cut its power.
//!
//! Rules (RM0433, "Embedded flash memory"): eight sectors of 128 KiB, erased one at a time to ones; words of 32
//! bytes with ten bits of error-correcting code of their own, hence programmed once after an erase, also with equal
//! data; a word whose programming was interrupted reads as an ECC error; a sector whose erase was interrupted may
//! hold anything.

mod layout;
mod nor;
mod power;
mod word;

pub use layout::{LEDGER_SECTORS, Region, SLOT_BYTES, SLOT_SECTORS, sector_start};
pub use nor::{Nor, NorError, Wear, WordState};
pub use power::{Cut, Moment};
pub use word::Word;

/// Bytes of a sector, the least that can be erased.
pub const SECTOR_BYTES: usize = 128 * 1024;
/// Sectors of the bank.
pub const SECTORS: usize = 8;
/// Bytes of the bank.
pub const BANK_BYTES: usize = SECTORS * SECTOR_BYTES;
/// Bytes of a word, the least that can be programmed.
pub const WORD_BYTES: usize = 32;
/// Words of the bank.
pub const BANK_WORDS: usize = BANK_BYTES / WORD_BYTES;
/// A word as an erase leaves it.
pub const BLANK: [u8; WORD_BYTES] = [0xFF; WORD_BYTES];
