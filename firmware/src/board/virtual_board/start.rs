//! From the start-up code to the running device.

use heapless::spsc::Queue;
use static_cell::StaticCell;
use truepath_core::image::DeviceClass;

use super::gpio::{DRIVE_ENABLE, FAULT, Output};
use super::interrupts::{self, CONFIG_EXECUTOR, CONFIG_UART, SETPOINT_EXECUTOR, SETPOINT_UART};
use super::line::Line;
use super::shared_memory::presence;
use super::tasks::{background, config_task, setpoint_task};
use super::uart::{Port, RING};
use super::{clock, memory, retained, watchdog};
use crate::board::config_link::{Configuration, SharedConfiguration};
use crate::board::outputs::Outputs;
use crate::board::shared_servo::share;
use crate::config_service::{Board, ConfigService};
use crate::flash::Nor;
use crate::servo::Servo;

/// The board's name in `Hello`.
pub const NAME: &str = "virtual";

/// Runs the device. Called once, by the entry of the image.
pub fn run() -> ! {
    background(set_up())
}

/// Everything but the background thread.
///
/// Not inlined: its frame holds the whole device several times, and the on-board correction is not to stand upon it.
#[inline(never)]
fn set_up() -> &'static SharedConfiguration<Nor<'static>> {
    static SETPOINT_RING: StaticCell<Queue<u8, RING>> = StaticCell::new();
    static CONFIG_RING: StaticCell<Queue<u8, RING>> = StaticCell::new();
    static SERVO: StaticCell<Servo<'static>> = StaticCell::new();
    static CONFIGURATION: StaticCell<SharedConfiguration<Nor<'static>>> = StaticCell::new();

    // The drives first: they stay off until the controller has acknowledged them.
    let outputs = Outputs::new([Output::low(DRIVE_ENABLE)], [Output::low(FAULT)]);
    Port::Log.enable_transmission();
    let last_reset = retained::take_cause();
    defmt::info!("truepath {=str}, board {=str}, reset cause {=u8}", env!("CARGO_PKG_VERSION"), NAME, last_reset as u8);
    let Some(mut core) = cortex_m::Peripherals::take() else { unreachable!("taken here and nowhere else") };
    // Without a loader the vectors are elsewhere: those at 0 only lead to the entry.
    // SAFETY: the table of this image, aligned by the link script.
    unsafe { core.SCB.vtor.write(memory::vectors()) };
    interrupts::set_up(&mut core.NVIC);

    // The clock of the device begins here, at 0, in batches as well.
    let board = Board {
        name: NAME,
        last_reset,
        class: DeviceClass::Bench,
        present: presence(),
        id: [0; 12],
        secret: None,
        counter_hz: clock::COUNTER_HZ,
    };
    let flash = memory::flash(last_reset, retained::has_loader());
    let (service, servo) = ConfigService::start(flash, memory::lend(), board, 0);
    // SAFETY: the first side goes to the setpoint task, the second below it; above it run only interrupts that leave the
    // servo alone.
    let (side, servo) = unsafe { share(SERVO.init(servo)) };
    let configuration = CONFIGURATION.init(SharedConfiguration::new(Configuration { service, servo }));

    let (setpoints, answers, receiving) =
        SETPOINT_UART.open(SETPOINT_RING.init(Queue::new()), [Line::SetpointReceived, Line::SetpointTransmitted]);
    interrupts::receive(Port::Setpoint, receiving);
    let (requests, responses, receiving) =
        CONFIG_UART.open(CONFIG_RING.init(Queue::new()), [Line::ConfigReceived, Line::ConfigTransmitted]);
    interrupts::receive(Port::Config, receiving);

    watchdog::start();
    match (setpoint_task(setpoints, answers, side, outputs), config_task(requests, responses, configuration)) {
        (Ok(setpoint), Ok(config)) => {
            SETPOINT_EXECUTOR.start(Line::SetpointExecutor).spawn(setpoint);
            CONFIG_EXECUTOR.start(Line::ConfigExecutor).spawn(config);
        }
        _ => unreachable!("each task has one place, and this is its only use"),
    }
    clock::start();
    configuration
}
