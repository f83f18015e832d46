//! From the start-up code to the running device.

use heapless::spsc::Queue;
use static_cell::StaticCell;

use super::config_task::config_task;
use super::gpio::{DRIVE_ENABLE, FAULT, Output};
use super::interrupts::{self, CONFIG_EXECUTOR, CONFIG_UART, Line, SETPOINT_EXECUTOR, SETPOINT_UART};
use super::setpoint_task::setpoint_task;
use super::uart::{Port, RING};
use super::{NAME, background, clock, kept, memory, watchdog};
use crate::board::config_link::SharedDesk;
use crate::board::{Outputs, ServoCell};
use crate::desk::{Board, Desk};
use crate::flash::Nor;

/// Runs the device. Called once, by the entry of the image.
pub fn run() -> ! {
    static SETPOINT_RING: StaticCell<Queue<u8, RING>> = StaticCell::new();
    static CONFIG_RING: StaticCell<Queue<u8, RING>> = StaticCell::new();
    static SERVO: ServoCell = ServoCell::new();
    static DESK: StaticCell<SharedDesk<Nor<'static>>> = StaticCell::new();

    // The drives first: they stay off until the controller has acknowledged them.
    let outputs = Outputs::new([Output::low(DRIVE_ENABLE)], [Output::low(FAULT)]);
    Port::Log.enable_transmission();
    let last_reset = kept::take_cause();
    defmt::info!("truepath {=str}, board {=str}, reset cause {=u8}", env!("CARGO_PKG_VERSION"), NAME, last_reset as u8);
    let Some(mut core) = cortex_m::Peripherals::take() else { unreachable!("taken here and nowhere else") };
    interrupts::set_up(&mut core.NVIC);

    // The clock of the device begins here, at 0, in batches as well.
    let (desk, servo) = Desk::start(memory::bank(last_reset), memory::lend(), Board { name: NAME, last_reset }, 0);
    let desk = DESK.init(SharedDesk::new(desk));
    // SAFETY: once, here, before the setpoint task is spawned; above it run only interrupts that leave the servo alone.
    let side = unsafe { SERVO.fill(servo) };

    let (setpoints, answers, receiving) =
        SETPOINT_UART.open(SETPOINT_RING.init(Queue::new()), [Line::SetpointReceived, Line::SetpointTransmitted]);
    interrupts::receive(Port::Setpoint, receiving);
    let (requests, responses, receiving) =
        CONFIG_UART.open(CONFIG_RING.init(Queue::new()), [Line::ConfigReceived, Line::ConfigTransmitted]);
    interrupts::receive(Port::Config, receiving);

    watchdog::start();
    match (setpoint_task(setpoints, answers, side, outputs), config_task(requests, responses, desk, &SERVO)) {
        (Ok(setpoint), Ok(config)) => {
            SETPOINT_EXECUTOR.start(Line::SetpointExecutor).spawn(setpoint);
            CONFIG_EXECUTOR.start(Line::ConfigExecutor).spawn(config);
        }
        _ => unreachable!("each task has one place, and this is its only use"),
    }
    clock::start();
    background::run(desk, &SERVO)
}
