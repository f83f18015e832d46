//! The setpoint task, the configuration task, and what runs while neither has anything to do.

use embassy_futures::select::{Either, select};
use embedded_io_async::{Read as _, Write as _};
use heapless::Vec;
use truepath_core::job::Workspace;
use truepath_core::link::MAX_ANSWER_BYTES;

use super::gpio::Output;
use super::shared_memory::SharedMemory;
use super::uart::{Receiver, Sender};
use super::{clock, fatal, memory, watchdog};
use crate::bench;
use crate::board::config_link::{BoardControl, Configuration, SharedConfiguration, Tick, compute, serve};
use crate::board::outputs::Outputs;
use crate::board::shared_servo::SetpointSide;
use crate::clock::Clock;
use crate::config_service::Restart;
use crate::flash::Nor;
use crate::servo::ServoAccess;

/// Wakes the setpoint task each millisecond.
pub static SETPOINT_TICK: Tick = Tick::new();
/// Wakes the configuration task each millisecond.
pub static CONFIG_TICK: Tick = Tick::new();

/// Bytes taken at once; the shortest packet has 35, so there are three frames in them at the most.
const CHUNK: usize = 96;
const ANSWERS: usize = 3 * (MAX_ANSWER_BYTES + 2);

/// The setpoint task: bytes in, answers out, time-outs by the tick.
#[embassy_executor::task]
pub async fn setpoint_task(
    mut receiver: Receiver,
    mut sender: Sender,
    mut side: SetpointSide,
    mut outputs: Outputs<Output, 1>,
) {
    let mut chunk = [0; CHUNK];
    loop {
        // The tick first: bytes that never end must not keep the task from reporting.
        match select(SETPOINT_TICK.wait(), receiver.read(&mut chunk)).await {
            Either::First(()) => {
                watchdog::setpoint_task_lives();
                // While batches have the clock they look at the silence themselves.
                if !clock::batches_have_it() {
                    side.with(|servo| servo.watch(clock::now_us()));
                }
            }
            Either::Second(Ok(taken)) => {
                let mut answers: Vec<u8, ANSWERS> = Vec::new();
                let bytes = chunk.get(..taken).unwrap_or(&[]);
                let arrived_us = receiver.arrived_us();
                side.with(|servo| {
                    servo.receive(bytes, arrived_us, &clock::now_us, &mut |answer: &[u8]| {
                        // It has room for as many answers as there are frames in a chunk.
                        let _ = answers.extend_from_slice(answer);
                    });
                });
                let Ok(()) = sender.write_all(&answers).await;
            }
        }
        side.with(|servo| outputs.follow(servo));
    }
}

/// The board, as the configuration link sees it.
struct Board;

impl Clock for Board {
    fn now_us(&self) -> u64 {
        clock::now_us()
    }
}

impl BoardControl for Board {
    fn config_task_lives(&self) {
        watchdog::config_task_lives();
    }
    fn restart(&self, restart: Restart) {
        if restart.watchdog { watchdog::starve() } else { fatal::restart() }
    }
}

/// The configuration task on UART 1; it feeds the watchdog.
#[embassy_executor::task]
pub async fn config_task(
    receiver: Receiver,
    sender: Sender,
    configuration: &'static SharedConfiguration<Nor<'static>>,
) {
    serve(receiver, sender, &CONFIG_TICK, configuration, Board).await
}

/// Batches of the bench link and the on-board correction. Never returns: when nothing is to be done the processor sleeps
/// until the next interrupt, the tick at the latest.
pub fn background(configuration: &'static SharedConfiguration<Nor<'static>>) -> ! {
    let mut shared = SharedMemory::ready();
    let mut workspace = memory::correction_buffers().workspace();
    loop {
        if !(batch(&mut shared, configuration, &mut workspace) || compute(configuration, &mut workspace)) {
            cortex_m::asm::wfi();
        }
    }
}

/// Runs a batch, if there is one.
fn batch(
    shared: &mut SharedMemory,
    configuration: &'static SharedConfiguration<Nor<'static>>,
    workspace: &mut Workspace<'_>,
) -> bool {
    let Some(request) = shared.request() else { return false };
    // The configuration task never sleeps while it has the configuration.
    let Ok(mut guard) = configuration.try_lock() else { return false };
    let Configuration { service, servo } = &mut *guard;
    let mut now_us = clock::begin_batch();
    let (input, output) = shared.records();
    let batch = bench::run(servo, service, input, output, &mut now_us, Some(workspace));
    clock::end_batch(now_us);
    if batch.overflow || batch.malformed {
        defmt::warn!("batch {=u32}: overflow {=bool}, malformed {=bool}", request, batch.overflow, batch.malformed);
    }
    shared.done(request, batch.written);
    if let Some(restart) = batch.restart {
        Board.restart(restart);
    }
    true
}
