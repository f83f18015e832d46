//! One servo for two: the setpoint task, and everybody below it.
//!
//! The setpoint task is the only one that touches the servo without switching interrupts off: everybody else runs below
//! it and switches them off meanwhile, so nobody can be in the middle of something when the setpoint task runs, and
//! nothing can interrupt the setpoint task that would touch the servo. It so never waits, and the reception interrupts go
//! on while it computes.
//!
//! Each side exists once, cannot be copied, and lends the servo to one closure at a time: safe code can hold it neither
//! twice nor over an `await`.

use core::ptr::NonNull;

use crate::servo::{Servo, ServoAccess};

/// The servo, for the setpoint task.
pub struct SetpointSide(NonNull<Servo<'static>>);

/// The servo, for what runs below the setpoint task.
pub struct ConfigSide(NonNull<Servo<'static>>);

// SAFETY: a servo may go to another thread, and access to it is exclusive by priority, as the module's text says.
unsafe impl Send for SetpointSide where Servo<'static>: Send {}
// SAFETY: as above.
unsafe impl Send for ConfigSide where Servo<'static>: Send {}

/// Both sides of a servo.
///
/// # Safety
/// The first side may only be used in the setpoint task, the second only in what that task can interrupt.
pub unsafe fn share(servo: &'static mut Servo<'static>) -> (SetpointSide, ConfigSide) {
    let servo = NonNull::from(servo);
    (SetpointSide(servo), ConfigSide(servo))
}

impl ServoAccess<'static> for SetpointSide {
    fn with<R>(&mut self, f: impl FnOnce(&mut Servo<'static>) -> R) -> R {
        // SAFETY: this is the setpoint task, by the contract of `share`; whoever uses the other side switches interrupts
        // off meanwhile, so none of it is under way.
        f(unsafe { self.0.as_mut() })
    }
}

impl ServoAccess<'static> for ConfigSide {
    fn with<R>(&mut self, f: impl FnOnce(&mut Servo<'static>) -> R) -> R {
        // SAFETY: interrupts are off, so the setpoint task does not run, and there is no other way to the servo.
        critical_section::with(|_| f(unsafe { self.0.as_mut() }))
    }
}
