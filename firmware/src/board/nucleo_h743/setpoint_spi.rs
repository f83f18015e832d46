//! The setpoint link as SPI slave: one transfer with the setpoint, one with the answer, both without COBS.
//!
//! The controller selects, clocks the setpoint frame in, deselects, waits for the ready pin, selects, clocks the answer
//! out. A frame without an answer leaves the pin low. An answer that is not fetched within the deadline of its frame is
//! withdrawn and counts as late. A transfer that ends short of a frame is dropped at the edge of the select input, so
//! the next one begins in step: its rising edge is the interrupt of line 4. The input belongs to the SPI; the edge
//! detector reads it beside (RM0433, 20.3 and 12.3.3).

use core::pin::pin;

use embassy_futures::select::{Either3, select3};
use embassy_stm32::gpio::Output;
use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::mode::Async;
use embassy_stm32::pac::{EXTI, SYSCFG};
use embassy_stm32::spi::Spi;
use embassy_stm32::spi::mode::Slave;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, with_deadline, with_timeout};
use truepath_core::link::{MAX_ANSWER_BYTES, answer_bytes, setpoint_bytes};

use super::clocks::BoardClock;
use super::interrupts::SETPOINT_LINK;
use super::memory::SetpointBuffers;
use super::outputs::BoardOutputs;
use super::watchdog;
use crate::board::config_link::Tick;
use crate::board::shared_servo::SetpointSide;
use crate::servo::ServoAccess;
use crate::stm32h743::{SPI_PATIENCE_US, SPI_SELECT};

/// Time in which the last bytes of a transfer pass from the SPI to memory.
const SETTLING: Duration = Duration::from_micros(5);
/// An answer waits no longer than this, whatever the deadline: the watchdog has to be fed.
const PATIENCE: Duration = Duration::from_micros(SPI_PATIENCE_US as u64);

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
    watch_select();
    loop {
        let axes = side.with(|servo| servo.axes());
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
        let (used, answer_by_us) = side.with(|servo| {
            let used = servo.frame(frame, arrived_us, &BoardClock, &mut answer);
            outputs.follow(servo);
            (used, servo.answer_by_us())
        });
        if let Some(used) = used.filter(|&used| used == answer_bytes(axes)) {
            let [out, ignored] = [sent.get_mut(..used), received.get_mut(..used)].map(Option::unwrap_or_default);
            out.copy_from_slice(answer.get(..used).unwrap_or(&[]));
            let deadline = Instant::from_micros(answer_by_us).min(Instant::now() + PATIENCE);
            ready.set_high();
            let fetched = with_deadline(deadline, spi.transfer(ignored, out)).await;
            ready.set_low();
            if !matches!(fetched, Ok(Ok(()))) {
                side.with(|servo| servo.withdraw());
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
                side.with(|servo| {
                    servo.watch(Instant::now().as_micros());
                    outputs.follow(servo);
                });
            }
            Either3::Second(result) => return result.is_ok(),
            Either3::Third(()) => return matches!(with_timeout(SETTLING, transfer.as_mut()).await, Ok(Ok(()))),
        }
    }
}

/// Line of the edge detector, the number of the pin.
const LINE: usize = SPI_SELECT.number as usize;
const _: () = assert!(LINE == 4 && SPI_SELECT.port == 'A', "the handler below is that of line 4");

/// Signalled at each edge.
static DESELECTED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Starts to watch the select input.
fn watch_select() {
    // Port A is number 0; four lines share a register.
    SYSCFG.exticr(LINE / 4).modify(|w| w.set_exti(LINE % 4, 0));
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    interrupt::EXTI4.set_priority(SETPOINT_LINK);
    // SAFETY: the handler is below; nothing relies on this line being masked.
    unsafe { interrupt::EXTI4.enable() };
}

#[embassy_stm32::interrupt]
fn EXTI4() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    DESELECTED.signal(());
}
