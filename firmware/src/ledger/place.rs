//! How a sector of the ledger is divided: places for records, behind them some for the log, some for the counters of images,
//! the last for the keys.

use crate::flash::SECTOR_BYTES;

/// Bytes of a place.
pub const PLACE_BYTES: usize = 1024;
/// Places in a sector.
pub const ALL_PLACES: usize = SECTOR_BYTES / PLACE_BYTES;
/// Places for counters in a sector.
pub const COUNTER_PLACES: usize = 4;
/// The first of them.
pub const FIRST_COUNTER_PLACE: usize = ALL_PLACES - 1 - COUNTER_PLACES;
/// Places for the log in a sector.
pub const LOG_PLACES: usize = 12;
/// Places for records in a sector; the log lies behind them.
pub const PLACES: usize = FIRST_COUNTER_PLACE - LOG_PLACES;

const _: () = assert!(
    PLACES + LOG_PLACES + COUNTER_PLACES + 1 == ALL_PLACES,
    "the parts fill a sector; the last place is that of the keys"
);
