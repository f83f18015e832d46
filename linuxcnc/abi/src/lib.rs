//! The core of Truepath for C: what the LinuxCNC component links.
//!
//! There are two routes from LinuxCNC's setpoints to the drives: [`pc`], where the correction is computed in the servo
//! thread, and [`board`], the controller's end of a link to a coprocessor that computes it. Each has a module of functions
//! for C, which alone has unsafe code.
#![no_std]
#![deny(missing_docs)]
#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]

pub mod board;
pub mod board_abi;
pub mod convert;
#[cfg(feature = "component")]
mod panic;
pub mod pc;
pub mod pc_abi;
pub mod remote;
