//! The loader of the board: swaps programs where that is to be done, and starts one.
//!
//! It runs at 64 MHz from the internal oscillator, as a reset leaves the part, and touches nothing but flash, watchdog and
//! the outputs, which float until the program drives them.

use core::cell::RefCell;

use cortex_m::peripheral::SCB;
use embassy_stm32::peripherals;

use super::flash::BoardFlash;
use super::watchdog;
use crate::board::start_program;
use crate::loader::{Start, prepare};

/// Where the program is read.
const PROGRAM: u32 = 0x0802_0000;
/// Clocks until the flash is tried again, a second.
const PAUSE: u32 = 64_000_000;

/// Runs the loader. Called once, by the entry of its image.
pub fn run() -> ! {
    // SAFETY: nothing else of the HAL runs here.
    let flash = RefCell::new(BoardFlash::of_loader(unsafe { peripherals::FLASH::steal() }));
    match prepare(&flash) {
        Ok(start) => {
            if start == Start::Trial {
                watchdog::start_trial();
            }
            // SAFETY: no interrupt is unmasked, and nothing of the loader is used behind it.
            unsafe { start_program(PROGRAM) }
        }
        Err(_) => {
            // What lies there may be half of each program.
            cortex_m::asm::delay(PAUSE);
            SCB::sys_reset()
        }
    }
}
