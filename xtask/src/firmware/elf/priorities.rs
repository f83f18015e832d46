//! Who runs at which priority on each board, and what a call graph cannot see: calls through registers, recursion.
//!
//! Kept beside the interrupt tables of the boards (`interrupts.rs` of each); a function that calls through a register
//! and is not named here is a finding.

use super::stack::{Indirect, Level, Recursion};
use crate::firmware::image::Board;

/// The priorities of a board, from the thread up.
pub const fn levels(board: Board) -> &'static [Level] {
    match board {
        Board::Virtual => VIRTUAL,
        Board::NucleoH743 => NUCLEO_H743,
    }
}

/// The same of its loader, which unmasks no interrupt.
pub const fn loader_levels(board: Board) -> &'static [Level] {
    match board {
        Board::Virtual => &[THREAD_OF_LOADER, WATCHDOG, HARD_FAULT],
        Board::NucleoH743 => &[THREAD_OF_LOADER, HARD_FAULT],
    }
}

const THREAD_OF_LOADER: Level =
    Level { name: "thread: swap, start of the program", roots: &["Reset"], exception: false };
const WATCHDOG: Level = Level { name: "watchdog", roots: &["NonMaskableInt"], exception: true };
const HARD_FAULT: Level = Level { name: "hard fault", roots: &["HardFault"], exception: true };

/// Priorities of the virtual board, from the thread up; see its `interrupts.rs`.
const VIRTUAL: &[Level] = &[
    Level { name: "thread: start, batches, on-board correction", roots: &["Reset"], exception: false },
    Level { name: "priority 3: configuration task", roots: &[HANDLERS[0]], exception: true },
    Level {
        name: "priority 2: tick, configuration UART",
        roots: &[HANDLERS[1], HANDLERS[2], HANDLERS[3]],
        exception: true,
    },
    Level { name: "priority 1: setpoint task", roots: &[HANDLERS[4]], exception: true },
    Level {
        name: "priority 0: setpoint UART, clock",
        roots: &[HANDLERS[5], HANDLERS[6], HANDLERS[7]],
        exception: true,
    },
    WATCHDOG,
    HARD_FAULT,
];
const HANDLERS: [&str; 8] = [
    "truepath_fw::board::virtual_board::interrupts::config_executor",
    "truepath_fw::board::virtual_board::interrupts::timer1",
    "truepath_fw::board::virtual_board::interrupts::config_received",
    "truepath_fw::board::virtual_board::interrupts::config_transmitted",
    "truepath_fw::board::virtual_board::interrupts::setpoint_executor",
    "truepath_fw::board::virtual_board::interrupts::setpoint_received",
    "truepath_fw::board::virtual_board::interrupts::setpoint_transmitted",
    "truepath_fw::board::virtual_board::interrupts::timer0",
];

const NUCLEO_H743: &[Level] = &[
    Level { name: "thread: start, on-board correction", roots: &["Reset"], exception: false },
    Level { name: "priority 10: configuration task", roots: &["UART5"], exception: true },
    Level { name: "priority 9: configuration UART", roots: &["USART3"], exception: true },
    Level { name: "priority 6: setpoint task", roots: &["UART4"], exception: true },
    Level {
        name: "priority 5: setpoint UART, SPI, DMA",
        roots: &["USART6", "DMA1_STREAM0", "DMA1_STREAM1", "DMA1_STREAM2", "DMA1_STREAM3"],
        exception: true,
    },
    Level { name: "priority 0: time", roots: &["TIM5"], exception: true },
    HARD_FAULT,
];

/// What a waker can do.
const WAKER: &[&str] = &["embassy_executor::raw::waker::"];
/// Closures that are told how far an on-board correction is, outermost first.
const TOLD: &[&str] = &["Computation>::run::{closure#0}>::{closure#3}", "Computation>::run::{closure#0}>::{closure#4}"];
/// Of one of the fits under both wall laws.
const LAW: &str = "PredictionWorkspace>::{closure#0}::{closure#0}";
const FIT: &str = ">::settle::<truepath_model::identify::observation::PredictionWorkspace>::{closure#";
const QUIET: &str = ">::fit::<truepath_model::identify::observation::PredictionWorkspace>::{closure#0}";
/// Of a design, which reads the walls in order: under the guard, and of the whole.
const DESIGN: &[&str] =
    &["guarded_design::<truepath_model::correct::reader::InOrder>::{closure#", "whole::designed::{closure#0}"];

/// Components and coordinates of the ratio of an axis.
const RATIOS: &[&str] = &[
    "paper_transfer::{closure#1} as",
    "paper_transfer::{closure#2} as",
    "paper_transfer::{closure#3} as",
    "paper_transfer::{closure#4} as",
];

/// What takes the steps of a program.
const STEPS: &[&str] = &["contour::read::read_contour::{closure#"];

pub const INDIRECT: &[Indirect] = &[
    ("interrupts::config_executor", &["__config_task_task_inner_function::{closure#0}>>::poll"]),
    ("interrupts::setpoint_executor", &["__setpoint_task_task_inner_function::{closure#0}>>::poll"]),
    ("UART5", &["__config_task_task_inner_function::{closure#0}>>::poll"]),
    (
        "UART4",
        &[
            "__setpoint_uart_task_inner_function::{closure#0}>>::poll",
            "__setpoint_spi_task_inner_function::{closure#0}>>::poll",
            "__tick_task_inner_function::{closure#0}>>::poll",
        ],
    ),
    ("__setpoint_uart_task_inner_function", WAKER),
    ("__setpoint_spi_task_inner_function", WAKER),
    ("__tick_task_inner_function", WAKER),
    ("TIM5", WAKER),
    ("USART", WAKER),
    ("embassy_stm32::", WAKER),
    ("_embassy_time_schedule_wake", WAKER),
    ("_defmt_", &["defmt_rtt::channel::Channel>::"]),
    ("__config_task_task_inner_function", WAKER),
    ("__setpoint_task_task_inner_function", WAKER),
    ("uart::Sender", WAKER),
    ("embassy_futures::select", WAKER),
    ("interrupts::config_received", WAKER),
    ("interrupts::config_transmitted", WAKER),
    ("interrupts::setpoint_transmitted", WAKER),
    ("interrupts::timer1", WAKER),
    ("uart::Receiving>::on_received", WAKER),
    ("tasks::background", WAKER),
    (">::linearise", &[FIT]),
    (FIT, &[QUIET, LAW, TOLD[0], TOLD[1]]),
    (LAW, TOLD),
    (
        "correct::design::pass",
        &["design::design::<truepath_model::correct::reader::InOrder>::{closure#0}::{closure#0}"],
    ),
    ("correct::design::design", DESIGN),
    (DESIGN[0], &[DESIGN[1]]),
    (DESIGN[1], TOLD),
    ("uncertainty::spread", &["guard::margins::{closure#", "shrinkage::damp::{closure#"]),
    // A device reads a program for its contour alone.
    ("execute::Execution>::show", STEPS),
    ("execute::Execution>::give", STEPS),
    // A device has no library of other programs.
    ("flow::program::Program>::file", &[]),
    // What an image for size does not put into its callers.
    ("paper_transfer::{closure#0}", RATIOS),
    ("lexical::extent::is_statement::{closure#1}", &["is_statement::{closure#2} as", "is_statement::{closure#3} as"]),
    // The program of a loader begins with a stack of its own.
    ("board::start_program", &[]),
];

/// Recursion on a board, with how often it goes around at the most.
pub const fn recursion(board: Board) -> &'static [Recursion] {
    match board {
        Board::Virtual => &[PANIC, ("unstable::quicksort::quicksort", 18), MEDIAN],
        Board::NucleoH743 => &[PANIC, ("unstable::quicksort::quicksort", 10), MEDIAN],
    }
}

/// A panic within the log of a panic finds the log taken and writes nothing.
const PANIC: Recursion = ("rust_begin_unwind", 1);
/// The median of medians takes an eighth of the probe points each time. (The sort itself, above, stops at twice the
/// binary logarithm of the points a board has room for, 512 and 48: core::slice::sort::unstable::ipnsort.)
const MEDIAN: Recursion = ("median3_rec", 3);
