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

use super::shared_servo::ConfigSide;
use crate::clock::Clock;
use crate::config_service::{ConfigService, Restart};

/// Wakes a task each millisecond.
pub type Tick = Signal<CriticalSectionRawMutex, ()>;

/// The configuration service with its way to the servo.
pub struct Configuration<F: NorFlash> {
    /// The service.
    pub service: ConfigService<'static, F>,
    /// The servo.
    pub servo: ConfigSide,
}
/// Both, for the configuration task and the background.
pub type SharedConfiguration<F> = Mutex<CriticalSectionRawMutex, Configuration<F>>;

/// What the configuration link asks of a board.
pub trait BoardControl: Clock {
    /// The configuration task lives: for the watchdog.
    fn config_task_lives(&self);
    /// Resets, now or by letting the watchdog run out.
    fn restart(&self, restart: Restart);
}

const CHUNK: usize = 64;

/// Serves the link. It never waits for anything while it has the configuration.
pub async fn serve<F: NorFlash>(
    mut receiver: impl Read,
    mut sender: impl Write,
    tick: &'static Tick,
    configuration: &'static SharedConfiguration<F>,
    board: impl BoardControl,
) -> ! {
    let mut chunk = [0; CHUNK];
    let mut answer: Vec<u8, PACKET_BYTES> = Vec::new();
    loop {
        // The tick first: bytes that never end must not keep the task from reporting.
        let taken = match select(tick.wait(), receiver.read(&mut chunk)).await {
            Either::First(()) => {
                board.config_task_lives();
                if let Ok(mut guard) = configuration.try_lock() {
                    let Configuration { service, servo } = &mut *guard;
                    service.rest(servo);
                    if let Some(restart) = service.trial_is_over(board.now_us(), servo) {
                        board.restart(restart);
                    }
                }
                continue;
            }
            Either::Second(Ok(taken)) => taken,
            // Noise on the line: the packet it fell into is damaged, the next one is not.
            Either::Second(Err(_)) => continue,
        };
        // One packet at a time, so that there is one answer at a time.
        for piece in chunk.get(..taken).unwrap_or(&[]).split_inclusive(|&byte| byte == 0) {
            answer.clear();
            let restart = {
                let Configuration { service, servo } = &mut *lock(configuration, tick, &board).await;
                service.receive(piece, board.now_us(), servo, &mut |bytes: &[u8]| {
                    // It has room for the longest packet.
                    let _ = answer.extend_from_slice(bytes);
                })
            };
            // An answer that cannot be sent is asked for again.
            let _ = sender.write_all(&answer).await;
            if let Some(restart) = restart {
                let _ = sender.flush().await;
                board.restart(restart);
            }
        }
    }
}

/// The configuration, which the background may have for long: the task goes on reporting meanwhile.
async fn lock<F: NorFlash>(
    configuration: &'static SharedConfiguration<F>,
    tick: &'static Tick,
    board: &impl BoardControl,
) -> MutexGuard<'static, CriticalSectionRawMutex, Configuration<F>> {
    loop {
        match select(tick.wait(), configuration.lock()).await {
            Either::First(()) => board.config_task_lives(),
            Either::Second(guard) => return guard,
        }
    }
}

/// Runs the on-board correction that the link asked for, if there is one; in the thread, below everything else.
pub fn compute<F: NorFlash>(configuration: &'static SharedConfiguration<F>, workspace: &mut Workspace<'_>) -> bool {
    let Ok(asked) = configuration.try_lock().map(|mut guard| guard.service.take_computation()) else { return false };
    let Some(mut computation) = asked else { return false };
    computation.run(workspace);
    loop {
        if let Ok(mut guard) = configuration.try_lock() {
            let Configuration { service, servo } = &mut *guard;
            service.finish(computation, servo);
            return true;
        }
        cortex_m::asm::wfi();
    }
}
