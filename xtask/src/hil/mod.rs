//! The emulated bench: the same runs on the host (with all, also in release) and on the release image in QEMU, compared by
//! digest; a run over the UARTs; what a device with a key refuses; updates of the firmware; the correction made on the device; a short campaign of faults.
//!
//! Nothing here depends on how fast this machine is.

mod bench;
mod campaign;
mod program;

use crate::step::{Outcome, Passed};
use bench::Bench;

pub use campaign::run as campaign;

/// Over the UARTs, frame by frame.
const OVER_UART: [(&str, &[&str]); 2] = [
    ("corner", &["--count", "3000", "--seed", "6"]),
    (
        "pocket",
        &[
            "--random",
            "3000",
            "--seed",
            "7",
            "--drop",
            "0.02",
            "--corrupt",
            "0.05",
            "--reorder",
            "0.02",
            "--repeat",
            "0.02",
        ],
    ),
];

/// The whole bench but the long campaign; when not all is wanted, with a tenth of the setpoints in batches and a quarter of the
/// frames with faults, and without the host's release build and the correction of the pocket, 10 G instructions of the device.
pub fn check(all: bool) -> Outcome {
    let bench = Bench::set_up(all)?;
    let setpoints = bench.equality(if all { 1 } else { 10 })?;
    let release = if all { " = host release" } else { "" };
    println!("{setpoints} setpoints: host debug{release} = emulated release, bit for bit");
    for (part, arguments) in OVER_UART {
        let run = bench.emulated(part, "uart", arguments)?;
        println!("{} setpoints over the UARTs: as the host; {} parts armed", run.setpoints, run.armed);
    }
    // Over the UARTs it is a real link, over the shared memory what the long runs go by.
    for link in ["uart", "bulk"] {
        let (tried, refused) = bench.trust(link)?;
        println!("{tried} images and keys over {link}: {refused} refused, each with its reason");
    }
    let (tried, refused) = bench.update()?;
    println!("{tried} steps of firmware updates: {refused} refused, each with its reason; two confirmed, two undone");
    // Over the UARTs setpoints go on while the device computes.
    let on_board: &[_] = if all { &[("corner", "uart"), ("pocket", "bulk")] } else { &[("corner", "uart")] };
    for &(part, link) in on_board {
        let run = bench.on_board(part, link)?;
        let meanwhile = run.number("setpoints_meanwhile");
        println!("{part}: the image made on the device is the host's; {meanwhile} setpoints answered meanwhile");
    }
    campaign::short(&bench, if all { 1 } else { 4 })?;
    Ok(Passed::Done)
}
