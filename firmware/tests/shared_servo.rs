//! The servo of a board, shared by two sides: the board's own file, with the critical section of the host.

mod servo {
    pub use truepath_fw::servo::*;
}
#[path = "../src/board/shared_servo.rs"]
mod shared_servo;

use servo::{Servo, ServoAccess};
use shared_servo::{ConfigSide, SetpointSide, share};
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{Rewriter, SpentList};

/// Compiles only for types that are neither `Clone` nor `Copy`: for others it does not know which function is meant.
macro_rules! assert_not_clone {
    ($($type:ty),*) => {$({
        trait Ambiguous<A> {
            fn asked() {}
        }
        impl<T> Ambiguous<()> for T {}
        impl<T: Clone> Ambiguous<u8> for T {}
        <$type as Ambiguous<_>>::asked();
    })*};
}

#[test]
fn nobody_can_copy_a_side_and_so_hold_the_servo_twice() {
    assert_not_clone!(SetpointSide, ConfigSide);
}

#[test]
fn both_sides_have_the_same_servo_one_after_the_other() {
    let settings = DeviceSettings::at_1_khz();
    let bare = Rewriter::new(settings.rewriter, None).unwrap();
    let servo = Servo::new(settings, bare, SpentList::default(), vec![0; 4_800].leak());
    // SAFETY: one thread, and neither closure below reaches the other side.
    let (mut setpoint, mut config) = unsafe { share(Box::leak(Box::new(servo))) };
    setpoint.with(|servo| servo.count_message(false));
    config.with(|servo| servo.count_message(false));
    assert_eq!(setpoint.with(|servo| servo.counters().messages), 2);
    assert_eq!(config.with(|servo| servo.counters().messages), 2);
}
