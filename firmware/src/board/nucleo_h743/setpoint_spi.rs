//! The setpoint link as SPI slave: one transfer with the setpoint, one with the answer, both without COBS.
//!
//! The controller selects, clocks the setpoint frame in, deselects, waits for the ready pin, selects, clocks the answer
//! out. A frame without an answer leaves the pin low; an answer that is not fetched is withdrawn after [`PATIENCE`].
//!
//! A transfer cut short leaves the count of bytes out of step: the frames that follow fail their CRC, which is safe, until
//! a transfer begins in a pause, at the latest after [`QUIET_TICKS`] without a whole frame, when reception begins anew.

use core::pin::pin;

use embassy_futures::select::{Either, select};
use embassy_stm32::gpio::Output;
use embassy_stm32::mode::Async;
use embassy_stm32::spi::Spi;
use embassy_stm32::spi::mode::Slave;
use embassy_time::{Duration, Instant, with_timeout};
use truepath_core::link::{MAX_ANSWER_BYTES, answer_bytes, setpoint_bytes};

use super::memory::SetpointBuffers;
use super::start::{BoardOutputs, Clockwork};
use super::watchdog;
use crate::board::SetpointSide;
use crate::board::config_link::Tick;

/// How long an answer waits to be fetched; two ticks of 1 kHz.
const PATIENCE: Duration = Duration::from_millis(2);
/// Milliseconds without a whole frame after which reception begins anew.
const QUIET_TICKS: u32 = 2;

/// The task.
#[embassy_executor::task]
pub async fn setpoint_spi(
    mut spi: Spi<'static, Async, Slave>,
    mut ready: Output<'static>,
    buffers: &'static mut SetpointBuffers,
    mut side: SetpointSide,
    mut outputs: BoardOutputs,
    tick: &'static Tick,
) {
    loop {
        let axes = side.servo().axes();
        let length = setpoint_bytes(axes);
        let SetpointBuffers { received, sent } = buffers;
        let frame = received.get_mut(..length).unwrap_or_default();
        let idle = sent.get(..length).unwrap_or(&[]);
        match received_or_quiet(spi.transfer(frame, idle), &mut side, tick).await {
            Some(Ok(())) => {
                let arrived_us = Instant::now().as_micros();
                let mut answer = [0; MAX_ANSWER_BYTES];
                let used = side.servo().frame(frame, arrived_us, &Clockwork, &mut answer);
                if let Some(used) = used.filter(|&used| used == answer_bytes(axes)) {
                    let [out, ignored] =
                        [sent.get_mut(..used), received.get_mut(..used)].map(Option::unwrap_or_default);
                    out.copy_from_slice(answer.get(..used).unwrap_or(&[]));
                    ready.set_high();
                    // An answer that is not fetched in time is the controller's time-out.
                    let _ = with_timeout(PATIENCE, spi.transfer(ignored, out)).await;
                    ready.set_low();
                }
            }
            Some(Err(_)) | None => {}
        }
        outputs.follow(side.servo());
    }
}

/// Waits for a transfer, over the ticks; `None` when the line was quiet.
async fn received_or_quiet<T>(transfer: impl Future<Output = T>, side: &mut SetpointSide, tick: &Tick) -> Option<T> {
    let mut transfer = pin!(transfer);
    for _ in 0..QUIET_TICKS {
        match select(transfer.as_mut(), tick.wait()).await {
            Either::First(result) => return Some(result),
            Either::Second(()) => {
                watchdog::setpoint_task_lives();
                side.servo().watch(Instant::now().as_micros());
            }
        }
    }
    None
}
