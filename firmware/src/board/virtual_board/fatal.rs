//! The end of a run that must not go on: panic, fault, watchdog. The drives go first, then the log, then the reset.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;

use super::gpio::{DRIVE_ENABLE, FAULT, Output};
use super::{log, retained};

/// What cannot go on.
#[derive(Clone, Copy, Debug)]
pub enum Cause {
    /// An interrupt that nothing should raise.
    UnexpectedInterrupt,
    /// A fault of the processor.
    HardFault {
        /// Where.
        pc: u32,
    },
}

fn drop_drives() {
    use embedded_hal::digital::OutputPin as _;
    let _enable = Output::low(DRIVE_ENABLE);
    let Ok(()) = Output::low(FAULT).set_high();
}

/// Drops the drive enable, says why, resets.
pub fn stop(cause: Cause) -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    if !log::is_taken() {
        match cause {
            Cause::UnexpectedInterrupt => defmt::error!("unexpected interrupt; drives disabled, reset"),
            Cause::HardFault { pc } => defmt::error!("hard fault at {=u32:#x}; drives disabled, reset", pc),
        }
    }
    SCB::sys_reset()
}

/// Drops the drive enable and waits for the second expiry.
pub fn watchdog_ran_out() -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    retained::announce_watchdog_reset();
    if !log::is_taken() {
        defmt::error!("watchdog ran out; drives disabled, reset follows");
    }
    loop {
        cortex_m::asm::nop();
    }
}

/// Resets by software, on request.
pub fn restart() -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    retained::announce_software_reset();
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    drop_drives();
    if !log::is_taken() {
        // File and line without the message: formatting it would bring the formatting of the core library along.
        match info.location() {
            Some(at) => defmt::error!("panic in {=str}:{=u32}; drives disabled, reset", at.file(), at.line()),
            None => defmt::error!("panic; drives disabled, reset"),
        }
    }
    SCB::sys_reset()
}
