//! One servo for a task of high priority and everybody below it.
//!
//! The setpoint task is the only one that touches the servo without switching interrupts off: everybody else runs below
//! it and switches them off meanwhile ([`ServoCell`] as [`ServoAccess`]), so nobody can be in the middle of something
//! when the setpoint task runs, and nothing can interrupt the setpoint task that would touch the servo. It so never
//! waits, and the reception interrupts go on while it computes.

use core::cell::UnsafeCell;

use crate::servo::{Servo, ServoAccess};

/// The servo.
pub struct ServoCell(UnsafeCell<Option<Servo<'static>>>);

// SAFETY: access is exclusive by priority, as the module's text says.
unsafe impl Sync for ServoCell {}

/// The setpoint task's way to the servo. There is one.
pub struct SetpointSide(&'static ServoCell);

impl ServoCell {
    /// Without a servo.
    pub const fn new() -> Self {
        Self(UnsafeCell::new(None))
    }

    /// Puts the servo in and gives the side of the setpoint task.
    ///
    /// # Safety
    /// Called once, before the setpoint task runs. The side must only be used from the setpoint task, and nothing of
    /// higher priority may use the cell.
    pub unsafe fn fill(&'static self, servo: Servo<'static>) -> SetpointSide {
        // SAFETY: nobody else has access yet, by the contract above.
        unsafe { *self.0.get() = Some(servo) };
        SetpointSide(self)
    }
}

impl Default for ServoCell {
    fn default() -> Self {
        Self::new()
    }
}

impl ServoAccess<'static> for &'static ServoCell {
    fn with<R>(&self, f: impl FnOnce(&mut Servo<'static>) -> R) -> R {
        critical_section::with(|_| {
            // SAFETY: interrupts are off, so the setpoint task does not run, and everybody else comes through here.
            let Some(servo) = (unsafe { &mut *self.0.get() }) else {
                unreachable!("the servo is there before the tasks")
            };
            f(servo)
        })
    }
}

impl SetpointSide {
    /// The servo.
    pub fn servo(&mut self) -> &mut Servo<'static> {
        // SAFETY: this is the setpoint task; whoever else has access switches interrupts off meanwhile.
        let Some(servo) = (unsafe { &mut *self.0.0.get() }) else {
            unreachable!("the servo is there before the tasks")
        };
        servo
    }
}
