//! Runs a kernel a given number of times, for a tool that counts instructions: `cargo xtask bench --count`.
//!
//! `count` lists the kernels with their calls and whether they are watched, `count KERNEL N` prepares the kernel and calls it N times. The difference between N and
//! 2N calls is the cost of N calls, without that of the preparation.

#[path = "../benches/kernel/mod.rs"]
mod kernel;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let chosen = arguments.first().and_then(|name| kernel::KERNELS.iter().find(|k| k.name == name));
    let calls = arguments.get(1).and_then(|n| n.parse::<u32>().ok());
    match (arguments.is_empty(), chosen, calls) {
        (true, ..) => {
            for kernel in kernel::KERNELS {
                println!("{} {} {}", kernel.name, kernel.calls, kernel.watched);
            }
            ExitCode::SUCCESS
        }
        (_, Some(kernel), Some(calls)) => {
            let mut work = (kernel.prepare)();
            for _ in 0..calls {
                work();
            }
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("usage: count [KERNEL N]");
            ExitCode::FAILURE
        }
    }
}
