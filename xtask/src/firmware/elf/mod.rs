//! Proofs on the linked firmware: what the setpoint path holds, how deep the stack goes.

mod graph;
mod realtime;
mod stack;
mod thumb;

use graph::Graph;
use stack::{Indirect, Level, Recursion, Search};

use super::document;
use super::image::{Board, Image};
use crate::bench::table::thousands;
use crate::step::{Failure, Outcome, Passed};
use crate::toolchain::Toolchain;

/// Priorities of the virtual board, from the thread up; see its `interrupts.rs`.
const LEVELS: [Level; 7] = [
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
    Level { name: "watchdog", roots: &["NonMaskableInt"], exception: true },
    Level { name: "hard fault", roots: &["HardFault"], exception: true },
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

/// What a waker can do.
const WAKER: &[&str] = &["embassy_executor::raw::waker::"];
/// Closures that are told how far an on-board correction is, outermost first.
const TOLD: &[&str] = &["Work>::run::{closure#0}>::{closure#2}", "Work>::run::{closure#0}>::{closure#3}"];
const TOLD_OF_A_LAW: &[&str] = &["identified::{closure#0}>::{closure#0}::{closure#0}", TOLD[0], TOLD[1]];
const FIT: &str = "identify_observed::<truepath_core::job::identification::identified::{closure#0}>::{closure#";

const INDIRECT: &[Indirect] = &[
    ("interrupts::config_executor", &["__config_task_task_inner_function::{closure#0}>>::poll"]),
    ("interrupts::setpoint_executor", &["__setpoint_task_task_inner_function::{closure#0}>>::poll"]),
    ("__config_task_task_inner_function", WAKER),
    ("__setpoint_task_task_inner_function", WAKER),
    ("uart::Uart as embedded_io_async", WAKER),
    ("embassy_futures::select", WAKER),
    ("interrupts::config_received", WAKER),
    ("interrupts::config_transmitted", WAKER),
    ("interrupts::setpoint_transmitted", WAKER),
    ("interrupts::timer1", WAKER),
    ("uart::Receiving>::on_received", WAKER),
    ("background::run", WAKER),
    (">::linearise", &[FIT]),
    (FIT, TOLD_OF_A_LAW),
    (TOLD_OF_A_LAW[0], TOLD),
    ("design_observed", TOLD),
];

const RECURSION: &[Recursion] = &[
    // A panic within the log of a panic finds the log taken and writes nothing.
    ("rust_begin_unwind", 1),
    // Sorting of at most 512 probe points: the standard library stops at twice the binary logarithm.
    ("unstable::quicksort::quicksort", 18),
    // The median of medians takes an eighth of the points each time.
    ("median3_rec", 3),
];

/// Proves both; with `write` the stack goes into the document.
pub fn check(write: bool) -> Outcome {
    let toolchain = Toolchain::find()?;
    let functions = realtime::check(&toolchain)?;
    println!(
        "setpoint path: {functions} functions, no panic, no soft float, no division call, no formatting, no call through a register"
    );
    let Image { features, bin } = Board::Virtual.image();
    let extra = ["-Zemit-stack-sizes", "-Clink-arg=-Tstack-sizes.x"];
    let elf = Image { features, bin }.build(&toolchain, &extra)?;
    let graph = Graph::read(&elf)?;
    let mut search = Search::new(&graph, INDIRECT, RECURSION);
    let mut rows = Vec::new();
    let mut total = 0;
    for level in &LEVELS {
        let depth = search.level(level);
        println!("{:<46} {:>8} bytes", level.name, thousands(depth.bytes.into()));
        depth.way.iter().for_each(|step| println!("    {step}"));
        total += depth.bytes;
        rows.push(vec![level.name.to_owned(), thousands(depth.bytes.into())]);
    }
    let room = room(&graph)?;
    rows.push(vec!["all of them at once".to_owned(), thousands(total.into())]);
    rows.push(vec!["room between statics and end of RAM".to_owned(), thousands(room.into())]);
    println!("{:<46} {:>8} of {} bytes", "all of them at once", thousands(total.into()), thousands(room.into()));
    if !search.doubts.is_empty() {
        search.doubts.sort();
        search.doubts.dedup();
        return Err(Failure::found(search.doubts.join("\n")));
    }
    if total > room {
        return Err(Failure::found(format!("the stack may take {total} bytes and has {room}")));
    }
    document::settle("stack", &["virtual board", "bytes"], &rows, &toolchain.version()?, write)?;
    Ok(Passed::Done)
}

/// Bytes between the statics and the end of RAM.
fn room(graph: &Graph) -> Result<u32, Failure> {
    let symbol =
        |name: &str| graph.symbols.get(name).copied().ok_or_else(|| Failure::found(format!("no symbol {name}")));
    Ok(symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?))
}
