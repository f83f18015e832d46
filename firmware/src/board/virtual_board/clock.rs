//! Time: microseconds since the reset from one timer of the CMSDK, a tick of a millisecond from the other.
//!
//! Timer 0 counts 25 MHz down from 100 s and raises an interrupt when it begins anew; timer 1 wakes both tasks each
//! millisecond, for time-outs and the watchdog. Once batches of the bench link run, their time records are the time.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use portable_atomic::AtomicU64;
use volatile_register::RW;

use super::line::Line;

/// Clock of the timers, Hz.
pub const HZ: u32 = 25_000_000;
const PER_US: u32 = HZ / 1_000_000;
/// Length of a round of timer 0, µs; 2.5 · 10⁹ counts.
const ROUND_US: u32 = 100_000_000;
const ROUND: u32 = ROUND_US * PER_US;
/// Ticks per second of timer 1.
const TICK_HZ: u32 = 1_000;

const ENABLE: u32 = 1;
const INTERRUPT: u32 = 1 << 3;

#[repr(C)]
struct Registers {
    control: RW<u32>,
    value: RW<u32>,
    reload: RW<u32>,
    interrupt: RW<u32>,
}

fn timer(number: usize) -> &'static Registers {
    // SAFETY: both timers lie there on this board, and volatile registers may be shared.
    unsafe { &*((0x4000_0000 + 0x1000 * number) as *const Registers) }
}

static ROUNDS: AtomicU32 = AtomicU32::new(0);
static BATCHES: AtomicBool = AtomicBool::new(false);
static BATCH_US: AtomicU64 = AtomicU64::new(0);

/// Starts both timers.
pub fn start() {
    for (number, reload, line) in [(0, ROUND - 1, Line::Timer0), (1, HZ / TICK_HZ - 1, Line::Timer1)] {
        let timer = timer(number);
        // SAFETY: plain configuration; the handlers of both lines exist in `interrupts`.
        unsafe {
            timer.reload.write(reload);
            timer.value.write(reload);
            timer.control.write(ENABLE | INTERRUPT);
            NVIC::unmask(line);
        }
    }
}

/// The interrupt of timer 0: a round is over.
pub fn on_round() {
    // SAFETY: clears the interrupt.
    unsafe { timer(0).interrupt.write(1) };
    ROUNDS.fetch_add(1, Ordering::Relaxed);
}

/// The interrupt of timer 1.
pub fn on_tick() {
    // SAFETY: clears the interrupt.
    unsafe { timer(1).interrupt.write(1) };
}

/// Microseconds of the part since the reset.
pub fn hardware_us() -> u64 {
    let timer = timer(0);
    loop {
        let before = ROUNDS.load(Ordering::Relaxed);
        let value = timer.value.read();
        let over = timer.interrupt.read() & 1 != 0;
        let again = timer.value.read();
        if before != ROUNDS.load(Ordering::Relaxed) || again > value {
            continue;
        }
        // A caller of higher priority may see a round that is over but not yet counted.
        let rounds = u64::from(before) + u64::from(over && value > ROUND / 2);
        return rounds * u64::from(ROUND_US) + u64::from((ROUND - 1 - value) / PER_US);
    }
}

/// Microseconds of the links since the reset.
pub fn now_us() -> u64 {
    if batches_have_it() { BATCH_US.load(Ordering::Relaxed) } else { hardware_us() }
}

/// The counter of the links is their time.
pub const COUNTER_HZ: u32 = 1_000_000;

/// Whether the time is that of batches. From the first one on it is, until the next reset: it begins at 0 and stands
/// still but for the time records, between batches as well, so that a run does not depend on the machine it runs on.
pub fn batches_have_it() -> bool {
    BATCHES.load(Ordering::Acquire)
}

/// A batch begins; gives the time it begins at.
pub fn begin_batch() -> u64 {
    BATCHES.store(true, Ordering::Release);
    BATCH_US.load(Ordering::Relaxed)
}

/// A batch ends, at this time.
pub fn end_batch(now_us: u64) {
    BATCH_US.store(now_us, Ordering::Relaxed);
}

/// Timer 1 as a free-running counter of 25 MHz, for measurements; not beside the tick.
pub struct Counter(());

impl Counter {
    /// Not running yet.
    pub const fn new() -> Self {
        Self(())
    }
    /// Starts it.
    pub fn start(&self) {
        // SAFETY: plain configuration, without an interrupt.
        unsafe {
            timer(1).reload.write(u32::MAX);
            timer(1).value.write(u32::MAX);
            timer(1).control.write(ENABLE);
        }
    }
    /// Counts since the start, wrapping.
    pub fn read(&self) -> u32 {
        u32::MAX - timer(1).value.read()
    }
}

impl Default for Counter {
    fn default() -> Self {
        Self::new()
    }
}
