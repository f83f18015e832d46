//! Proofs on the linked firmware: what the setpoint path holds, how deep the stack goes.

mod graph;
mod priorities;
mod realtime;
mod stack;
mod thumb;

use graph::Graph;
use priorities::{INDIRECT, levels, recursion};
use stack::Search;

use super::document;
use super::image::Board;
use crate::step::{Failure, Outcome, Passed};
use crate::table::thousands;
use crate::toolchain::Toolchain;

/// Proves both, the stack for these boards; with `write` it goes into the document.
pub fn check(boards: &[Board], write: bool) -> Outcome {
    let toolchain = Toolchain::find()?;
    let functions = realtime::check(&toolchain)?;
    println!(
        "setpoint path: {functions} functions, no panic, no soft float, no division call, no formatting, no call through \
         a register"
    );
    let mut rows = Vec::new();
    let mut said = Vec::new();
    for &board in boards {
        let (new, doubts) = stack_of(board, &toolchain)?;
        rows.extend(new);
        said.extend(doubts.into_iter().map(|doubt| format!("{}: {doubt}", board.name())));
    }
    if !said.is_empty() {
        return Err(Failure::found(said.join("\n")));
    }
    document::settle("stack", &["board, priority", "bytes"], &rows, &toolchain.version()?, write)?;
    Ok(Passed::Done)
}

/// The rows of a board, and what is wrong with its stack.
fn stack_of(board: Board, toolchain: &Toolchain) -> Result<(Vec<Vec<String>>, Vec<String>), Failure> {
    let elf = board.image().build(toolchain)?;
    let graph = Graph::read(&elf)?;
    let mut search = Search::new(&graph, INDIRECT, recursion(board));
    let row = |name: &str, bytes: u32| vec![format!("{}: {name}", board.name()), thousands(bytes.into())];
    let mut rows = Vec::new();
    let mut total = 0;
    println!("{}", board.name());
    for level in levels(board) {
        let depth = search.level(level);
        println!("  {:<46} {:>8} bytes", level.name, thousands(depth.bytes.into()));
        depth.way.iter().for_each(|step| println!("      {step}"));
        total += depth.bytes;
        rows.push(row(level.name, depth.bytes));
    }
    let room = room(&graph)?;
    rows.extend([row("**all of them at once**", total), row("room between statics and end of RAM", room)]);
    println!("  {:<46} {:>8} of {} bytes", "all of them at once", thousands(total.into()), thousands(room.into()));
    let mut said = search.doubts;
    said.sort();
    said.dedup();
    if total > room {
        said.push(format!("the stack may take {total} bytes and has {room}"));
    }
    Ok((rows, said))
}

/// Bytes between the statics and the end of RAM.
fn room(graph: &Graph) -> Result<u32, Failure> {
    let symbol =
        |name: &str| graph.symbols.get(name).copied().ok_or_else(|| Failure::found(format!("no symbol {name}")));
    Ok(symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?))
}
