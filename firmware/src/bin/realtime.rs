//! The setpoint path alone, for proofs by linking and for a look at what is in it; it is never run.
//!
//! The panic handler calls a function that does not exist. If a panic can be reached from anything below, the image
//! does not link. `cargo xtask elf` builds it and looks for soft float, division calls and formatting as well. What is
//! not called here is not proved: whatever the servo gains for the setpoint path has to be added.
#![no_std]
#![no_main]

use truepath_fw::servo::Servo;

unsafe extern "C" {
    /// Does not exist.
    fn truepath_panic_is_reachable() -> !;
    /// The board's clock, µs; the linker script gives it some address.
    fn board_now_us() -> u64;
    /// The board's link, likewise.
    fn board_send(bytes: *const u8, length: usize);
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    // SAFETY: never linked.
    unsafe { truepath_panic_is_reachable() }
}

fn now_us() -> u64 {
    // SAFETY: stands for the board's clock; this image is not run.
    unsafe { board_now_us() }
}

/// Bytes of a stream: deframer, endpoint, tick, answer, recorder, trace.
#[unsafe(no_mangle)]
pub fn realtime_receive(servo: &mut Servo<'static>, bytes: &[u8], arrived_us: u64) {
    servo.receive(bytes, arrived_us, &now_us, &mut |answer: &[u8]| {
        // SAFETY: stands for the board's link; this image is not run.
        unsafe { board_send(answer.as_ptr(), answer.len()) }
    });
}

/// A frame of SPI: the same without COBS.
#[unsafe(no_mangle)]
pub fn realtime_frame(servo: &mut Servo<'static>, raw: &[u8], arrived_us: u64, answer: &mut [u8]) -> usize {
    servo.frame(raw, arrived_us, &now_us, answer).unwrap_or(0)
}

/// The tick of a millisecond: silence, and what the pins show.
#[unsafe(no_mangle)]
pub fn realtime_watch(servo: &mut Servo<'static>) -> u32 {
    servo.watch(now_us());
    u32::from(servo.drive_enable())
        | u32::from(servo.fault()) << 1
        | (servo.mode() as u32) << 2
        | u32::from(servo.reason().code()) << 8
}
