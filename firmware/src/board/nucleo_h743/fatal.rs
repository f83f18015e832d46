//! The end of a run that must not go on: panic or fault. The drives go first, then the log, then the reset.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

use super::outputs::drop_drives;

/// Whether the end has begun: a fault inside the log must not begin another log.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Resets by software, on request.
pub fn restart() -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    drop_drives();
    if !ENDING.swap(true, Ordering::Relaxed) {
        defmt::error!("hard fault at {=u32:#x}; drives disabled, reset", frame.pc());
    }
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    if !ENDING.swap(true, Ordering::Relaxed) {
        // File and line without the message: formatting it would bring the formatting of the core library along.
        match info.location() {
            Some(at) => defmt::error!("panic in {=str}:{=u32}; drives disabled, reset", at.file(), at.line()),
            None => defmt::error!("panic; drives disabled, reset"),
        }
    }
    SCB::sys_reset()
}
