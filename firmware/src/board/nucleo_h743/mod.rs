//! The NUCLEO-H743ZI2 (ST UM2407): an STM32H743ZI at 480 MHz.
//!
//! | what | where | pins |
//! |---|---|---|
//! | setpoint link, UART, 3 Mbit/s | USART6, DMA | PG14 out (D1), PG9 in (D0) |
//! | setpoint link, SPI slave, mode 0 | SPI1, DMA | PA5 clock, PB5 in, PA6 out, PA4 select; PF14 (D4) high: an answer waits |
//! | which of the two | read once at the reset | PE13 (D3): open UART, to ground SPI |
//! | configuration link, 921,600 bit/s | USART3, the ST-LINK's serial port | PD8 out, PD9 in |
//! | drive enable | high: drives may be enabled | PE11 (D5), green lamp PB0 |
//! | fault | high | PE9 (D6), red lamp PB14 |
//! | somebody is here, who may provision keys | blue button, read once at the reset | PC13, high while it is held |
//! | log | defmt over RTT | debug probe |
//!
//! | who | runs | deadline | what a miss does |
//! |---|---|---|---|
//! | setpoint task | interrupt executor, priority 6 | `deadline_us` | the answer is withheld and counted |
//! | configuration task | interrupt executor, priority 10 | none | the client asks again |
//! | on-board correction | thread | none | |
//! | independent watchdog | fed by the setpoint task while the configuration task lives | 50 ms | reset, drives off by their pull-down |
//!
//! Both outputs float during a reset: they need pull-downs on the drive side. The caches: instructions on, data off, so
//! that DMA and processor see the same memory; stack and states lie in the DTCM, which needs no cache.

mod clocks;
mod fatal;
mod flash;
mod interrupts;
mod loader;
mod memory;
mod outputs;
mod random;
mod setpoint_spi;
mod setpoint_uart;
mod start;
mod tasks;
mod watchdog;

pub use flash::{BoardFlash, FlashError};
pub use loader::run as load;
pub use start::{NAME, run};
