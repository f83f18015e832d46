//! Clocks and time: 480 MHz from the 8 MHz that the ST-LINK feeds the oscillator input with (UM2407, 6.8.1).

use cortex_m::peripheral::DWT;
use embassy_stm32::Config;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_time::Instant;

use crate::clock::Clock;
use crate::stm32h743::{AHB_DIV, APB_DIV, HSE_HZ, PLL};

/// Core 480 MHz, buses 240 MHz, peripherals 120 MHz; SPI kernel clock 120 MHz.
pub fn config() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse { freq: Hertz(HSE_HZ), mode: HseMode::Bypass });
    rcc.pll1 = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::from_bits(PLL.prediv as u8),
        // Of these the registers hold one less (RM0433, 8.7.12 and 8.7.13).
        mul: PllMul::from_bits((PLL.mul - 1) as u16),
        fracn: None,
        divp: Some(PllDiv::from_bits((PLL.divp - 1) as u8)),
        divq: Some(PllDiv::from_bits((PLL.divq - 1) as u8)),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    const { assert!(AHB_DIV == 2 && APB_DIV == 2) };
    // 480 MHz is for parts of revision V at up to 105 °C at the junction (DS12110, table 24).
    rcc.voltage_scale = VoltageScale::Scale0;
    config
}

/// Starts the counter of cycles (ARMv7-M, C1.8).
pub fn count_cycles(core: &mut cortex_m::Peripherals) {
    core.DCB.enable_trace();
    DWT::unlock();
    core.DWT.enable_cycle_counter();
}

/// The time of the board.
#[derive(Clone, Copy, Debug)]
pub struct BoardClock;

impl Clock for BoardClock {
    fn now_us(&self) -> u64 {
        Instant::now().as_micros()
    }
    /// Cycles of the core.
    fn count(&self) -> u32 {
        DWT::cycle_count()
    }
}
