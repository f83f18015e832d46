//! The configuration task: requests in, responses out, and the watchdog.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::{Mutex, MutexGuard};
use embassy_sync::signal::Signal;
use embedded_io_async::{Read as _, Write as _};
use heapless::Vec;
use truepath_core::link::PACKET_BYTES;

use super::uart::Uart;
use super::{clock, fatal, watchdog};
use crate::board::ServoCell;
use crate::desk::{Desk, Restart};
use crate::flash::Nor;

/// Wakes the task each millisecond.
pub static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// The desk, for this task and the background.
pub type SharedDesk = Mutex<CriticalSectionRawMutex, Desk<'static, Nor<'static>>>;

const CHUNK: usize = 64;

/// The task. It never waits for anything while it has the desk.
#[embassy_executor::task]
pub async fn config_task(mut uart: Uart, desk: &'static SharedDesk, servo: &'static ServoCell) {
    let mut chunk = [0; CHUNK];
    let mut answer: Vec<u8, PACKET_BYTES> = Vec::new();
    loop {
        let taken = match select(uart.read(&mut chunk), TICK.wait()).await {
            Either::First(Ok(taken)) => taken,
            Either::Second(()) => {
                watchdog::config_task_lives();
                continue;
            }
        };
        // One packet at a time, so that there is one answer at a time.
        for piece in chunk.get(..taken).unwrap_or(&[]).split_inclusive(|&byte| byte == 0) {
            answer.clear();
            let restart = lock(desk).await.receive(piece, clock::now_us(), &servo, &mut |bytes: &[u8]| {
                // It has room for the longest packet.
                let _ = answer.extend_from_slice(bytes);
            });
            let Ok(()) = uart.write_all(&answer).await;
            if let Some(restart) = restart {
                carry_out(restart);
            }
        }
    }
}

/// The desk, which the background may have for long: this task goes on reporting meanwhile.
async fn lock(desk: &'static SharedDesk) -> MutexGuard<'static, CriticalSectionRawMutex, Desk<'static, Nor<'static>>> {
    loop {
        match select(desk.lock(), TICK.wait()).await {
            Either::First(guard) => return guard,
            Either::Second(()) => watchdog::config_task_lives(),
        }
    }
}

/// Resets, now or through the watchdog.
pub fn carry_out(restart: Restart) {
    if restart.watchdog { watchdog::starve() } else { fatal::restart() }
}
