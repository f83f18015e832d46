//! Rates of whole programs over the same bytes in one run, by the benchmarks of `truepath-tests`: how fast programs are read,
//! by ours, the crate `gcode` and LinuxCNC's `rs274`, and how fast five-axis moves are measured, proved and divided.

use crate::repository::{cargo, read, root, run, target};
use crate::step::{Failure, Outcome, Passed};
use crate::table;

/// The document the tables are written into.
const DOCUMENT: &str = "docs/measure.md";
/// Words alone: at least as fast as the crate.
const WORDS: [&str; 2] = ["words: truepath-core", "words: gcode 0.7"];
/// Everything: at least ten times as fast as LinuxCNC.
const EVERYTHING: [&str; 2] = ["canonical text: truepath canon", "canonical text: rs274 -g"];

/// How fast programs are read, and whether the aims are met; with `write` the table goes into the document.
pub fn reading(write: bool) -> Outcome {
    let rows = measured("reading")?;
    for (name, rate) in &rows {
        println!("{name:<36} {rate:>9} MB/s");
    }
    let rate = |name: &str| rows.iter().find(|(n, _)| n == name).and_then(|(_, rate)| rate.parse::<f64>().ok());
    for ([ours, theirs], aim) in [(WORDS, 1.0), (EVERYTHING, 10.0)] {
        match (rate(ours), rate(theirs)) {
            (Some(a), Some(b)) => println!("{ours}: {:.1} times {theirs} (aim {aim})", a / b),
            _ => println!("{ours} beside {theirs}: not measured, one of them is not here"),
        }
    }
    if write {
        table::replace(&root().join(DOCUMENT), "reading", &table::table(["reader", "MB/s"], rows))?;
    }
    Ok(Passed::Done)
}

/// How fast five-axis moves are worked on; with `write` the table goes into the document.
pub fn multiaxis(write: bool) -> Outcome {
    let rows: Vec<(String, String)> =
        measured("multiaxis")?.into_iter().filter_map(|(name, rate)| Some((name, two_digits(&rate)?))).collect();
    for (name, rate) in &rows {
        println!("{name:<44} {rate:>10} moves/s");
    }
    if write {
        table::replace(&root().join(DOCUMENT), "multiaxis", &table::table(["kernel", "moves/s"], rows))?;
    }
    Ok(Passed::Done)
}

/// Runs a benchmark with the release program: what it names, and the rates as it prints them.
pub fn measured(benchmark: &str) -> Result<Vec<(String, String)>, Failure> {
    run(cargo().args(["build", "--quiet", "--release", "--package", "truepath"]))?;
    let binary = target().join("release/truepath");
    let bench = ["bench", "--quiet", "--package", "truepath-tests", "--bench", benchmark];
    let said = read(cargo().args(bench).env("TRUEPATH", binary))?;
    let rows: Vec<(String, String)> = said
        .lines()
        .filter_map(|line| line.split_once('\t'))
        .map(|(name, rate)| (name.to_owned(), rate.to_owned()))
        .collect();
    if rows.is_empty() { Err(Failure::found("the benchmark printed no rate")) } else { Ok(rows) }
}

/// A rate to two digits: more do not repeat.
fn two_digits(rate: &str) -> Option<String> {
    let rate: f64 = rate.trim().parse().ok()?;
    let unit = 10f64.powf((rate.max(1.0).log10() - 1.0).floor());
    Some(table::thousands(((rate / unit).round() * unit) as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_rounded_to_two_digits() {
        assert_eq!(two_digits("1584321"), Some(table::thousands(1_600_000)));
        assert_eq!(two_digits("95100"), Some(table::thousands(95_000)));
        assert_eq!(two_digits("moves"), None);
    }
}
