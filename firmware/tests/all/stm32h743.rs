//! The numbers of the NUCLEO's board file against its linker script, the flash model and the documents.

use std::collections::BTreeSet;

use truepath_fw::flash::{LEDGER_SECTORS, LOADER_SECTORS, PROGRAM_SECTORS, SECTOR_BYTES, SLOT_BYTES, SLOT_SECTORS};
use truepath_fw::stm32h743::*;

const SCRIPT: &str = include_str!("../../boards/nucleo-h743.x");
const BOARD: &str = include_str!("../../src/board/nucleo_h743/mod.rs");
const BRING_UP: &str = include_str!("../../../docs/bringup.md");

/// A region of the linker script: first address, bytes.
fn region(name: &str) -> (u32, u32) {
    let line = SCRIPT.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
    let value = |key: &str| line.split_once(key).unwrap().1.split([',', ' ']).next().unwrap();
    let origin = u32::from_str_radix(value("ORIGIN = 0x"), 16).unwrap();
    let (kilobytes, _) = value("LENGTH = ").split_once('K').unwrap();
    // The head of an update takes the last words of the program.
    let less = line.split_once("K - ").map_or(0, |(_, rest)| rest.split(' ').next().unwrap().parse().unwrap());
    (origin, (kilobytes.parse::<u32>().unwrap() << 10) - less)
}

#[test]
fn the_linker_script_names_memory_that_the_part_has() {
    let (loader, program, state) = (region("LOADER"), region("PROGRAM"), region("STATE"));
    assert_eq!((loader.0, state.0 + state.1), (FLASH_BANKS[0].0, FLASH_BANKS[1].0));
    assert_eq!((loader.1 as usize, state.1 as usize), (SECTOR_BYTES, LOADER_SECTORS.len()));
    assert_eq!((loader.0 + loader.1, program.0 + PROGRAM_SECTORS.len() as u32), (program.0, state.0));
    assert_eq!([region("RAM"), region("AXI"), region("D2")], [DTCM, AXI_SRAM, D2_SRAM]);
    for (name, sectors) in [("SLOT_A", SLOT_SECTORS[0]), ("SLOT_B", SLOT_SECTORS[1]), ("LEDGER", LEDGER_SECTORS)] {
        assert_eq!(region(name), (FLASH_BANKS[1].0 + sectors.start(), sectors.len() as u32), "{name}");
    }
    assert_eq!(region("SLOT_A").1 as usize, SLOT_BYTES);
}

/// The DMA of the setpoint link must not be lent memory of the core alone.
#[test]
fn what_dma_touches_lies_where_dma_reaches() {
    let memory = include_str!("../../src/board/nucleo_h743/memory.rs");
    for lent in ["\".d2.setpoint\"", "\".d2.ring\""] {
        assert!(memory.contains(lent), "{lent}");
    }
    assert!(SCRIPT.contains("*(.d2 .d2.*); . = ALIGN(32); _d2_end = .; } > D2"));
    assert!(dma1_reaches(region("D2")) && !dma1_reaches(region("RAM")));
    // The data cache is off, so that no attribute of memory decides what DMA and processor see.
    let start = include_str!("../../src/board/nucleo_h743/start.rs");
    assert!(start.contains("enable_icache") && !start.contains("enable_dcache"));
}

#[test]
fn pins_are_used_once_and_are_those_of_the_documents() {
    let pins: BTreeSet<String> = PINS.iter().map(|used| format!("P{}{}", used.pin.port, used.pin.number)).collect();
    assert_eq!(pins.len(), PINS.len(), "a pin with two uses");
    assert!(PINS.iter().all(|used| used.pin.number < 16 && used.function.is_none_or(|function| function < 16)));
    let named = |text: &str| -> BTreeSet<String> {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric());
        let is_pin = |word: &&str| {
            let mut letters = word.chars();
            letters.next() == Some('P')
                && letters.next().is_some_and(|port| ('A'..='K').contains(&port))
                && !letters.as_str().is_empty()
                && letters.all(|digit| digit.is_ascii_digit())
        };
        words.filter(is_pin).map(str::to_owned).collect()
    };
    assert_eq!(named(BOARD), pins, "the table of the board file");
    assert_eq!(named(BRING_UP), pins, "docs/bringup.md");
}

#[test]
fn the_documents_name_the_clock_the_rates_and_the_time_of_the_watchdog() {
    let words = [
        (BOARD, format!("at {} MHz", CORE_HZ / 1_000_000)),
        (BOARD, format!("{} Mbit/s", SETPOINT_BAUD / 1_000_000)),
        (BOARD, format!("{},{:03} bit/s", CONFIG_BAUD / 1_000, CONFIG_BAUD % 1_000)),
        (BOARD, format!("{} ms", WATCHDOG_US / 1_000)),
        (BRING_UP, format!("{} Mbit/s 8N1", SETPOINT_BAUD / 1_000_000)),
        (BRING_UP, format!("{},{:03} bit/s 8N1", CONFIG_BAUD / 1_000, CONFIG_BAUD % 1_000)),
        (BRING_UP, format!("reset of the watchdog: {} ms", WATCHDOG_US / 1_000)),
        (BRING_UP, format!("level {BOR_LEVEL} (2.7 V) is wanted")),
    ];
    for (text, said) in words {
        assert!(text.contains(&said), "{said}");
    }
}

/// By hand from RM0433, "How to derive USARTDIV": 16 samples a bit, 120 MHz.
#[test]
fn a_divider_is_the_clock_over_the_rate_to_nearest() {
    assert_eq!(usart_divider(120_000_000, 115_200), 1_042);
    assert_eq!(baud_error_ppm(120_000_000, 115_200), -319);
    assert_eq!(usart_divider(120_000_000, 921_600), 130);
    assert_eq!(baud_error_ppm(120_000_000, 921_600), 1_602);
}

#[test]
fn a_watchdog_has_the_least_prescaler_that_holds_its_time() {
    // 12 bits of a quarter of 32 kHz are 512 ms.
    assert_eq!(watchdog_registers(512_000), (4, 4_095));
    assert_eq!(watchdog_registers(600_000), (8, 2_399));
    assert_eq!(watchdog_registers(32_768_000), (256, 4_095));
    for time_us in [50_000, 512_000, 600_000, 32_768_000] {
        assert_eq!(watchdog_us(watchdog_registers(time_us), LSI_HZ), time_us);
    }
    // An oscillator that is slow by a tenth makes it longer by as much.
    assert_eq!(watchdog_us(watchdog_registers(50_000), 28_800), 55_555);
}
