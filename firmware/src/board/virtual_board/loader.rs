//! The loader of the virtual board: it lies where the emulator loads an image anew at every reset, the program where it keeps
//! what was written.
//!
//! At power-up the flash is blank, and the program of the factory, which the host puts beside the loader, is programmed.

use core::cell::RefCell;

use cortex_m::peripheral::SCB;
use embedded_storage::nor_flash::NorFlash;
use truepath_core::link::ResetCause;

use super::{memory, retained, watchdog};
use crate::board::start_program;
use crate::flash::{PROGRAM_SECTORS, WORD_BYTES};
use crate::loader::{Programs, Shared, Start, prepare};

/// Runs the loader. Called once, by the entry of its image.
pub fn run() -> ! {
    let cause = retained::cause();
    let flash = RefCell::new(memory::whole_flash(cause));
    let settled = if cause == ResetCause::PowerOn {
        Programs::new(Shared(&flash), PROGRAM_SECTORS).write(0, memory::factory_program()).is_ok()
    } else {
        true
    };
    let start = prepare(&flash);
    let wear = flash.borrow().wear();
    match start {
        Ok(start) if settled => {
            defmt::info!(
                "loader: {=u8}, {=u32} sectors, {=u32} words",
                start as u8,
                wear.erased_sectors,
                wear.programmed_words
            );
            if start == Start::Trial {
                watchdog::start_trial();
            }
            retained::announce_loader();
            // SAFETY: no interrupt is unmasked, and nothing of the loader is used behind it.
            unsafe { start_program(memory::program_start()) }
        }
        _ => {
            defmt::error!("loader: the flash failed; reset");
            SCB::sys_reset()
        }
    }
}

const _: () = assert!(PROGRAM_SECTORS.len().is_multiple_of(WORD_BYTES));
