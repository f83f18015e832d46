//! How a sector of the ledger is divided: places for records, and behind them one for the keys.

use crate::flash::SECTOR_BYTES;

/// Bytes of a place.
pub const PLACE_BYTES: usize = 1024;
/// Places for records in a sector.
pub const PLACES: usize = SECTOR_BYTES / PLACE_BYTES - 1;
