//! What the board file of the NUCLEO-H743ZI2 sets, as numbers: clock tree, baud rates, watchdog, memory, pins.
//!
//! A claim that the reference manual decides needs no board: each is a constant here, built from what is handed to the HAL,
//! and held against the manual by an assertion that is part of the build of every target. What only a board can show
//! (oscillators, edges, erase times) is in `docs/bringup.md`.
//!
//! RM0433 is ST's reference manual of the STM32H743, DS12110 its data sheet, UM2407 the manual of the board.

/// The clock that the ST-LINK feeds the oscillator input with, Hz (UM2407, 6.8.1).
pub const HSE_HZ: u32 = 8_000_000;
/// Factors of PLL 1: input divider, multiplier, and the dividers of its outputs P (the core) and Q (the kernel of SPI 1).
pub const PLL: PllFactors = PllFactors { prediv: 4, mul: 480, divp: 2, divq: 8 };
/// Divider of the bus matrix, of all peripheral buses.
pub const AHB_DIV: u32 = 2;
/// See [`AHB_DIV`].
pub const APB_DIV: u32 = 2;

/// Factors of a PLL without fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PllFactors {
    /// DIVM.
    pub prediv: u32,
    /// DIVN.
    pub mul: u32,
    /// DIVP.
    pub divp: u32,
    /// DIVQ.
    pub divq: u32,
}

impl PllFactors {
    /// What its phase detector compares at, Hz.
    pub const fn reference_hz(self, input_hz: u32) -> u32 {
        input_hz / self.prediv
    }
    /// Its oscillator, Hz.
    pub const fn vco_hz(self, input_hz: u32) -> u32 {
        self.reference_hz(input_hz) * self.mul
    }
}

/// The core, Hz.
pub const CORE_HZ: u32 = PLL.vco_hz(HSE_HZ) / PLL.divp;
/// Bus matrix, flash, AXI, DMA, Hz.
pub const AHB_HZ: u32 = CORE_HZ / AHB_DIV;
/// Peripheral buses; kernel of the USARTs, Hz.
pub const APB_HZ: u32 = AHB_HZ / APB_DIV;
/// Kernel of SPI 1, Hz.
pub const SPI_HZ: u32 = PLL.vco_hz(HSE_HZ) / PLL.divq;

const _: () = {
    // No divider leaves a rest, so the frequencies are those of the text.
    assert!(HSE_HZ.is_multiple_of(PLL.prediv) && PLL.vco_hz(HSE_HZ).is_multiple_of(PLL.divp * AHB_DIV * APB_DIV));
    assert!(PLL.vco_hz(HSE_HZ).is_multiple_of(PLL.divq));
    // RM0433, 8.7.11 to 8.7.13 (PLLCKSELR, PLLCFGR, PLL1DIVR): DIVM 1 … 63, DIVN 4 … 512, DIVP of PLL 1 even, DIVQ 1 … 128.
    assert!(PLL.prediv >= 1 && PLL.prediv <= 63 && PLL.mul >= 4 && PLL.mul <= 512);
    assert!(PLL.divp.is_multiple_of(2) && PLL.divp <= 128 && PLL.divq >= 1 && PLL.divq <= 128);
    // RM0433, 8.5.5 and DS12110 (PLL characteristics, wide range): reference 2 … 16 MHz, oscillator 192 … 960 MHz in revision V.
    assert!(PLL.reference_hz(HSE_HZ) >= 2_000_000 && PLL.reference_hz(HSE_HZ) <= 16_000_000);
    assert!(PLL.vco_hz(HSE_HZ) >= 192_000_000 && PLL.vco_hz(HSE_HZ) <= 960_000_000);
    // DS12110, table 24 (general operating conditions), voltage scale 0: core 480, bus matrix 240, peripheral buses 120 MHz.
    assert!(CORE_HZ == 480_000_000 && AHB_HZ == 240_000_000 && APB_HZ == 120_000_000 && SPI_HZ == 120_000_000);
};

/// Bits per second of the setpoint link on USART 6.
pub const SETPOINT_BAUD: u32 = 3_000_000;
/// Bits per second of the configuration link on USART 3.
pub const CONFIG_BAUD: u32 = 921_600;

/// The divider of a USART: what goes into BRR for 16 samples a bit, clock over rate, rounded (RM0433, "baud rate generation").
/// Less than 16 would need 8 samples.
pub const fn usart_divider(kernel_hz: u32, baud: u32) -> u32 {
    (kernel_hz + baud / 2) / baud
}
/// How far a USART is off its rate, millionths, of either sign, towards zero.
pub const fn baud_error_ppm(kernel_hz: u32, baud: u32) -> i64 {
    let divider = usart_divider(kernel_hz, baud) as i64;
    (kernel_hz as i64 * 1_000_000 / divider - baud as i64 * 1_000_000) / baud as i64
}

const _: () = {
    assert!(usart_divider(APB_HZ, SETPOINT_BAUD) == 40 && baud_error_ppm(APB_HZ, SETPOINT_BAUD) == 0);
    assert!(usart_divider(APB_HZ, CONFIG_BAUD) == 130 && baud_error_ppm(APB_HZ, CONFIG_BAUD) == 1_602);
    // 16 samples a bit, and a divider of 16 bits.
    assert!(usart_divider(APB_HZ, SETPOINT_BAUD) >= 16 && usart_divider(APB_HZ, CONFIG_BAUD) <= 0xFFFF);
    // RM0433, tolerance of the receiver: 3.33 % in all with 16 samples, 8 bits and a fraction in BRR; half of it is left for the other end.
    assert!(baud_error_ppm(APB_HZ, CONFIG_BAUD) < 33_300 / 2);
};

/// Time without a feed to the reset by the independent watchdog, µs, at the nominal clock of its oscillator.
pub const WATCHDOG_US: u32 = 50_000;
/// That oscillator, LSI, Hz: nominal.
pub const LSI_HZ: u32 = 32_000;
/// Ticks of a millisecond that the configuration task may be silent.
pub const CONFIG_TICKS: u32 = 15_000;
/// Longest time for which the setpoint task waits for a controller to fetch an answer on SPI without a feed, µs.
pub const SPI_PATIENCE_US: u32 = 10_000;
/// Longest erase of a sector of the flash, 32 bits at a time, ms (DS12110, flash memory programming).
pub const ERASE_MS: u32 = 4_000;

/// Prescaler and reload value of the independent watchdog for a time: the least prescaler of 4, 8, … 256 with which 12 bits hold it
/// (RM0433, 44.3). As the HAL chooses them.
pub const fn watchdog_registers(timeout_us: u32) -> (u32, u32) {
    let mut prescaler = 4;
    while prescaler < 256 && timeout_us as u64 * LSI_HZ as u64 / 1_000_000 > prescaler as u64 * 4_096 {
        prescaler *= 2;
    }
    (prescaler, (timeout_us as u64 * LSI_HZ as u64 / 1_000_000 / prescaler as u64) as u32 - 1)
}
/// The time that prescaler and reload value give with an oscillator, µs.
pub const fn watchdog_us((prescaler, reload): (u32, u32), lsi_hz: u32) -> u32 {
    ((reload + 1) as u64 * prescaler as u64 * 1_000_000 / lsi_hz as u64) as u32
}

const _: () = {
    let registers = watchdog_registers(WATCHDOG_US);
    assert!(registers.0 == 4 && registers.1 == 399 && registers.1 <= 0xFFF);
    assert!(watchdog_us(registers, LSI_HZ) == WATCHDOG_US);
    // Fed each millisecond, and at the latest when an answer was not fetched: even with an oscillator that is twice as fast.
    assert!(watchdog_us(registers, 2 * LSI_HZ) >= 2 * (SPI_PATIENCE_US + 1_000));
    // Three sectors of a slot are erased in one go.
    assert!(CONFIG_TICKS > 3 * ERASE_MS);
};

/// Memory regions (RM0433, 2.3.2, memory map): first address, bytes.
pub const DTCM: (u32, u32) = (0x2000_0000, 128 << 10);
/// SRAM of the AXI bus, domain 1.
pub const AXI_SRAM: (u32, u32) = (0x2400_0000, 512 << 10);
/// SRAM 1 to 3 of domain 2: 128, 128 and 32 KiB, one behind the other.
pub const D2_SRAM: (u32, u32) = (0x3000_0000, (128 + 128 + 32) << 10);
/// Flash, bank 1 and bank 2.
pub const FLASH_BANKS: [(u32, u32); 2] = [(0x0800_0000, 1 << 20), (0x0810_0000, 1 << 20)];

/// Whether DMA 1 reaches a region (RM0433, 2.1, figure 1: its masters lie in domain 2; only the core and the MDMA see the TCM).
pub const fn dma1_reaches(region: (u32, u32)) -> bool {
    region.0 != DTCM.0
}

const _: () = {
    use crate::flash::{LEDGER_SECTORS, SECTOR_BYTES, WORD_BYTES};
    // RM0433, 4.3.8 (flash word of 256 bits and 10 of ECC), 4.3.5 (8 sectors of 128 KiB a bank).
    assert!(WORD_BYTES * 8 == 256 && SECTOR_BYTES == 128 << 10);
    // Slots and ledger fill the bank that the program does not run from.
    assert!(LEDGER_SECTORS.end() == FLASH_BANKS[1].1);
    assert!(FLASH_BANKS[0].0 + FLASH_BANKS[0].1 == FLASH_BANKS[1].0);
    assert!(dma1_reaches(D2_SRAM) && !dma1_reaches(DTCM));
};

/// Brown-out level that the board wants, in its option bytes: 3, a reset below 2.7 V (RM0433, 3.9.9, `BOR_LEV`). The reset
/// value is 0, power-on reset only.
pub const BOR_LEVEL: u8 = 3;

/// A pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin {
    /// A letter.
    pub port: char,
    /// 0 … 15.
    pub number: u8,
}

/// What a pin is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// What its signal is called on the board.
    pub signal: &'static str,
    /// The pin.
    pub pin: Pin,
    /// Number of its alternate function (DS12110, tables of alternate functions); `None`: plain input or output.
    pub function: Option<u8>,
}

const fn used(signal: &'static str, port: char, number: u8, function: Option<u8>) -> Use {
    Use { signal, pin: Pin { port, number }, function }
}

/// Output for the drive enable, and its green lamp.
pub const DRIVE_ENABLE: [Pin; 2] = [Pin { port: 'E', number: 11 }, Pin { port: 'B', number: 0 }];
/// Output for a fault, and its red lamp.
pub const FAULT: [Pin; 2] = [Pin { port: 'E', number: 9 }, Pin { port: 'B', number: 14 }];
/// Select input of SPI 1. Its number is that of its line of the edge detector (RM0433, 20.3).
pub const SPI_SELECT: Pin = Pin { port: 'A', number: 4 };

/// Every pin in use. That a pin has the function is checked by the types of the HAL, which are made from ST's own table.
pub const PINS: [Use; 15] = [
    used("setpoint UART out", 'G', 14, Some(7)),
    used("setpoint UART in", 'G', 9, Some(7)),
    used("SPI clock", 'A', 5, Some(5)),
    used("SPI in", 'B', 5, Some(5)),
    used("SPI out", 'A', 6, Some(5)),
    used("SPI select", SPI_SELECT.port, SPI_SELECT.number, Some(5)),
    used("SPI ready", 'F', 14, None),
    used("choice of the setpoint link", 'E', 13, None),
    used("configuration UART out", 'D', 8, Some(7)),
    used("configuration UART in", 'D', 9, Some(7)),
    used("drive enable", DRIVE_ENABLE[0].port, DRIVE_ENABLE[0].number, None),
    used("green lamp", DRIVE_ENABLE[1].port, DRIVE_ENABLE[1].number, None),
    used("fault", FAULT[0].port, FAULT[0].number, None),
    used("red lamp", FAULT[1].port, FAULT[1].number, None),
    used("button", 'C', 13, None),
];

/// Priorities, 0 the most urgent; four bits of them count (RM0433, 19.1).
pub mod priority {
    /// Time driver, timer 5.
    pub const TIME: u8 = 0;
    /// Setpoint link: UART, SPI, DMA.
    pub const SETPOINT_LINK: u8 = 5;
    /// Executor of the setpoint task.
    pub const SETPOINT_TASK: u8 = 6;
    /// UART of the configuration link.
    pub const CONFIG_LINK: u8 = 9;
    /// Executor of the configuration task.
    pub const CONFIG_TASK: u8 = 10;

    const _: () = assert!(TIME < SETPOINT_LINK && SETPOINT_LINK < SETPOINT_TASK && SETPOINT_TASK < CONFIG_LINK);
    const _: () = assert!(CONFIG_LINK < CONFIG_TASK && CONFIG_TASK < 16);
}
