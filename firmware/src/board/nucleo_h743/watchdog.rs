//! The independent watchdog (RM0433, 44): runs from its own oscillator and cannot be stopped.
//!
//! The setpoint task feeds it each millisecond, as long as the configuration task has reported within
//! [`CONFIG_TICKS`]: an erase of a sector keeps that task for up to 4 s.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::IWDG1;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::peripherals;
use embassy_stm32::wdg::IndependentWatchdog;

use crate::stm32h743::{CONFIG_TICKS, WATCHDOG_US, watchdog_registers};

static LEFT: AtomicU32 = AtomicU32::new(CONFIG_TICKS);
static STARVED: AtomicBool = AtomicBool::new(false);

/// Starts it.
pub fn start(peripheral: embassy_stm32::Peri<'static, peripherals::IWDG1>) {
    IndependentWatchdog::new(peripheral, WATCHDOG_US).unleash();
}

/// Reload value of the longest time at the largest divider: 32 s.
const LONGEST: u16 = 0xFFF;
/// The reload value of [`WATCHDOG_US`] at the least divider, which holds it (asserted beside it).
const SHORT: u16 = watchdog_registers(WATCHDOG_US).1 as u16;
/// Looks at the flag that says that a value was taken over, which takes some clocks of 32 kHz; a watchdog that does not run
/// never takes one over.
const PATIENCE: u32 = 1_000_000;

/// Has it wait for its longest time, as long as a sector is erased of the bank that the program runs from: nothing runs then.
pub fn hold() {
    set(Pr::DIVIDE_BY256, LONGEST);
}
/// Back to [`WATCHDOG_US`].
pub fn release() {
    set(Pr::DIVIDE_BY4, SHORT);
}

fn set(divider: Pr, reload: u16) {
    IWDG1.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG1.pr().write(|w| w.set_pr(divider));
    IWDG1.rlr().write(|w| w.set_rl(reload));
    let under_way = || {
        let status = IWDG1.sr().read();
        status.pvu() || status.rvu()
    };
    for _ in 0..PATIENCE {
        if !under_way() {
            break;
        }
    }
    IWDG1.kr().write(|w| w.set_key(Key::RESET));
}

/// Starts it for a program on trial, which may not get as far as to start it itself.
pub fn start_trial() {
    IWDG1.kr().write(|w| w.set_key(Key::START));
    hold();
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
