//! The configuration link of a board: requests in, responses out, and what runs below it.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::{Mutex, MutexGuard};
use embassy_sync::signal::Signal;
use embedded_io_async::{Read, Write};
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use truepath_core::job::Workspace;
use truepath_core::link::PACKET_BYTES;

use super::ServoCell;
use crate::clock::Clock;
use crate::desk::{Desk, Restart};

/// Wakes a task each millisecond.
pub type Tick = Signal<CriticalSectionRawMutex, ()>;
/// The desk, for the configuration task and the background.
pub type SharedDesk<F> = Mutex<CriticalSectionRawMutex, Desk<'static, F>>;

/// What the configuration link asks of a board.
pub trait Keeper: Clock {
    /// The configuration task lives: for the watchdog.
    fn config_task_lives(&self);
    /// Resets, now or by letting the watchdog run out.
    fn restart(&self, restart: Restart);
}

const CHUNK: usize = 64;

/// Serves the link. It never waits for anything while it has the desk.
pub async fn serve<F: NorFlash>(
    mut receiver: impl Read,
    mut sender: impl Write,
    tick: &'static Tick,
    desk: &'static SharedDesk<F>,
    servo: &'static ServoCell,
    keeper: impl Keeper,
) -> ! {
    let mut chunk = [0; CHUNK];
    let mut answer: Vec<u8, PACKET_BYTES> = Vec::new();
    loop {
        // The tick first: bytes that never end must not keep the task from reporting.
        let taken = match select(tick.wait(), receiver.read(&mut chunk)).await {
            Either::First(()) => {
                keeper.config_task_lives();
                continue;
            }
            Either::Second(Ok(taken)) => taken,
            // Noise on the line: the packet it fell into is damaged, the next one is not.
            Either::Second(Err(_)) => continue,
        };
        // One packet at a time, so that there is one answer at a time.
        for piece in chunk.get(..taken).unwrap_or(&[]).split_inclusive(|&byte| byte == 0) {
            answer.clear();
            let restart =
                lock(desk, tick, &keeper).await.receive(piece, keeper.now_us(), &servo, &mut |bytes: &[u8]| {
                    // It has room for the longest packet.
                    let _ = answer.extend_from_slice(bytes);
                });
            // An answer that cannot be sent is asked for again.
            let _ = sender.write_all(&answer).await;
            if let Some(restart) = restart {
                let _ = sender.flush().await;
                keeper.restart(restart);
            }
        }
    }
}

/// The desk, which the background may have for long: the task goes on reporting meanwhile.
async fn lock<F: NorFlash>(
    desk: &'static SharedDesk<F>,
    tick: &'static Tick,
    keeper: &impl Keeper,
) -> MutexGuard<'static, CriticalSectionRawMutex, Desk<'static, F>> {
    loop {
        match select(tick.wait(), desk.lock()).await {
            Either::First(()) => keeper.config_task_lives(),
            Either::Second(guard) => return guard,
        }
    }
}

/// Runs the on-board correction that the link asked for, if there is one; in the thread, below everything else.
pub fn work<F: NorFlash>(
    desk: &'static SharedDesk<F>,
    servo: &'static ServoCell,
    workspace: &mut Workspace<'_>,
) -> bool {
    let Ok(work) = desk.try_lock().map(|mut desk| desk.take_work()) else { return false };
    let Some(mut work) = work else { return false };
    work.run(workspace);
    loop {
        if let Ok(mut desk) = desk.try_lock() {
            desk.finish(work, &servo);
            return true;
        }
        cortex_m::asm::wfi();
    }
}
