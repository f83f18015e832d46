//! The coprocessor around the core: what a board needs to rewrite setpoints, without the board itself.
//!
//! | module | what it holds |
//! |---|---|
//! | [`clock`] | time, as an argument or a trait |
//! | [`flash`] | the rules of the flash, a model of it in RAM with power that can fail, the places in it |
//! | [`ledger`] | what is remembered over resets: armed passes of parts, active image, settings |
//! | [`slots`] | the two image slots, uploads and their commit word |
//! | [`ram_upload`] | uploads to RAM: program, job, probe log |
//! | [`active`] | the image in use and the RAM it lies in |
//! | [`servo`] | the setpoint path |
//! | [`computation`] | the on-board correction |
//! | [`config_service`] | the requests of the configuration link |
//! | [`mod@bench`] | batches of both links in shared memory |
//! | [`device`] | all of it in one thread, for tests and for the bench of the host |
//!
//! A module never names one below it in this list. Boards are made of the same parts in their own interrupts.
#![no_std]
#![deny(missing_docs)]
// Only a board needs it.
#![cfg_attr(not(target_os = "none"), forbid(unsafe_code))]

pub mod active;
pub mod bench;
pub mod clock;
pub mod computation;
pub mod config_service;
pub mod device;
pub mod flash;
pub mod ledger;
pub mod ram_upload;
pub mod servo;
pub mod slots;

#[cfg(any(feature = "board-virtual", feature = "board-nucleo-h743"))]
pub mod board;
