//! The board's interrupt table, its handlers, and their priorities.
//!
//! | priority | who |
//! |---:|---|
//! | 0 | reception on the setpoint link, its transmission, the round of the clock |
//! | 1 | executor of the setpoint task |
//! | 2 | the tick, both interrupts of the configuration link |
//! | 3 | executor of the configuration task |
//! | thread | on-board correction, batches of the bench link |
//!
//! The executors use lines 31 and 30, which nothing on the board drives.

use core::cell::RefCell;

use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use critical_section::Mutex;
use embassy_executor::InterruptExecutor;

use super::line::Line;
use super::tasks::{CONFIG_TICK, SETPOINT_TICK};
use super::uart::{Port, Receiving, Shared};
use super::{clock, fatal};

/// Priorities by line; the upper three bits count.
const PRIORITIES: [(Line, u8); 8] = [
    (Line::SetpointReceived, 0),
    (Line::SetpointTransmitted, 0),
    (Line::Timer0, 0),
    (Line::SetpointExecutor, 1),
    (Line::Timer1, 2),
    (Line::ConfigReceived, 2),
    (Line::ConfigTransmitted, 2),
    (Line::ConfigExecutor, 3),
];

/// UART 0.
pub static SETPOINT_UART: Shared = Shared::new(Port::Setpoint);
/// UART 1.
pub static CONFIG_UART: Shared = Shared::new(Port::Config);
/// Executor of the setpoint task.
pub static SETPOINT_EXECUTOR: InterruptExecutor = InterruptExecutor::new();
/// Executor of the configuration task.
pub static CONFIG_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

type Reception = Mutex<RefCell<Option<Receiving>>>;
static SETPOINT_RECEPTION: Reception = Mutex::new(RefCell::new(None));
static CONFIG_RECEPTION: Reception = Mutex::new(RefCell::new(None));

/// Hands the reception sides over and sets the priorities; before any line is unmasked.
pub fn set_up(nvic: &mut NVIC) {
    for (line, priority) in PRIORITIES {
        // SAFETY: nothing relies on priorities for mutual exclusion.
        unsafe { nvic.set_priority(line, priority << 5) };
    }
}

/// Hands the reception side of a port to its interrupt.
pub fn receive(port: Port, receiving: Receiving) {
    let reception = if port == Port::Setpoint { &SETPOINT_RECEPTION } else { &CONFIG_RECEPTION };
    critical_section::with(|cs| reception.borrow(cs).replace(Some(receiving)));
}

fn on_received(reception: &'static Reception) {
    critical_section::with(|cs| {
        if let Some(receiving) = reception.borrow(cs).borrow_mut().as_mut() {
            receiving.on_received();
        }
    });
}

extern "C" fn setpoint_received() {
    on_received(&SETPOINT_RECEPTION);
}
extern "C" fn setpoint_transmitted() {
    SETPOINT_UART.on_transmitted();
}
extern "C" fn config_received() {
    on_received(&CONFIG_RECEPTION);
}
extern "C" fn config_transmitted() {
    CONFIG_UART.on_transmitted();
}
extern "C" fn timer0() {
    clock::on_round();
}
extern "C" fn timer1() {
    clock::on_tick();
    SETPOINT_TICK.signal(());
    CONFIG_TICK.signal(());
}
extern "C" fn config_executor() {
    // SAFETY: the line is unmasked by `start` of this executor.
    unsafe { CONFIG_EXECUTOR.on_interrupt() };
}
extern "C" fn setpoint_executor() {
    // SAFETY: the line is unmasked by `start` of this executor.
    unsafe { SETPOINT_EXECUTOR.on_interrupt() };
}
extern "C" fn unexpected() {
    fatal::stop(fatal::Cause::UnexpectedInterrupt);
}

/// The first expiry of the watchdog.
#[exception]
unsafe fn NonMaskableInt() {
    fatal::watchdog_ran_out();
}

#[exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    fatal::stop(fatal::Cause::HardFault { pc: frame.pc() })
}

const LINES: usize = 32;

const fn table() -> [unsafe extern "C" fn(); LINES] {
    let mut table: [unsafe extern "C" fn(); LINES] = [unexpected; LINES];
    table[Line::SetpointReceived as usize] = setpoint_received;
    table[Line::SetpointTransmitted as usize] = setpoint_transmitted;
    table[Line::ConfigReceived as usize] = config_received;
    table[Line::ConfigTransmitted as usize] = config_transmitted;
    table[Line::Timer0 as usize] = timer0;
    table[Line::Timer1 as usize] = timer1;
    table[Line::ConfigExecutor as usize] = config_executor;
    table[Line::SetpointExecutor as usize] = setpoint_executor;
    table
}

/// Where cortex-m-rt looks for it.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); LINES] = table();
