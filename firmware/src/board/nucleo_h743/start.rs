//! From the start-up code to the running device.

use embassy_executor::SpawnToken;
use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_stm32::pac::gpio::vals::Ospeedr;
use embassy_stm32::pac::{FLASH, GPIOA, RCC};
use embassy_stm32::spi::{self, SlaveSelectPolarity, Spi};
use embassy_stm32::uid::uid;
use embassy_stm32::usart::{self, BufferedUart, Uart};
use static_cell::StaticCell;
use truepath_core::image::DeviceClass;
use truepath_core::link::ResetCause;

use super::flash::BoardFlash;
use super::interrupts::{self, Lines, SETPOINT_LINK};
use super::setpoint_spi::setpoint_spi;
use super::setpoint_uart::setpoint_uart;
use super::tasks::{SETPOINT_TICK, background, config_task, tick};
use super::{clocks, memory, outputs, random, watchdog};
use crate::board::config_link::{Configuration, SharedConfiguration};
use crate::board::shared_servo::share;
use crate::config_service::{Board, ConfigService};
use crate::servo::Servo;
use crate::stm32h743::{BOR_LEVEL, CONFIG_BAUD, CORE_HZ, SETPOINT_BAUD};

/// The board's name in `Hello`.
pub const NAME: &str = "nucleo-h743zi2";

/// Runs the device. Called once, by the entry of the image.
pub fn run() -> ! {
    background(set_up())
}

/// Everything but the background thread.
///
/// Not inlined: its frame holds the whole device several times, and the on-board correction is not to stand upon it.
#[inline(never)]
fn set_up() -> &'static SharedConfiguration<BoardFlash> {
    static SERVO: StaticCell<Servo<'static>> = StaticCell::new();
    static CONFIGURATION: StaticCell<SharedConfiguration<BoardFlash>> = StaticCell::new();

    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.SCB.enable_icache();
        clocks::count_cycles(&mut core);
    }
    let last_reset = reset_cause();
    let mut config = clocks::config();
    config.dma_interrupt_priority = SETPOINT_LINK;
    let p = embassy_stm32::init(config);
    // The drives first: they stay off until the controller has acknowledged them.
    let outputs = outputs::low((p.PE11, p.PB0), (p.PE9, p.PB14));
    defmt::info!("truepath {=str}, board {=str}, reset cause {=u8}", env!("CARGO_PKG_VERSION"), NAME, last_reset as u8);
    let level = FLASH.optsr_cur().read().bor_lev();
    if level != BOR_LEVEL {
        defmt::warn!(
            "brown-out level {=u8} in the option bytes, wanted {=u8}: a sagging supply may tear a word",
            level,
            BOR_LEVEL
        );
    }
    // SAFETY: nothing in these regions is used before.
    unsafe { memory::wake() };

    // The blue button is high while it is held (UM2407, push-buttons).
    let button = Input::new(p.PC13, Pull::Down);
    cortex_m::asm::delay(48_000);
    let board = Board {
        name: NAME,
        last_reset,
        class: DeviceClass::Board,
        present: button.is_high(),
        id: uid(),
        secret: random::draw(),
        counter_hz: CORE_HZ,
    };
    let (service, servo) = ConfigService::start(BoardFlash::new(p.FLASH), memory::lend(), board, 0);
    // SAFETY: the first side goes to the setpoint task, the second below it; above it run only interrupts that leave the
    // servo alone.
    let (side, servo) = unsafe { share(SERVO.init(servo)) };
    let configuration = CONFIGURATION.init(SharedConfiguration::new(Configuration { service, servo }));
    let [setpoint_executor, config_executor] = interrupts::start();

    let strap = Input::new(p.PE13, Pull::Up);
    cortex_m::asm::delay(48_000);
    if strap.is_high() {
        let mut config = usart::Config::default();
        config.baudrate = SETPOINT_BAUD;
        let uart = must(Uart::new(p.USART6, p.PG9, p.PG14, p.DMA1_CH1, p.DMA1_CH0, Lines, config));
        let (sender, receiver) = uart.split();
        let receiver = receiver.into_ring_buffered(memory::setpoint_ring());
        let buffers = memory::setpoint_buffers();
        setpoint_executor.spawn(token(setpoint_uart(receiver, sender, buffers, side, outputs, &SETPOINT_TICK)));
    } else {
        let mut config = spi::Config::default();
        config.nss_polarity = SlaveSelectPolarity::ActiveLow;
        let spi = Spi::new_slave(p.SPI1, p.PA5, p.PB5, p.PA6, p.PA4, p.DMA1_CH2, p.DMA1_CH3, Lines, config);
        // The HAL leaves this output at the lowest speed, which ends at some 12 Mbit/s (DS12110, table 59).
        GPIOA.ospeedr().modify(|w| w.set_ospeedr(6, Ospeedr::VERY_HIGH_SPEED));
        let ready = Output::new(p.PF14, Level::Low, Speed::VeryHigh);
        let buffers = memory::setpoint_buffers();
        setpoint_executor.spawn(token(setpoint_spi(spi, ready, buffers, side, outputs, &SETPOINT_TICK)));
    }
    let mut config = usart::Config::default();
    config.baudrate = CONFIG_BAUD;
    let [to, from] = memory::configuration_buffers();
    let (sender, receiver) = must(BufferedUart::new(p.USART3, p.PD9, p.PD8, to, from, Lines, config)).split();
    config_executor.spawn(token(config_task(receiver, sender, configuration)));
    setpoint_executor.spawn(token(tick()));
    watchdog::start(p.IWDG1);
    configuration
}

/// Why the last reset happened; clears the flags (RM0433, 8.7.37).
fn reset_cause() -> ResetCause {
    let flags = RCC.rsr().read();
    RCC.rsr().modify(|w| w.set_rmvf(true));
    if flags.iwdg1rstf() {
        ResetCause::Watchdog
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.porrstf() {
        ResetCause::PowerOn
    } else if flags.borrstf() {
        ResetCause::BrownOut
    } else if flags.pinrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}

/// A task's place, of which there is one.
fn token<S, E>(made: Result<SpawnToken<S>, E>) -> SpawnToken<S> {
    match made {
        Ok(token) => token,
        Err(_) => unreachable!("each task has one place, and this is its only use"),
    }
}

/// A driver whose configuration is constant.
fn must<T, E>(made: Result<T, E>) -> T {
    match made {
        Ok(driver) => driver,
        Err(_) => unreachable!("the rates are within the range of the peripheral"),
    }
}
