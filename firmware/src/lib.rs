//! The coprocessor around the core: what a board needs to rewrite setpoints, without the board itself.
//!
//! | module | what it holds |
//! |---|---|
//! | [`clock`] | time, as an argument or a trait |
//! | [`flash`] | the rules of the flash, a model of it in RAM with power that can fail, the places in it |
//! | [`ledger`] | what is remembered over resets: armed passes of parts, active image, settings |
//! | [`slots`] | the two image slots, uploads and their commit word |
//! | [`program`] | the place of the program, the upload of an update of it |
//! | [`loader`] | which program is started: swap, trial, rollback |
//! | [`ram_upload`] | uploads to RAM: program, job, probe log |
//! | [`active`] | the image in use and the RAM it lies in |
//! | [`servo`] | the setpoint path |
//! | [`computation`] | the on-board correction |
//! | [`config_service`] | the requests of the configuration link |
//! | [`mod@bench`] | batches of both links in shared memory |
//! | [`device`] | all of it in one thread, for tests and for the bench of the host |
//! | [`stm32h743`] | what the board file of the NUCLEO sets, as numbers that the reference manual decides |
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
pub mod loader;
pub mod program;
pub mod ram_upload;
pub mod servo;
pub mod slots;
pub mod stm32h743;

#[cfg(any(feature = "board-virtual", feature = "board-nucleo-h743"))]
pub mod board;
