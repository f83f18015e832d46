//! The campaign of faults: many frames with each kind of fault on the emulated board, and what became of them.
//!
//! Every answer is compared and judged by `truepath hil` itself, which fails at the first that is wrong; the table here
//! tells how much was tried. The long campaign goes on until each kind was injected 10⁵ times; its result is committed.

use std::fmt::Write;

use super::bench::Bench;
use super::program::Run;
use crate::repository::{program as command, read, root};
use crate::step::{Failure, Outcome, Passed};

/// A kind of fault.
struct Kind {
    name: &'static str,
    /// Options of `truepath hil`.
    options: &'static [&'static str],
    /// Key of what was injected; none counts every frame.
    injected: Option<&'static str>,
    /// Frames for 10⁵ faults.
    frames: u64,
}

const KINDS: [Kind; 7] = [
    Kind { name: "lost", options: &["--drop", "0.1"], injected: Some("dropped"), frames: 1_050_000 },
    Kind { name: "damaged", options: &["--corrupt", "0.1"], injected: Some("corrupted"), frames: 1_050_000 },
    Kind { name: "overtaken", options: &["--reorder", "0.15"], injected: Some("reordered"), frames: 1_050_000 },
    Kind { name: "repeated", options: &["--repeat", "0.1"], injected: Some("repeated"), frames: 1_050_000 },
    Kind { name: "late by jitter", options: &["--jitter", "15000"], injected: None, frames: 200_000 },
    Kind { name: "pause", options: &["--pause", "0.005"], injected: Some("pauses"), frames: 200_000 },
    Kind {
        name: "all at once",
        options: &[
            "--drop",
            "0.05",
            "--corrupt",
            "0.05",
            "--reorder",
            "0.05",
            "--repeat",
            "0.05",
            "--pause",
            "0.0005",
            "--jitter",
            "500",
        ],
        injected: None,
        frames: 500_000,
    },
];
/// Frames of each kind in the short campaign.
const SHORT: u64 = 20_000;
/// Frames of each kind over the UARTs.
const UART: u64 = 2_000;
const DOCUMENT: &str = "docs/campaign.md";

/// The short campaign, or a part of it.
pub fn short(bench: &Bench, part: u64) -> Result<(), Failure> {
    print!("{}", table(bench, "bulk", |_| SHORT / part)?);
    Ok(())
}

/// The long campaign, written into the document.
pub fn run() -> Outcome {
    let bench = Bench::set_up(false)?;
    let commit = read(command("git").args(["rev-parse", "--short=12", "HEAD"]))?;
    let changed =
        !read(command("git").args(["status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs/campaign.md"]))?
            .trim()
            .is_empty();
    let bulk = table(&bench, "bulk", |kind| kind.frames)?;
    let uart = table(&bench, "uart", |_| UART)?;
    let commit = format!("{}{}", commit.trim(), if changed { " with changes not committed" } else { "" });
    let text = format!(
        "# Campaign of faults\n\n\
         Made by `cargo xtask campaign` on commit {commit}. Each row is one run of `truepath hil --board virtual`: the\n\
         release firmware in QEMU, a part milled again and again with disturbances ([bench.md](bench.md)), and one kind of\n\
         fault on the cable. Every answer was the host's, byte for byte, and kept every rule of the judge: no answer to\n\
         a frame that did not arrive whole, position = setpoint + correction, correction within clamp and limits of speed\n\
         and acceleration, modes as the safety contract says. After every fault that ended an arming, the device was\n\
         acknowledged or armed again, as it documents; `armed` tells how often.\n\n\
         ## Batches in shared memory\n\n{bulk}\n\
         ## Frame by frame over the UARTs\n\n\
         Deadline and silence are as long as they may be here, because QEMU's clock is that of a busy machine; a pause\n\
         therefore is none, and jitter only spreads the frames. The setpoint rate is set to 20,000 Hz, which no UART\n\
         reaches: no burst is then faster than the device permits, and a part takes twenty times as many setpoints.\n\n{uart}"
    );
    std::fs::write(root().join(DOCUMENT), text).map_err(|e| Failure::found(format!("{DOCUMENT}: {e}")))?;
    Ok(Passed::Done)
}

/// Runs every kind; a table of what came of it.
fn table(bench: &Bench, link: &str, frames: impl Fn(&Kind) -> u64) -> Result<String, Failure> {
    let mut text = String::from(
        "| fault | frames | injected | answers | Active | Fault | Off | armed | largest correction mm | digest |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---|\n",
    );
    for (seed, kind) in KINDS.iter().enumerate() {
        let (count, seed) = (frames(kind).to_string(), (101 + seed).to_string());
        let run = bench.emulated("corner", link, &[&["--random", &count, "--seed", &seed], kind.options].concat())?;
        let injected = kind.injected.map_or("every frame".to_owned(), |key| run.number(key).to_string());
        let [off, _, _, active, _, fault] = modes(&run);
        eprintln!("    {:<15} {} frames over {link}: {} answers as the host", kind.name, run.setpoints, run.answers);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {injected} | {} | {active} | {fault} | {off} | {} | {} | {} |",
            kind.name,
            run.setpoints,
            run.answers,
            run.armed,
            largest(&run),
            run.digest
        );
    }
    Ok(text)
}

/// Answers by mode.
fn modes(run: &Run) -> [u64; 6] {
    let list = run.json.split_once("\"modes\":").and_then(|(_, behind)| behind.split(['[', ']']).nth(1));
    let mut numbers = list.unwrap_or_default().split(',').map(|n| n.trim().parse().unwrap_or(0));
    [0; 6].map(|_: u64| numbers.next().unwrap_or(0))
}

/// The largest correction as the report has it.
fn largest(run: &Run) -> &str {
    let behind = run.json.split_once("\"max_correction_mm\":").map_or("", |(_, behind)| behind);
    behind.split([',', '}', '\n']).next().unwrap_or_default().trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_and_largest_correction_are_read_from_the_report() {
        let json =
            "{\n  \"modes\": [\n    1,\n    2,\n    3,\n    4,\n    5,\n    6\n  ],\n  \"max_correction_mm\": 0.25\n}";
        let run = Run { setpoints: 0, answers: 0, armed: 0, digest: String::new(), json: json.to_owned() };
        assert_eq!((modes(&run), largest(&run)), ([1, 2, 3, 4, 5, 6], "0.25"));
    }
}
