//! All that the servo cycle needs, and nothing else: the surface to audit before this code may move axes.
//!
//! Its place: above `truepath-units`, beside `truepath-model`; the firmware, the command line and the C interface call
//! it, mostly through `truepath-core`. Data flows downwards; a module never names one below it:
//!
//! | module | what it holds |
//! |---|---|
//! | [`image`] | correction array ↔ bytes |
//! | [`rewrite`] | setpoint → corrected setpoint, the only code in the servo cycle |
//! | [`update`] | the signed head of a firmware update |
//! | [`link`] | frames and messages of both links, and what becomes of a frame |
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]

#[cfg(test)]
extern crate std;

pub mod image;
pub mod link;
pub mod rewrite;
pub mod update;
