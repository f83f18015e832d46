//! Time and instructions of the kernels of the core.
//!
//! Time (criterion) depends on the machine and what else runs on it; instructions (callgrind) are those of an x86-64
//! release build and are the same on every repeat. Neither is a number of cycles on a microcontroller.

pub mod long;
pub mod rates;
pub mod table;

use std::process::{Child, Command, Stdio};

use crate::repository::{cargo, program, read, root, run, succeeds, target};
use crate::step::{Failure, Outcome, Passed};

/// The document the tables are written into.
const DOCUMENT: &str = "docs/measure.md";

/// Time of the kernels, by criterion. With `write` the medians go into the document.
pub fn time(no_run: bool, write: bool, arguments: &[String]) -> Outcome {
    let mut command = cargo();
    command.args(["bench", "--package", "truepath-core", "--benches"]);
    if no_run {
        command.arg("--no-run");
    } else {
        command.arg("--").args(arguments);
    }
    run(&mut command)?;
    if no_run {
        build_counter()?;
    }
    if write {
        let rows = kernels()?.into_iter().filter_map(|(name, _)| {
            // Criterion keeps its results in a folder named like the benchmark.
            let folder = target().join("criterion").join(name.replace('/', "_"));
            let estimates = std::fs::read_to_string(folder.join("new/estimates.json")).ok()?;
            Some((name, table::nanoseconds(median(&estimates)?)))
        });
        let text = table::table(["kernel / part", "time per call"], rows);
        table::replace(&root().join(DOCUMENT), "time", &text)?;
    }
    Ok(Passed::Done)
}

/// Instructions of the kernels, by callgrind: the difference between N and 2N calls, over N. With `write` the table
/// goes into the document.
pub fn count(write: bool) -> Outcome {
    if !succeeds(program("valgrind").arg("--version")) {
        return Err(Failure::Missing("instructions are counted by valgrind: apt-get install valgrind".into()));
    }
    let mut rows = Vec::new();
    println!("{:<24} {:>16}", "kernel / part", "instructions");
    for (name, calls) in kernels()? {
        // Both runs at once: most of their time is the preparation.
        let (once, twice) = (counted(&name, calls)?, counted(&name, 2 * calls)?);
        let (once, twice) = (collected(once)?, collected(twice)?);
        let each = twice.saturating_sub(once) as f64 / f64::from(calls);
        let shown = table::thousands(each.round() as u64);
        println!("{name:<24} {shown:>16}");
        rows.push((name, shown));
    }
    if write {
        let text = table::table(["kernel / part", "instructions per call"], rows);
        table::replace(&root().join(DOCUMENT), "instructions", &text)?;
    }
    Ok(Passed::Done)
}

/// Builds the counter and asks it for its kernels and the calls each needs.
fn kernels() -> Result<Vec<(String, u32)>, Failure> {
    build_counter()?;
    let said = read(&mut counter())?;
    let kernels: Vec<_> = said
        .lines()
        .filter_map(|line| {
            let (name, calls) = line.split_once(' ')?;
            Some((name.to_owned(), calls.parse().ok()?))
        })
        .collect();
    if kernels.is_empty() { Err(Failure::found("the counter knows no kernels")) } else { Ok(kernels) }
}

fn build_counter() -> Result<(), Failure> {
    run(cargo().args(["build", "--package", "truepath-core", "--release", "--example", "count"]))
}

fn counter() -> Command {
    program(target().join("release/examples/count"))
}

fn counted(kernel: &str, calls: u32) -> Result<Child, Failure> {
    program("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(counter().get_program())
        .arg(kernel)
        .arg(calls.to_string())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| Failure::Missing(format!("valgrind cannot be started: {e}")))
}

fn collected(child: Child) -> Result<u64, Failure> {
    let output = child.wait_with_output().map_err(|e| Failure::found(e.to_string()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    instructions(&said).ok_or_else(|| Failure::found(format!("callgrind said:\n{said}")))
}

/// The number in callgrind's closing line `==123== Collected : 456`.
fn instructions(said: &str) -> Option<u64> {
    said.lines().rev().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

/// The median of criterion's estimates, ns.
fn median(estimates: &str) -> Option<f64> {
    let (_, behind) = estimates.split_once("\"median\":")?;
    let (_, behind) = behind.split_once("\"point_estimate\":")?;
    behind.split([',', '}']).next()?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn callgrinds_count_is_read() {
        let said = "==7== Events    : Ir\n==7== Collected : 123456\n==7== \n==7== I   refs:      123,456\n";
        assert_eq!(instructions(said), Some(123_456));
        assert_eq!(instructions("==7== Process terminating"), None);
    }

    #[test]
    fn the_median_of_criterions_estimates_is_read() {
        let estimates = r#"{"mean":{"point_estimate":9.0},"median":{"confidence_interval":{"confidence_level":0.95,"lower_bound":1.0},"point_estimate":41.5,"standard_error":0.1}}"#;
        assert_eq!(median(estimates), Some(41.5));
    }
}
