//! What every room of the host stands on: units at the edge of the fixed-point core, errors with their place in a file,
//! files read and written whole, and the notation of the TOML files a user writes.
//!
//! Lowest room of the host; it knows the core's units and nothing of milling.

pub mod cholesky;
pub mod codes;
pub mod count;
pub mod decimal;
pub mod diagnostics;
pub mod document;
pub mod files;
pub mod hypotenuse;
pub mod interruption;
pub mod length;
pub mod library;
pub mod limits;
pub mod notation;
pub mod output;
pub mod rows;
pub mod sheet;
pub mod table;
pub mod units;
