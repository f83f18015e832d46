//! Boards: pins, UARTs, clock, flash and watchdog around the same servo and configuration service.
//!
//! A board needs a link (embedded-io-async, in byte streams), a store (embedded-storage's NOR flash) and a
//! [`Clock`](crate::clock::Clock); servo and configuration service know nothing else of it.

pub mod config_link;
pub mod outputs;
pub mod shared_servo;

#[cfg(feature = "board-nucleo-h743")]
pub mod nucleo_h743;
#[cfg(feature = "board-virtual")]
pub mod virtual_board;
