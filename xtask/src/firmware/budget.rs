//! What the setpoint path costs, in instructions, against the committed budget.
//!
//! The image `budget`, built in both ways that a program is, runs under an emulator that counts (`-icount`): the numbers
//! repeat exactly with the same compiler. `firmware/budget.toml` holds the greatest permitted count of each part; `--write` renews it and the table in the
//! document.

use std::collections::BTreeMap;
use std::time::Duration;

use super::emulator;
use super::image::Image;
use super::{document, rate};
use crate::repository::{read, root};
use crate::step::{Failure, Outcome, Passed};
use crate::table::thousands;
use crate::toolchain::Toolchain;

/// The committed budget.
const FILE: &str = "firmware/budget.toml";
/// As a program that starts by itself is built, whose costs the document has, and as an updatable one is.
const IMAGES: [(&str, Image); 2] =
    [("as a program that starts by itself", image(false)), ("as an updatable program", image(true))];

/// The emulator's time limit; a run takes a second.
const LIMIT: Duration = Duration::from_secs(120);

const fn image(for_size: bool) -> Image {
    Image { bin: "budget", features: "board-virtual,proof", for_size }
}

/// A series: axes and nodes, situation, part.
pub type Key = (u32, u32, String, String);

/// Instructions of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// The cheapest call.
    pub least: u32,
    /// The middle one.
    pub median: u32,
    /// The dearest one.
    pub greatest: u32,
}

/// Measures, and compares with the budget or renews it.
pub fn check(write: bool) -> Outcome {
    let toolchain = Toolchain::find()?;
    let compiler = toolchain.version()?;
    let mut most = BTreeMap::new();
    for (name, image) in IMAGES {
        let costs = counted(image, &toolchain)?;
        println!("{name}");
        print(&costs);
        let worst = worst(&costs);
        if !image.for_size {
            document::settle("cost", &HEAD, &rows(&costs), &compiler, write)?;
            document::settle("rate", &rate::HEAD, &rate::rows(&worst), &compiler, write)?;
        }
        for (part, counted) in worst {
            let entry = most.entry(part).or_default();
            *entry = counted.max(*entry);
        }
    }
    if write {
        std::fs::write(root().join(FILE), budget(&most, &compiler))
            .map_err(|e| Failure::found(format!("{FILE}: {e}")))?;
    } else {
        compare(&most, &compiler)?;
    }
    Ok(Passed::Done)
}

/// Builds an image and counts its parts.
fn counted(image: Image, toolchain: &Toolchain) -> Result<BTreeMap<Key, Cost>, Failure> {
    let elf = image.build(toolchain)?;
    let mut command = emulator::command()?;
    command.args(["-no-reboot", "-icount", "shift=10,sleep=off", "-serial", "stdio"]);
    command.args(["-serial", "null", "-serial", "null", "-serial", "null", "-kernel"]).arg(&elf);
    let mut limited = crate::repository::program("timeout");
    limited.arg(LIMIT.as_secs().to_string()).arg(command.get_program()).args(command.get_args());
    costs(&read(&mut limited)?)
}

const HEAD: [&str; 5] = [
    "axes, nodes, situation",
    "tick, least … median",
    "tick, greatest",
    "whole exchange (UART)",
    "whole exchange (SPI)",
];

/// Tick and whole exchange by situation, for the document.
fn rows(costs: &BTreeMap<Key, Cost>) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for ((axes, nodes, situation, _), tick) in costs.iter().filter(|((.., part), _)| part == "tick") {
        let of = |part: &str| {
            let key = (*axes, *nodes, situation.clone(), part.to_owned());
            costs.get(&key).map_or_else(String::new, |cost| thousands(cost.greatest.into()))
        };
        let name = format!("{axes}, {}, {situation}", thousands((*nodes).into()));
        let range = format!("{} … {}", thousands(tick.least.into()), thousands(tick.median.into()));
        rows.push(vec![name, range, of("tick"), of("exchange"), of("spi")]);
    }
    rows
}

fn print(costs: &BTreeMap<Key, Cost>) {
    println!(
        "{:<5} {:>6} {:<11} {:<9} {:>7} {:>7} {:>8}",
        "axes", "nodes", "situation", "part", "least", "median", "greatest"
    );
    for ((axes, nodes, situation, part), cost) in costs {
        let Cost { least, median, greatest } = cost;
        println!("{axes:<5} {nodes:>6} {situation:<11} {part:<9} {least:>7} {median:>7} {greatest:>8}");
    }
}

/// The lines of the image.
fn costs(said: &str) -> Result<BTreeMap<Key, Cost>, Failure> {
    if said.lines().next_back().map(str::trim) != Some("end") {
        return Err(Failure::found(format!("the measurement did not end:\n{said}")));
    }
    let parsed = said.lines().filter(|line| line.trim() != "end").map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [axes, nodes, situation, part, least, median, greatest] = words[..] else { return None };
        let number = |word: &str| word.parse::<u32>().ok();
        let key = (number(axes)?, number(nodes)?, situation.to_owned(), part.to_owned());
        Some((key, Cost { least: number(least)?, median: number(median)?, greatest: number(greatest)? }))
    });
    parsed.collect::<Option<_>>().ok_or_else(|| Failure::found(format!("not a table of costs:\n{said}")))
}

/// The greatest count of each part over all situations, by axes and nodes: `3-axes-10-nodes.tick`.
pub fn worst(costs: &BTreeMap<Key, Cost>) -> BTreeMap<String, u32> {
    let mut worst = BTreeMap::new();
    for ((axes, nodes, _, part), cost) in costs {
        let entry = worst.entry(format!("{axes}-axes-{nodes}-nodes.{part}")).or_default();
        *entry = cost.greatest.max(*entry);
    }
    worst
}

fn budget(worst: &BTreeMap<String, u32>, compiler: &str) -> String {
    let mut text = format!(
        "# Most instructions of each part of the setpoint path on the emulated Cortex-M7, over all situations.\n\
         # Renewed by `cargo xtask budget --write`, enforced by `cargo xtask budget`.\ncompiler = \"{compiler}\"\n"
    );
    for (name, most) in worst {
        text += &format!("{name} = {most}\n");
    }
    text
}

/// More than the budget is a finding, with any compiler: the numbers are the promise.
fn compare(worst: &BTreeMap<String, u32>, compiler: &str) -> Result<(), Failure> {
    let text = std::fs::read_to_string(root().join(FILE)).map_err(|e| Failure::found(format!("{FILE}: {e}")))?;
    let mut said = exceeded(worst, &text);
    if !text.contains(&format!("compiler = \"{compiler}\"")) {
        eprintln!("    {FILE} was measured with another compiler than {compiler}");
        // Another compiler may be a little better or worse.
        said.retain(|(_, counted, most)| u64::from(*counted) * 100 > u64::from(*most) * 110);
    }
    let lines: Vec<String> =
        said.iter().map(|(name, counted, most)| format!("{name}: {counted} instructions, budget {most}")).collect();
    if lines.is_empty() { Ok(()) } else { Err(Failure::found(lines.join("\n"))) }
}

/// Parts that cost more than the budget says, or that it does not name.
fn exceeded(worst: &BTreeMap<String, u32>, text: &str) -> Vec<(String, u32, u32)> {
    let most = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
        line.and_then(|number| number.trim().parse::<u32>().ok()).unwrap_or(0)
    };
    let all = worst.iter().map(|(name, &counted)| (name.clone(), counted, most(name)));
    all.filter(|(_, counted, most)| counted > most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAID: &str = "3 10 feed tick 100 110 120\n3 10 hold tick 90 100 130\n3 10 feed spi 300 310 320\nend\n";

    #[test]
    fn the_worst_situation_of_a_part_is_its_cost() {
        let worst = worst(&costs(SAID).unwrap());
        assert_eq!(worst["3-axes-10-nodes.tick"], 130);
        assert_eq!(worst["3-axes-10-nodes.spi"], 320);
    }

    #[test]
    fn a_run_that_did_not_end_is_no_measurement() {
        assert!(costs("3 10 feed tick 100 110 120\n").is_err());
        assert!(costs("panic\nend\n").is_err());
    }

    #[test]
    fn one_instruction_more_than_the_budget_and_a_part_without_one_are_found() {
        let counted = worst(&costs(SAID).unwrap());
        let mut text = budget(&counted, "1.96.0");
        assert_eq!(exceeded(&counted, &text), []);
        text = text.replace("tick = 130", "tick = 129").replace("3-axes-10-nodes.spi = 320\n", "");
        let said = exceeded(&counted, &text);
        assert_eq!(said, [("3-axes-10-nodes.spi".to_owned(), 320, 0), ("3-axes-10-nodes.tick".to_owned(), 130, 129)]);
    }
}
