//! The watchdog of the CMSDK (Arm DDI 0479, "APB watchdog"): first expiry a non-maskable interrupt, second a reset.
//!
//! It is fed only while both tasks report: the configuration task feeds it, and only when the setpoint task has
//! reported since. At the first expiry the drive enable is dropped and the cause kept, then the second resets.

use core::sync::atomic::{AtomicBool, Ordering};

use volatile_register::RW;

use super::clock::HZ;

/// Time from the last feed to the dropped enable, and as much again to the reset, ms. Longer than on a real board: the
/// emulator may stand still while the host does something else.
const HALF_MS: u32 = 1_000;
const UNLOCK: u32 = 0x1ACC_E551;
const INTERRUPT: u32 = 1;
const RESET: u32 = 1 << 1;

#[repr(C)]
struct Registers {
    load: RW<u32>,
    value: RW<u32>,
    control: RW<u32>,
    clear: RW<u32>,
    raw_status: RW<u32>,
    status: RW<u32>,
    gap: [u32; 762],
    lock: RW<u32>,
}

const _: () = assert!(core::mem::offset_of!(Registers, lock) == 0xC00);

static SETPOINT_TASK_LIVES: AtomicBool = AtomicBool::new(false);
static STARVED: AtomicBool = AtomicBool::new(false);

fn registers() -> &'static Registers {
    // SAFETY: the block lies there on this board, and volatile registers may be shared.
    unsafe { &*(0x4000_8000 as *const Registers) }
}

/// The same for a program on trial, which may not get as far as to start it itself, ms.
const HALF_TRIAL_MS: u32 = 3_000;

/// Starts it.
pub fn start() {
    start_with(HALF_MS);
}
/// Starts it for a program on trial.
pub fn start_trial() {
    start_with(HALF_TRIAL_MS);
}

fn start_with(half_ms: u32) {
    // SAFETY: plain configuration.
    unsafe {
        registers().lock.write(UNLOCK);
        registers().load.write(HZ / 1_000 * half_ms);
        registers().control.write(INTERRUPT | RESET);
    }
}

/// The setpoint task reports.
pub fn setpoint_task_lives() {
    SETPOINT_TASK_LIVES.store(true, Ordering::Relaxed);
}

/// The configuration task reports: feeds the watchdog when the setpoint task has, too.
pub fn config_task_lives() {
    if SETPOINT_TASK_LIVES.swap(false, Ordering::Relaxed) && !STARVED.load(Ordering::Relaxed) {
        // SAFETY: any write loads the counter anew.
        unsafe { registers().clear.write(1) };
    }
}

/// Feeds it no more, so that it runs out: what `Restart { watchdog: true }` asks for.
pub fn starve() {
    STARVED.store(true, Ordering::Relaxed);
}
