//! The end of a transfer on SPI: the rising edge of the select input, PA4, as interrupt of line 4.
//!
//! The input belongs to the SPI; the edge detector reads it beside (RM0433, 20.3 and 12.3.3).

use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::pac::{EXTI, SYSCFG};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;

use super::interrupts::SETPOINT_LINK;

/// Line of the detector, the number of the pin.
const LINE: usize = 4;

/// Signalled at each edge.
pub static DESELECTED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Starts to watch.
pub fn start() {
    // Port A is number 0; four lines share a register.
    SYSCFG.exticr(LINE / 4).modify(|w| w.set_exti(LINE % 4, 0));
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    interrupt::EXTI4.set_priority(SETPOINT_LINK);
    // SAFETY: the handler is below; nothing relies on this line being masked.
    unsafe { interrupt::EXTI4.enable() };
}

#[embassy_stm32::interrupt]
fn EXTI4() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    DESELECTED.signal(());
}
