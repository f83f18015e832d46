//! The configuration task on UART 1, and the watchdog it feeds.

use super::uart::{Receiver, Sender};
use super::{clock, fatal, watchdog};
use crate::board::ServoCell;
use crate::board::config_link::{Keeper, SharedDesk, Tick, serve};
use crate::clock::Clock;
use crate::desk::Restart;
use crate::flash::Nor;

/// Wakes the task each millisecond.
pub static TICK: Tick = Tick::new();

/// The board, as the configuration link sees it.
struct Board;

impl Clock for Board {
    fn now_us(&self) -> u64 {
        clock::now_us()
    }
}

impl Keeper for Board {
    fn config_task_lives(&self) {
        watchdog::config_task_lives();
    }
    fn restart(&self, restart: Restart) {
        carry_out(restart);
    }
}

/// The task.
#[embassy_executor::task]
pub async fn config_task(
    receiver: Receiver,
    sender: Sender,
    desk: &'static SharedDesk<Nor<'static>>,
    servo: &'static ServoCell,
) {
    serve(receiver, sender, &TICK, desk, servo, Board).await
}

/// Resets, now or through the watchdog.
pub fn carry_out(restart: Restart) {
    if restart.watchdog { watchdog::starve() } else { fatal::restart() }
}
