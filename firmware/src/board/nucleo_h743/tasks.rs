//! The configuration task, what runs while nothing else does, and what wakes the tasks each millisecond.

use embassy_stm32::usart::{BufferedUartRx, BufferedUartTx};
use embassy_time::{Duration, Ticker};

use super::clocks::BoardClock;
use super::flash::BoardFlash;
use super::{fatal, memory, watchdog};
use crate::board::config_link::{BoardControl, SharedConfiguration, Tick, compute, serve};
use crate::config_service::Restart;

/// Wakes the setpoint task each millisecond.
pub static SETPOINT_TICK: Tick = Tick::new();
static CONFIG_TICK: Tick = Tick::new();

impl BoardControl for BoardClock {
    fn config_task_lives(&self) {
        watchdog::config_task_lives();
    }
    fn restart(&self, restart: Restart) {
        if restart.watchdog { watchdog::starve() } else { fatal::restart() }
    }
}

/// The configuration task on the serial port of the ST-LINK.
#[embassy_executor::task]
pub async fn config_task(
    receiver: BufferedUartRx<'static>,
    sender: BufferedUartTx<'static>,
    configuration: &'static SharedConfiguration<BoardFlash>,
) {
    serve(receiver, sender, &CONFIG_TICK, configuration, BoardClock).await
}

/// Wakes both tasks each millisecond.
#[embassy_executor::task]
pub async fn tick() {
    let mut ticker = Ticker::every(Duration::from_millis(1));
    loop {
        ticker.next().await;
        SETPOINT_TICK.signal(());
        CONFIG_TICK.signal(());
    }
}

/// The on-board correction. Never returns: the processor sleeps until the next interrupt when nothing is to be done.
pub fn background(configuration: &'static SharedConfiguration<BoardFlash>) -> ! {
    let mut workspace = memory::correction_buffers().workspace();
    loop {
        if !compute(configuration, &mut workspace) {
            cortex_m::asm::wfi();
        }
    }
}
