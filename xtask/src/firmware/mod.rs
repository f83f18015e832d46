//! The firmware: its images, their sizes, proofs and costs.

pub mod budget;
mod document;
pub mod elf;
pub mod emulator;
mod flat;
mod image;
pub mod linker;
mod rate;
mod sizes;

pub use image::Board;
use sizes::Sizes;

use crate::step::{Outcome, Passed};
use crate::table::thousands;
use crate::toolchain::{TARGET, Toolchain};

/// Builds the images of boards, prints their sizes and compares them with the document, or writes them there.
pub fn build(boards: &[Board], write: bool) -> Outcome {
    let toolchain = Toolchain::find()?;
    eprintln!("    {TARGET} by {}", toolchain.describe());
    let mut rows = Vec::new();
    println!("{:<14} {:>10} {:>10} {:>10} {:>10} {:>10}", "board", "text", "data", "bss", "flash", "RAM");
    for &board in boards {
        let elf = board.image().build(&toolchain)?;
        let sizes = Sizes::read(&elf)?;
        let numbers = [sizes.text, sizes.data, sizes.bss, sizes.flash(), sizes.ram()].map(thousands);
        let [text, data, bss, flash, ram] = &numbers;
        println!("{:<14} {text:>10} {data:>10} {bss:>10} {flash:>10} {ram:>10}  {}", board.name(), elf.display());
        rows.push([vec![board.name().to_owned()], numbers.to_vec()].concat());
        if board == Board::NucleoH743 {
            // Its flash is what an updatable program hardly fits; that of the virtual board is built where it runs.
            let updatable = board.updatable().build_flat(&toolchain)?.with_extension("");
            for (name, elf) in [("updatable", updatable), ("its loader", board.loader().build(&toolchain)?)] {
                println!("{name:<14} {:>10}  {}", thousands(Sizes::read(&elf)?.flash()), elf.display());
            }
        }
    }
    let head = ["board", "text", "data", "bss", "flash", "RAM"];
    document::settle("sizes", &head, &rows, &toolchain.version()?, write)?;
    Ok(Passed::Done)
}
