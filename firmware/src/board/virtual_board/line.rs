//! The interrupt lines in use. Their handlers and priorities are in `interrupts`.

use cortex_m::interrupt::InterruptNumber;

/// Interrupt lines in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Line {
    /// UART 0, reception.
    SetpointReceived = 0,
    /// UART 0, transmission.
    SetpointTransmitted = 1,
    /// UART 1, reception.
    ConfigReceived = 2,
    /// UART 1, transmission.
    ConfigTransmitted = 3,
    /// Timer 0.
    Timer0 = 8,
    /// Timer 1.
    Timer1 = 9,
    /// Executor of the configuration task.
    ConfigExecutor = 30,
    /// Executor of the setpoint task.
    SetpointExecutor = 31,
}

// SAFETY: the numbers are those of the board's table.
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self as u16
    }
}
