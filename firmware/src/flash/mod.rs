//! Flash: the rules of that of the STM32H743, a model of it in RAM, and who lives in which sector.
//!
//! Everything above this module uses the traits of embedded-storage, so that the flash of a board and the model are
//! interchangeable. The model belongs to the product: the virtual board stores in it, and the tests cut its power.
//!
//! Rules (RM0433, "Embedded flash memory"): sectors of 128 KiB, erased one at a time to ones; words of 32
//! bytes with ten bits of error-correcting code of their own, hence programmed once after an erase, also with equal
//! data; a word whose programming was interrupted reads as an ECC error; a sector whose erase was interrupted may
//! hold anything.

mod bank;
mod nor;

pub use bank::{
    BANK_BYTES, BANK_WORDS, BLANK, FIELDS, FLASH_BYTES, FLASH_WORDS, LEDGER_SECTORS, LOADER_SECTORS, PROGRAM_SECTORS,
    Region, SECTOR_BYTES, SECTORS, SLOT_BYTES, SLOT_SECTORS, UPDATE_SECTORS, WORD_BYTES, Word, opened, sealed,
    sector_start,
};
pub use nor::{Cut, Moment, Nor, NorError, Wear, WordState};
