//! The setpoint task: bytes in, answers out, time-outs by the tick.

use embassy_futures::select::{Either, select};
use embedded_io_async::{Read as _, Write as _};
use heapless::Vec;
use truepath_core::link::MAX_ANSWER_BYTES;

use super::gpio::Output;
use super::uart::{Receiver, Sender};
use super::{clock, watchdog};
use crate::board::config_link::Tick;
use crate::board::{Outputs, SetpointSide};

/// Wakes the task each millisecond.
pub static TICK: Tick = Tick::new();

/// Bytes taken at once; the shortest packet has 35, so there are three frames in them at the most.
const CHUNK: usize = 96;
const ANSWERS: usize = 3 * (MAX_ANSWER_BYTES + 2);

/// The task.
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
        match select(TICK.wait(), receiver.read(&mut chunk)).await {
            Either::First(()) => {
                watchdog::setpoint_task_lives();
                // While batches have the clock they look at the silence themselves.
                if !clock::batches_have_it() {
                    side.servo().watch(clock::now_us());
                }
            }
            Either::Second(Ok(taken)) => {
                let mut answers: Vec<u8, ANSWERS> = Vec::new();
                let arrived_us = receiver.arrived_us();
                let servo = side.servo();
                servo.receive(chunk.get(..taken).unwrap_or(&[]), arrived_us, &clock::now_us, &mut |answer: &[u8]| {
                    // It has room for as many answers as there are frames in a chunk.
                    let _ = answers.extend_from_slice(answer);
                });
                let Ok(()) = sender.write_all(&answers).await;
            }
        }
        outputs.follow(side.servo());
    }
}
