//! What the setpoint path costs, in instructions, counted by an emulator that counts.
//!
//! `cargo xtask budget` runs this under `qemu-system-arm -icount shift=10,sleep=off`: one instruction is then 1,024 ns
//! of the 25 MHz timer, so two readings tell the instructions between them to one. Each measured part is a call that is
//! not inlined; what an empty one costs is taken off. The numbers are instructions and not cycles, and they repeat
//! exactly.
//!
//! One line for each series on UART 0: `axes nodes what part least median greatest`, then `end`.
#![no_std]
#![no_main]

#[path = "budget/machine.rs"]
mod machine;
#[path = "budget/measure.rs"]
mod measure;
#[path = "budget/script.rs"]
mod script;

use core::fmt::Write as _;

use machine::Machine;
use measure::{Console, Series, Situation};
use script::run;

/// Nodes of the contours; the costs must not depend on them.
const CONTOURS: [usize; 3] = [10, 100, 10_000];

#[cortex_m_rt::entry]
fn main() -> ! {
    measure::start();
    let mut console = Console::open();
    for (axes, nodes) in [(3, CONTOURS[0]), (3, CONTOURS[1]), (3, CONTOURS[2]), (6, CONTOURS[2])] {
        let mut series = Series::all();
        let mut machine = Machine::new(axes, nodes);
        run(&mut machine, nodes, &mut series);
        for (situation, parts) in Situation::ALL.into_iter().zip(series.iter_mut()) {
            for (name, samples) in parts.named() {
                if let Some((least, median, greatest)) = samples.summary() {
                    let _ = writeln!(console, "{axes} {nodes} {} {name} {least} {median} {greatest}", situation.name());
                }
            }
        }
    }
    let _ = writeln!(console, "end");
    cortex_m::peripheral::SCB::sys_reset()
}
