//! The loader: which program a board starts, and the change from one to the other.
//!
//! It is `embassy-boot`, on this flash: the update lies in both image slots, and is swapped with the program, sector by sector;
//! a start that is not confirmed is undone at the next. Power may fail at any operation of the flash: the swap goes on where it
//! stopped ([`Memory`]). The program marks an update and confirms itself through the same record.
//!
//! | what is remembered | at the next start |
//! |---|---|
//! | nothing, "booted", "reverted" | the program starts |
//! | "swap", not all sectors swapped | the swap goes on, the update starts on trial |
//! | "swap", all sectors swapped | the trial was not confirmed: the program before comes back |
//!
//! A program on trial whose digest is not the one of its head is not started at all.

mod memory;
mod part;

use core::cell::RefCell;

use embassy_boot::{AlignedBuffer, BlockingFirmwareState, BootLoader, BootLoaderConfig, State};
use embedded_storage::nor_flash::NorFlash;
pub use memory::Memory;
pub use part::{Failed, Programs, Shared};

use crate::flash::{PROGRAM_SECTORS, UPDATE_SECTORS, WORD_BYTES};
use crate::program;

/// Bytes that are copied at once.
const COPIED: usize = 1024;

/// The flash did not take or give what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoaderFailed;

/// Which program is to be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// One that was confirmed, or came through the debug port.
    Settled,
    /// An update, for the first time.
    Trial,
    /// The one before, after an update that was not confirmed.
    RolledBack,
}

/// What is remembered, read.
fn state<F: NorFlash>(flash: &mut F) -> Result<State, LoaderFailed> {
    let mut word = AlignedBuffer([0; WORD_BYTES]);
    BlockingFirmwareState::new(Memory(flash), word.as_mut()).get_state().map_err(|_| LoaderFailed)
}

/// Which program runs, as the loader has left it.
///
/// # Errors
/// The flash cannot be read.
pub fn started<F: NorFlash>(flash: &mut F) -> Result<Start, LoaderFailed> {
    Ok(match state(flash)? {
        State::Swap => Start::Trial,
        State::Revert => Start::RolledBack,
        State::Boot | State::DfuDetach => Start::Settled,
    })
}

/// Has the update that was uploaded started at the next start. Takes an erase and two words.
///
/// # Errors
/// The flash did not take it: nothing has changed.
pub fn install<F: NorFlash>(flash: &mut F) -> Result<(), LoaderFailed> {
    let mut word = AlignedBuffer([0; WORD_BYTES]);
    let marked = BlockingFirmwareState::new(Memory(&mut *flash), word.as_mut()).mark_updated();
    if marked.is_ok() && state(flash)? == State::Swap { Ok(()) } else { Err(LoaderFailed) }
}

/// Keeps the program that is on trial. Takes an erase and two words.
///
/// # Errors
/// The flash did not take it: the program may still be on trial.
pub fn confirm<F: NorFlash>(flash: &mut F) -> Result<(), LoaderFailed> {
    let mut word = AlignedBuffer([0; WORD_BYTES]);
    let marked = BlockingFirmwareState::new(Memory(&mut *flash), word.as_mut()).mark_booted();
    if marked.is_ok() && state(flash)? == State::Boot { Ok(()) } else { Err(LoaderFailed) }
}

/// What the loader does at each start, before it jumps: swaps, or swaps back. Takes as long as 11 sectors are erased and
/// programmed, where there is something to do.
///
/// # Errors
/// The flash did not take it: the next start tries again.
pub fn prepare<F: NorFlash>(flash: &RefCell<F>) -> Result<Start, LoaderFailed> {
    let mut loader = BootLoader::new(BootLoaderConfig {
        active: Programs::new(Shared(flash), PROGRAM_SECTORS),
        dfu: Programs::new(Shared(flash), UPDATE_SECTORS),
        state: Memory(Shared(flash)),
    });
    let mut buffer = AlignedBuffer([0; COPIED]);
    loader.prepare_boot(buffer.as_mut()).map_err(|_| LoaderFailed)?;
    let start = started(&mut Shared(flash))?;
    if start != Start::Trial || program::running_is_whole(&mut Shared(flash)) {
        return Ok(start);
    }
    loader.prepare_boot(buffer.as_mut()).map_err(|_| LoaderFailed)?;
    started(&mut Shared(flash))
}
