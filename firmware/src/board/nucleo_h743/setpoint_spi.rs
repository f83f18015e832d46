//! The setpoint link as SPI slave: one transfer with the setpoint, one with the answer, both without COBS.
//!
//! The controller selects, clocks the setpoint frame in, deselects, waits for the ready pin, selects, clocks the answer
//! out. A frame without an answer leaves the pin low. An answer that is not fetched within the deadline of its frame is
//! withdrawn and counts as late. A transfer that ends short of a frame is dropped at the edge of the select input, so
//! the next one begins in step.

use core::pin::pin;

use embassy_futures::select::{Either3, select3};
use embassy_stm32::gpio::Output;
use embassy_stm32::mode::Async;
use embassy_stm32::spi::Spi;
use embassy_stm32::spi::mode::Slave;
use embassy_time::{Duration, Instant, with_deadline, with_timeout};
use truepath_core::link::{MAX_ANSWER_BYTES, answer_bytes, setpoint_bytes};

use super::memory::SetpointBuffers;
use super::select_edge::{self, DESELECTED};
use super::start::{BoardOutputs, Clockwork};
use super::watchdog;
use crate::board::SetpointSide;
use crate::board::config_link::Tick;

/// Time in which the last bytes of a transfer pass from the SPI to memory.
const SETTLING: Duration = Duration::from_micros(5);
/// An answer waits no longer than this, whatever the deadline: the watchdog has to be fed.
const PATIENCE: Duration = Duration::from_millis(10);

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
    select_edge::start();
    loop {
        let axes = side.servo().axes();
        let length = setpoint_bytes(axes);
        let SetpointBuffers { received, sent } = buffers;
        let frame = received.get_mut(..length).unwrap_or_default();
        let idle = sent.get(..length).unwrap_or(&[]);
        DESELECTED.reset();
        if !whole(spi.transfer(frame, idle), &mut side, &mut outputs, tick).await {
            continue;
        }
        let arrived_us = Instant::now().as_micros();
        let mut answer = [0; MAX_ANSWER_BYTES];
        let used = side.servo().frame(frame, arrived_us, &Clockwork, &mut answer);
        outputs.follow(side.servo());
        if let Some(used) = used.filter(|&used| used == answer_bytes(axes)) {
            let [out, ignored] = [sent.get_mut(..used), received.get_mut(..used)].map(Option::unwrap_or_default);
            out.copy_from_slice(answer.get(..used).unwrap_or(&[]));
            let deadline = Instant::from_micros(side.servo().answer_by_us()).min(Instant::now() + PATIENCE);
            ready.set_high();
            let fetched = with_deadline(deadline, spi.transfer(ignored, out)).await;
            ready.set_low();
            if !matches!(fetched, Ok(Ok(()))) {
                side.servo().withdraw();
            }
        }
    }
}

/// Waits for the end of a transfer, over the ticks; says whether it was a whole one.
async fn whole<E>(
    transfer: impl Future<Output = Result<(), E>>,
    side: &mut SetpointSide,
    outputs: &mut BoardOutputs,
    tick: &Tick,
) -> bool {
    let mut transfer = pin!(transfer);
    loop {
        match select3(tick.wait(), transfer.as_mut(), DESELECTED.wait()).await {
            Either3::First(()) => {
                watchdog::setpoint_task_lives();
                side.servo().watch(Instant::now().as_micros());
                outputs.follow(side.servo());
            }
            Either3::Second(result) => return result.is_ok(),
            Either3::Third(()) => return matches!(with_timeout(SETTLING, transfer.as_mut()).await, Ok(Ok(()))),
        }
    }
}
