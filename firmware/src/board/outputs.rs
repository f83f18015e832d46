//! Drive enable and fault follow the servo.

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use truepath_core::rewrite::Mode;

use crate::servo::Servo;

/// Both outputs, each of `N` pins (a lamp beside the output), with what they show.
pub struct Outputs<P, const N: usize> {
    drive_enable: [P; N],
    fault: [P; N],
    shown: (bool, bool, Mode),
}

impl<P: OutputPin<Error = Infallible>, const N: usize> Outputs<P, N> {
    /// From pins that are low.
    pub fn new(drive_enable: [P; N], fault: [P; N]) -> Self {
        Self { drive_enable, fault, shown: (false, false, Mode::Off) }
    }

    /// Sets them as the servo says; a change is in the log.
    pub fn follow(&mut self, servo: &Servo<'_>) {
        let now = (servo.drive_enable(), servo.fault(), servo.mode());
        if now == self.shown {
            return;
        }
        let (enable, fault, mode) = now;
        for pin in &mut self.drive_enable {
            let Ok(()) = pin.set_state(enable.into());
        }
        for pin in &mut self.fault {
            let Ok(()) = pin.set_state(fault.into());
        }
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
