//! The configuration task on the serial port of the ST-LINK.

use embassy_stm32::usart::{BufferedUartRx, BufferedUartTx};
use embassy_time::Instant;

use super::flash::Bank2;
use super::start::Clockwork;
use super::{fatal, watchdog};
use crate::board::ServoCell;
use crate::board::config_link::{Keeper, SharedDesk, Tick, serve};
use crate::clock::Clock;
use crate::desk::Restart;

/// Bits per second of the link.
pub const BAUD: u32 = 921_600;

impl Clock for Clockwork {
    fn now_us(&self) -> u64 {
        Instant::now().as_micros()
    }
}

impl Keeper for Clockwork {
    fn config_task_lives(&self) {
        watchdog::config_task_lives();
    }
    fn restart(&self, restart: Restart) {
        if restart.watchdog { watchdog::starve() } else { fatal::restart() }
    }
}

/// The task.
#[embassy_executor::task]
pub async fn config_task(
    receiver: BufferedUartRx<'static>,
    sender: BufferedUartTx<'static>,
    tick: &'static Tick,
    desk: &'static SharedDesk<Bank2>,
    servo: &'static ServoCell,
) {
    serve(receiver, sender, tick, desk, servo, Clockwork).await
}
