//! Words that outlive a reset: why it happened, and whether the flash model holds anything.
//!
//! They lie outside every section of the image (`memory.x`), because the emulator loads those anew at a reset. At
//! power-up all RAM of the emulator is zero.

use truepath_core::link::ResetCause;

const SOFTWARE: u32 = 0x5253_5401;
const WATCHDOG: u32 = 0x5253_5402;
const RUNNING: u32 = 0x5253_5403;
const LOADER: u32 = 0x5253_5404;

unsafe extern "C" {
    static mut _retained_start: [u32; 2];
}

fn word(index: usize) -> *mut u32 {
    // SAFETY: `memory.x` reserves 64 bytes there; only the address is taken.
    unsafe { (&raw mut _retained_start).cast::<u32>().add(index) }
}

fn store(cause: u32) {
    // SAFETY: an aligned word that nothing else refers to.
    unsafe { word(0).write_volatile(cause) };
}

/// Why the last reset happened.
pub fn cause() -> ResetCause {
    // SAFETY: as in `store`.
    match unsafe { word(0).read_volatile() } {
        SOFTWARE => ResetCause::Software,
        WATCHDOG => ResetCause::Watchdog,
        RUNNING => ResetCause::Pin,
        _ => ResetCause::PowerOn,
    }
}
/// The same; from here on a reset that nobody announces is one by the pin (`system_reset` of the emulator's monitor).
pub fn take_cause() -> ResetCause {
    let cause = cause();
    store(RUNNING);
    cause
}

/// The loader starts the program.
pub fn announce_loader() {
    // SAFETY: as in `store`.
    unsafe { word(1).write_volatile(LOADER) };
}
/// Whether a loader started the program.
pub fn has_loader() -> bool {
    // SAFETY: as in `store`.
    unsafe { word(1).read_volatile() == LOADER }
}

/// Announces a reset by software.
pub fn announce_software_reset() {
    store(SOFTWARE);
}

/// Announces a reset by the watchdog.
pub fn announce_watchdog_reset() {
    store(WATCHDOG);
}
