//! Proofs on the linked firmware: what the setpoint path holds, how deep the stack goes.

mod graph;
mod priorities;
mod realtime;
mod registers;
mod stack;
mod thumb;

use graph::Graph;
use priorities::{INDIRECT, levels, loader_levels, recursion};
use stack::{Level, Search};

use super::document;
use super::image::{Board, Image};
use crate::step::{Failure, Outcome, Passed};
use crate::table::thousands;
use crate::toolchain::Toolchain;

/// What has to stay free of the room of a stack: for what no proof knows, and for a compiler that makes larger frames.
const SPARE_PERCENT: u32 = 25;

/// Proves both, the stack of every image of these boards; with `write` it goes into the document.
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
        let images = [
            ("", board.image(), levels(board)),
            (", updatable", board.updatable(), levels(board)),
            (", loader", board.loader(), loader_levels(board)),
        ];
        for (kind, image, levels) in images {
            let name = format!("{}{kind}", board.name());
            let (new, doubts) = stack_of(board, &name, image, levels, &toolchain)?;
            rows.extend(new);
            said.extend(doubts.into_iter().map(|doubt| format!("{name}: {doubt}")));
        }
    }
    if !said.is_empty() {
        return Err(Failure::found(said.join("\n")));
    }
    document::settle("stack", &["image, priority", "bytes"], &rows, &toolchain.version()?, write)?;
    Ok(Passed::Done)
}

/// The rows of an image of a board, and what is wrong with its stack.
fn stack_of(
    board: Board,
    name: &str,
    image: Image,
    levels: &[Level],
    toolchain: &Toolchain,
) -> Result<(Vec<Vec<String>>, Vec<String>), Failure> {
    let elf = image.build(toolchain)?;
    let graph = Graph::read(&elf)?;
    let mut search = Search::new(&graph, INDIRECT, recursion(board));
    let row = |part: &str, bytes: u32| vec![format!("{name}: {part}"), thousands(bytes.into())];
    let mut rows = Vec::new();
    let mut total = 0;
    println!("{name}");
    for level in levels {
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
    said.extend(too_deep(total, room));
    Ok((rows, said))
}

/// What is wrong with a stack that takes so many bytes at most and has so much room: a share of it has to stay free.
fn too_deep(total: u32, room: u32) -> Option<String> {
    let most = room / 100 * (100 - SPARE_PERCENT);
    let found = || format!("the stack may take {total} bytes of {room}; {SPARE_PERCENT} % have to stay free ({most})");
    (total > most).then(found)
}

/// Bytes between the statics and the end of RAM.
fn room(graph: &Graph) -> Result<u32, Failure> {
    let symbol =
        |name: &str| graph.symbols.get(name).copied().ok_or_else(|| Failure::found(format!("no symbol {name}")));
    Ok(symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_that_leaves_less_than_its_spare_room_is_refused() {
        assert_eq!(too_deep(75_000, 100_000), None);
        let said = too_deep(75_001, 100_000).unwrap();
        assert!(said.contains("75001 bytes of 100000") && said.contains("25 %"), "{said}");
        assert!(too_deep(u32::MAX, 112_456).is_some() && too_deep(1, 0).is_some());
    }
}
