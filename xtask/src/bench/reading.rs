//! How fast programs are read: ours, the crate `gcode` and LinuxCNC's `rs274` over the same bytes in one run.

use super::table;
use crate::repository::{cargo, read, root, run, target};
use crate::step::{Failure, Outcome, Passed};

/// The document the table is written into.
const DOCUMENT: &str = "docs/measure.md";
/// Words alone: at least as fast as the crate.
const WORDS: [&str; 2] = ["words: truepath-core", "words: gcode 0.7"];
/// Everything: at least ten times as fast as LinuxCNC.
const EVERYTHING: [&str; 2] = ["canonical text: truepath canon", "canonical text: rs274 -g"];

/// Measures and says whether the aims are met; with `write` the table goes into the document.
pub fn measure(write: bool) -> Outcome {
    run(cargo().args(["build", "--quiet", "--release", "--package", "truepath"]))?;
    let binary = target().join("release/truepath");
    let said = read(
        cargo().args(["bench", "--quiet", "--package", "truepath-tests", "--bench", "reading"]).env("TRUEPATH", binary),
    )?;
    let rows: Vec<(String, String)> = said
        .lines()
        .filter_map(|l| l.split_once('\t'))
        .map(|(name, rate)| (name.to_owned(), rate.to_owned()))
        .collect();
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
    if rows.is_empty() {
        return Err(Failure::found("the benchmark printed no rate"));
    }
    if write {
        table::replace(&root().join(DOCUMENT), "reading", &table::table(["reader", "MB/s"], rows))?;
    }
    Ok(Passed::Done)
}
