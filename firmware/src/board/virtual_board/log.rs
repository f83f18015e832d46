//! The log: defmt frames (rzCOBS) on UART 3, as they are.
//!
//! A frame is written within a critical section, so frames of different priorities do not mix. A byte that the UART does
//! not take in time is dropped: the log holds up neither the links nor a reset.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

use critical_section::RestoreState;

use super::uart::Port;

#[defmt::global_logger]
struct Log;

struct Held {
    encoder: UnsafeCell<defmt::Encoder>,
    restore: UnsafeCell<RestoreState>,
}

// SAFETY: only touched between `acquire` and `release`, with interrupts off.
unsafe impl Sync for Held {}

static HELD: Held =
    Held { encoder: UnsafeCell::new(defmt::Encoder::new()), restore: UnsafeCell::new(RestoreState::invalid()) };
static TAKEN: AtomicBool = AtomicBool::new(false);

fn send(bytes: &[u8]) {
    bytes.iter().for_each(|byte| Port::Log.send_or_drop(*byte));
}

// SAFETY: `acquire` begins a critical section that `release` ends, so there is one writer at a time.
unsafe impl defmt::Logger for Log {
    fn acquire() {
        // SAFETY: paired with the release below.
        let restore = unsafe { critical_section::acquire() };
        TAKEN.store(true, Ordering::Relaxed);
        // SAFETY: interrupts are off.
        unsafe {
            *HELD.restore.get() = restore;
            (*HELD.encoder.get()).start_frame(send);
        }
    }
    unsafe fn flush() {}
    unsafe fn release() {
        // SAFETY: interrupts are still off, by `acquire`.
        unsafe {
            (*HELD.encoder.get()).end_frame(send);
            TAKEN.store(false, Ordering::Relaxed);
            critical_section::release(*HELD.restore.get());
        }
    }
    unsafe fn write(bytes: &[u8]) {
        // SAFETY: called between `acquire` and `release`.
        unsafe { (*HELD.encoder.get()).write(bytes, send) };
    }
}

/// Whether a frame is being written: then a fault handler must not begin another.
pub fn is_taken() -> bool {
    TAKEN.load(Ordering::Relaxed)
}
