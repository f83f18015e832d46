//! The virtual board: QEMU's `mps2-an500`, a Cortex-M7 with the peripherals of Arm's CMSDK (Arm AN500, DDI 0479).
//!
//! Setpoint link on UART 0, configuration link on UART 1, defmt log on UART 3, both links in bulk through the shared
//! memory at 0x6000_0000; flash is a model in RAM that outlives resets. Memory map: `memory.x` in the root.
//!
//! The program starts by itself, where the emulator loads it anew at each reset; or it is started by the loader, and can be
//! replaced over the link.
//!
//! | who | runs | deadline | what a miss does |
//! |---|---|---|---|
//! | setpoint task | executor of priority 1, by bytes and by the tick of 1 ms | `deadline_us` | the answer is withheld and counted |
//! | configuration task | executor of priority 3, by bytes and by the tick | none | the client asks again |
//! | background | thread | none | |
//! | watchdog | fed by the configuration task when the setpoint task lives | 1 s, 2 s | drives off, reset |

pub mod clock;
pub mod fatal;
mod gpio;
mod interrupts;
mod line;
mod loader;
mod log;
mod memory;
mod retained;
mod shared_memory;
mod start;
mod tasks;
pub mod uart;
mod watchdog;

pub use loader::run as load;
pub use start::{NAME, run};
