//! The setpoint task: bytes in, answers out, time-outs by the tick.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embedded_io_async::{Read as _, Write as _};
use heapless::Vec;
use truepath_core::link::MAX_ANSWER_BYTES;

use super::pins::Pins;
use super::uart::Uart;
use super::{clock, watchdog};
use crate::board::SetpointSide;

/// Wakes the task each millisecond.
pub static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Bytes taken at once; the shortest packet has 35, so there are three frames in them at the most.
const CHUNK: usize = 96;
const ANSWERS: usize = 3 * (MAX_ANSWER_BYTES + 2);

/// The task.
#[embassy_executor::task]
pub async fn setpoint_task(mut uart: Uart, mut side: SetpointSide, mut pins: Pins) {
    let mut chunk = [0; CHUNK];
    loop {
        match select(uart.read(&mut chunk), TICK.wait()).await {
            Either::First(Ok(taken)) => {
                let mut answers: Vec<u8, ANSWERS> = Vec::new();
                let arrived_us = uart.arrived_us();
                let servo = side.servo();
                servo.receive(chunk.get(..taken).unwrap_or(&[]), arrived_us, &clock::now_us, &mut |answer: &[u8]| {
                    // It has room for as many answers as there are frames in a chunk.
                    let _ = answers.extend_from_slice(answer);
                });
                let Ok(()) = uart.write_all(&answers).await;
            }
            Either::Second(()) => {
                watchdog::setpoint_task_lives();
                // While batches have the clock they look at the silence themselves.
                if !clock::batches_have_it() {
                    side.servo().watch(clock::now_us());
                }
            }
        }
        pins.follow(side.servo());
    }
}
