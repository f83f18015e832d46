//! How fast five-axis moves are measured, proved and divided, and the command that does it to a program.

use super::table;
use crate::repository::{cargo, read, root, run, target};
use crate::step::{Failure, Outcome, Passed};

/// The document the table is written into.
const DOCUMENT: &str = "docs/measure.md";

/// Measures; with `write` the table goes into the document.
pub fn measure(write: bool) -> Outcome {
    run(cargo().args(["build", "--quiet", "--release", "--package", "truepath"]))?;
    let binary = target().join("release/truepath");
    let said = read(
        cargo()
            .args(["bench", "--quiet", "--package", "truepath-tests", "--bench", "multiaxis"])
            .env("TRUEPATH", binary),
    )?;
    let rows: Vec<(String, String)> = said.lines().filter_map(row).collect();
    if rows.is_empty() {
        return Err(Failure::found("the benchmark printed no rate"));
    }
    for (name, rate) in &rows {
        println!("{name:<44} {rate:>10} moves/s");
    }
    if write {
        table::replace(&root().join(DOCUMENT), "multiaxis", &table::table(["kernel", "moves/s"], rows))?;
    }
    Ok(Passed::Done)
}

/// A kernel and its moves a second, to two digits: more do not repeat.
fn row(line: &str) -> Option<(String, String)> {
    let (name, rate) = line.split_once('\t')?;
    let rate: f64 = rate.trim().parse().ok()?;
    let unit = 10f64.powf((rate.max(1.0).log10() - 1.0).floor());
    Some((name.to_owned(), table::thousands(((rate / unit).round() * unit) as u64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_read_and_rounded_to_two_digits() {
        assert_eq!(row("closed form\t1584321"), Some(("closed form".into(), table::thousands(1_600_000))));
        assert_eq!(row("x\t95100"), Some(("x".into(), table::thousands(95_000))));
        assert_eq!(row("20000 moves"), None);
    }
}
