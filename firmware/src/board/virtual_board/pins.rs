//! The pins follow the servo: drive enable while setpoints are forwarded, fault until the next arming.

use embedded_hal::digital::OutputPin;
use truepath_core::rewrite::Mode;

use super::gpio::Output;
use crate::servo::Servo;

/// Bit of the drive enable in port 0.
pub const DRIVE_ENABLE: u32 = 0;
/// Bit of the fault output in port 0.
pub const FAULT: u32 = 1;

/// Both pins, with what they show.
pub struct Pins {
    drive_enable: Output,
    fault: Output,
    shown: (bool, bool, Mode),
}

impl Pins {
    /// Both low.
    pub fn low() -> Self {
        let [drive_enable, fault] = [DRIVE_ENABLE, FAULT].map(Output::low);
        Self { drive_enable, fault, shown: (false, false, Mode::Off) }
    }

    /// Sets them as the servo says; a change is in the log.
    pub fn follow(&mut self, servo: &Servo<'_>) {
        let now = (servo.drive_enable(), servo.fault(), servo.mode());
        if now == self.shown {
            return;
        }
        let (enable, fault, mode) = now;
        let Ok(()) = self.drive_enable.set_state(enable.into());
        let Ok(()) = self.fault.set_state(fault.into());
        self.shown = now;
        defmt::info!(
            "mode {=u8}, reason {=u16}, drive enable {=bool}, fault {=bool}",
            mode as u8,
            servo.reason().code(),
            enable,
            fault
        );
    }
}
