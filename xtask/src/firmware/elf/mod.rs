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

const INDIRECT: &[Indirect] = &[];
const RECURSION: &[Recursion] = &[];

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
