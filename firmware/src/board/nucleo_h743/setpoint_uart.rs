//! The setpoint link on a UART: received by DMA into a ring, read when the line falls idle.

use core::pin::pin;
use core::task::Poll;

use embassy_futures::poll_once;
use embassy_futures::select::{Either, select};
use embassy_stm32::mode::Async;
use embassy_stm32::usart::{RingBufferedUartRx, UartTx};
use embassy_time::Instant;
use heapless::Vec;
use truepath_core::link::MAX_ANSWER_BYTES;

use super::clocks::BoardClock;
use super::memory::SetpointBuffers;
use super::outputs::BoardOutputs;
use super::watchdog;
use crate::board::config_link::Tick;
use crate::board::shared_servo::SetpointSide;
use crate::servo::ServoAccess;

/// Most answers to what was read at once: the shortest frame takes 34 bytes of the 96.
const ANSWERS: usize = 3 * (MAX_ANSWER_BYTES + 2);

/// The task: bytes in, answers out, time-outs by the tick.
#[embassy_executor::task]
pub async fn setpoint_uart(
    mut receiver: RingBufferedUartRx<'static>,
    mut sender: UartTx<'static, Async>,
    buffers: &'static mut SetpointBuffers,
    mut side: SetpointSide,
    mut outputs: BoardOutputs,
    tick: &'static Tick,
) {
    // Up to when the ring was known to be empty.
    let mut empty_us = Instant::now().as_micros();
    loop {
        // The tick first: bytes that never end must not keep the task from reporting.
        if tick.try_take().is_some() {
            watchdog::setpoint_task_lives();
            side.with(|servo| {
                servo.watch(Instant::now().as_micros());
                outputs.follow(servo);
            });
        }
        let (result, arrived_us) = {
            let mut reading = pin!(receiver.read(&mut buffers.received));
            match poll_once(reading.as_mut()) {
                // They arrived while the task did something else, at the earliest when the ring was last empty.
                Poll::Ready(result) => (result, empty_us),
                Poll::Pending => match select(tick.wait(), reading).await {
                    Either::First(()) => {
                        tick.signal(());
                        continue;
                    }
                    Either::Second(result) => (result, Instant::now().as_micros()),
                },
            }
        };
        let Ok(taken) = result else {
            // Noise, or an overrun: reception begins anew, and the frame it fell into is damaged.
            receiver.start_uart();
            continue;
        };
        if taken < buffers.received.len() {
            empty_us = Instant::now().as_micros();
        }
        let mut answers: Vec<u8, ANSWERS> = Vec::new();
        let bytes = buffers.received.get(..taken).unwrap_or(&[]);
        side.with(|servo| {
            servo.receive(bytes, arrived_us, &BoardClock, &mut |answer: &[u8]| {
                // It has room for as many answers as there are frames in a chunk.
                let _ = answers.extend_from_slice(answer);
            });
            outputs.follow(servo);
        });
        // The DMA does not reach the memory of the stack.
        if let Some(place) = buffers.sent.get_mut(..answers.len()) {
            place.copy_from_slice(&answers);
            // What cannot be sent is an answer that does not come: the controller's time-out.
            let _ = sender.write(place).await;
        }
    }
}
