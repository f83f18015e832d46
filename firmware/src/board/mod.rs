//! Boards: pins, UARTs, clock, flash and watchdog around the same servo and desk.
//!
//! A board needs a link (embedded-io-async, in byte streams), a store (embedded-storage's NOR flash) and a
//! [`Clock`](crate::clock::Clock); the desk and the servo know nothing else of it.

pub mod config_link;
mod outputs;
mod servo_cell;

#[cfg(feature = "board-nucleo-h743")]
pub mod nucleo_h743;
#[cfg(feature = "board-virtual")]
pub mod virtual_board;

pub use outputs::Outputs;
pub use servo_cell::{ServoCell, SetpointSide};
