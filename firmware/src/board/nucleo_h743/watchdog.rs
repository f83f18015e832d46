//! The independent watchdog (RM0433, 44): runs from its own oscillator and cannot be stopped.
//!
//! The setpoint task feeds it each millisecond, as long as the configuration task has reported within
//! [`CONFIG_TICKS`]: an erase of a sector keeps that task for up to 4 s.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::IWDG1;
use embassy_stm32::pac::iwdg::vals::Key;
use embassy_stm32::peripherals;
use embassy_stm32::wdg::IndependentWatchdog;

/// Time without a feed to the reset, µs.
const TIMEOUT_US: u32 = 50_000;
/// Ticks of a millisecond that the configuration task may be silent: three sectors of a slot are erased in one go.
const CONFIG_TICKS: u32 = 15_000;

static LEFT: AtomicU32 = AtomicU32::new(CONFIG_TICKS);
static STARVED: AtomicBool = AtomicBool::new(false);

/// Starts it.
pub fn start(peripheral: embassy_stm32::Peri<'static, peripherals::IWDG1>) {
    IndependentWatchdog::new(peripheral, TIMEOUT_US).unleash();
}

/// The configuration task reports.
pub fn config_task_lives() {
    LEFT.store(CONFIG_TICKS, Ordering::Relaxed);
}

/// The setpoint task reports, once a millisecond, and feeds the watchdog.
pub fn setpoint_task_lives() {
    let left = LEFT.load(Ordering::Relaxed).saturating_sub(1);
    // A report of the other task in between is lost, at worst once: it comes again within a millisecond.
    LEFT.store(left, Ordering::Relaxed);
    if left > 0 && !STARVED.load(Ordering::Relaxed) {
        IWDG1.kr().write(|w| w.set_key(Key::RESET));
    }
}

/// Feeds it no more, so that it runs out: what `Restart { watchdog: true }` asks for.
pub fn starve() {
    STARVED.store(true, Ordering::Relaxed);
}
