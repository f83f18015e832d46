//! How a sector of the ledger is divided: places for records, behind them some for the counters of images, the last for
//! the keys.

use crate::flash::SECTOR_BYTES;

/// Bytes of a place.
pub const PLACE_BYTES: usize = 1024;
/// Places in a sector.
pub const ALL_PLACES: usize = SECTOR_BYTES / PLACE_BYTES;
/// Places for counters in a sector.
pub const COUNTER_PLACES: usize = 4;
/// Places for records in a sector.
pub const PLACES: usize = ALL_PLACES - COUNTER_PLACES - 1;
