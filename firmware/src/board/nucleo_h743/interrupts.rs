//! Interrupts and their priorities; 0 is the most urgent.
//!
//! | priority | who |
//! |---:|---|
//! | 0 | time driver (timer 5) |
//! | 5 | setpoint link: UART, SPI, DMA |
//! | 6 | executor of the setpoint task |
//! | 9 | UART of the configuration link |
//! | 10 | executor of the configuration task |
//! | thread | on-board correction |
//!
//! The executors use the lines of UART4 and UART5, which the board does not use.

use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::{bind_interrupts, dma, peripherals, usart};

use crate::stm32h743::priority;

bind_interrupts!(pub struct Lines {
    USART6 => usart::InterruptHandler<peripherals::USART6>;
    USART3 => usart::BufferedInterruptHandler<peripherals::USART3>;
    DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
    DMA1_STREAM1 => dma::InterruptHandler<peripherals::DMA1_CH1>;
    DMA1_STREAM2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
    DMA1_STREAM3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
});

static SETPOINT_EXECUTOR: InterruptExecutor = InterruptExecutor::new();
static CONFIG_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// Priority of everything that moves bytes of the setpoint link.
pub const SETPOINT_LINK: Priority = level(priority::SETPOINT_LINK);

/// The four bits that count lie at the top.
const fn level(number: u8) -> Priority {
    match number {
        5 => Priority::P5,
        6 => Priority::P6,
        9 => Priority::P9,
        10 => Priority::P10,
        _ => panic!("no such level here"),
    }
}

#[embassy_stm32::interrupt]
unsafe fn UART4() {
    // SAFETY: the line is unmasked by `start` of this executor.
    unsafe { SETPOINT_EXECUTOR.on_interrupt() };
}

#[embassy_stm32::interrupt]
unsafe fn UART5() {
    // SAFETY: the line is unmasked by `start` of this executor.
    unsafe { CONFIG_EXECUTOR.on_interrupt() };
}

/// Sets the priorities and starts both executors: of the setpoint task, of the configuration task.
pub fn start() -> [SendSpawner; 2] {
    interrupt::USART6.set_priority(SETPOINT_LINK);
    interrupt::SPI1.set_priority(SETPOINT_LINK);
    interrupt::USART3.set_priority(const { level(priority::CONFIG_LINK) });
    interrupt::UART4.set_priority(const { level(priority::SETPOINT_TASK) });
    interrupt::UART5.set_priority(const { level(priority::CONFIG_TASK) });
    [SETPOINT_EXECUTOR.start(interrupt::UART4), CONFIG_EXECUTOR.start(interrupt::UART5)]
}
