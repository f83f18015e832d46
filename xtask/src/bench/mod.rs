//! Time and instructions of the kernels of the core.
//!
//! Time (criterion) depends on the machine and what else runs on it; instructions (cachegrind) are those of an x86-64
//! release build and are the same on every repeat. Neither is a number of cycles on a microcontroller.

pub mod long;
pub mod peers;
pub mod rates;

use std::process::{Child, Command, Stdio};

use crate::repository::{cargo, program, read, root, run, succeeds, target};
use crate::step::{Failure, Outcome, Passed};
use crate::table;
use crate::toolchain::need;

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
        let rows = kernels()?.into_iter().filter_map(|Kernel { name, .. }| {
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

/// What becomes of counted instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counts {
    /// All kernels are printed.
    Show,
    /// All kernels go into the document.
    Write,
    /// The watched ones are held against the document: more by 2 % fails, and so does less, which has to be written down.
    Compare,
}

/// Most that a count may differ from the document: one part of this many.
const TOLERANCE: u64 = 50;

/// Instructions of the kernels, by cachegrind: the difference between N and 2N calls, over N.
///
/// # Errors
/// A count that is not that of the document, or a missing tool.
pub fn count(then: Counts) -> Outcome {
    counting_tool()?;
    let compiler = compiler()?;
    let head = format!("instructions per call, {compiler}");
    let committed = std::fs::read_to_string(root().join(DOCUMENT)).map_err(|e| Failure::found(e.to_string()))?;
    if then == Counts::Compare && !committed.contains(&head) {
        return Ok(Passed::Skipped(format!("the counts of {DOCUMENT} are not of {compiler}")));
    }
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    println!("{:<24} {:>16}", "kernel / part", "instructions");
    for Kernel { name, calls, .. } in kernels()?.into_iter().filter(|k| k.watched || then != Counts::Compare) {
        // Both runs at once: most of their time is the preparation.
        let (once, twice) = (counted(&name, calls)?, counted(&name, 2 * calls)?);
        let (once, twice) = (collected(once)?, collected(twice)?);
        let each = (twice.saturating_sub(once) as f64 / f64::from(calls)).round() as u64;
        let shown = table::thousands(each);
        println!("{name:<24} {shown:>16}");
        if then == Counts::Compare {
            wrong.extend(difference(&committed, &name, each));
        }
        rows.push((name, shown));
    }
    if then == Counts::Write {
        table::replace(&root().join(DOCUMENT), "instructions", &table::table(["kernel / part", &head], rows))?;
    }
    if wrong.is_empty() {
        return Ok(Passed::Done);
    }
    Err(Failure::found(format!(
        "{}\nwhat is meant goes into {DOCUMENT} by `cargo xtask bench --count --write`",
        wrong.join("\n")
    )))
}

/// What is wrong with a count beside the row of the document, if anything.
fn difference(document: &str, kernel: &str, count: u64) -> Option<String> {
    let row = document.lines().find_map(|line| line.strip_prefix(&format!("| {kernel} | "))?.strip_suffix(" |"));
    let Some(committed) = row.and_then(|number| number.replace(',', "").parse::<u64>().ok()) else {
        return Some(format!("{kernel} has no row in {DOCUMENT}"));
    };
    let apart = count.abs_diff(committed) > committed / TOLERANCE;
    apart.then(|| {
        format!("{kernel} takes {} instructions, not {}", table::thousands(count), table::thousands(committed))
    })
}

/// The program that counts, installed where that is allowed.
fn counting_tool() -> Result<(), Failure> {
    need(|| succeeds(program("valgrind").arg("--version")), "valgrind", "instructions are counted by valgrind")
}

/// The compiler, as `rustc 1.95.0`.
fn compiler() -> Result<String, Failure> {
    let said = read(program("rustc").arg("--version"))?;
    Ok(said.split_whitespace().take(2).collect::<Vec<_>>().join(" "))
}

/// A kernel as the counter lists it.
struct Kernel {
    name: String,
    calls: u32,
    watched: bool,
}

/// Builds the counter and asks it for its kernels.
fn kernels() -> Result<Vec<Kernel>, Failure> {
    build_counter()?;
    let said = read(&mut counter())?;
    let kernel = |line: &str| {
        let mut words = line.split(' ');
        let (name, calls, watched) = (words.next()?, words.next()?, words.next()?);
        Some(Kernel { name: name.to_owned(), calls: calls.parse().ok()?, watched: watched.parse().ok()? })
    };
    let kernels: Vec<_> = said.lines().filter_map(kernel).collect();
    if kernels.is_empty() { Err(Failure::found("the counter knows no kernels")) } else { Ok(kernels) }
}

fn build_counter() -> Result<(), Failure> {
    run(cargo().args(["build", "--package", "truepath-core", "--profile", "bench", "--example", "count"]))
}

fn counter() -> Command {
    program(target().join("release/examples/count"))
}

fn counted(kernel: &str, calls: u32) -> Result<Child, Failure> {
    program("valgrind")
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
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
    instructions(&said).ok_or_else(|| Failure::found(format!("cachegrind said:\n{said}")))
}

/// The number in cachegrind's line `==123== I   refs:      1,234`.
fn instructions(said: &str) -> Option<u64> {
    said.lines().find_map(|line| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [_, "I", "refs:", number] => number.replace(',', "").parse().ok(),
        _ => None,
    })
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
    fn cachegrinds_count_is_read() {
        let said = "==7== Cachegrind, a high-precision tracing profiler\n==7== I   refs:      1,123,456\n";
        assert_eq!(instructions(said), Some(1_123_456));
        assert_eq!(instructions("==7== Process terminating"), None);
    }

    #[test]
    fn a_count_that_is_not_that_of_the_document_is_told() {
        let document = "| kernel / part | instructions per call, rustc 1.95.0 |\n|---|---:|\n| tick/10 | 1,000 |\n";
        assert_eq!(difference(document, "tick/10", 1_020), None);
        assert_eq!(difference(document, "tick/10", 980), None);
        assert_eq!(difference(document, "tick/10", 1_021).unwrap(), "tick/10 takes 1,021 instructions, not 1,000");
        assert_eq!(difference(document, "tick/10", 979).unwrap(), "tick/10 takes 979 instructions, not 1,000");
        assert!(difference(document, "tick/1", 1_000).unwrap().contains("no row"));
    }

    #[test]
    fn the_median_of_criterions_estimates_is_read() {
        let estimates = r#"{"mean":{"point_estimate":9.0},"median":{"confidence_interval":{"confidence_level":0.95,"lower_bound":1.0},"point_estimate":41.5,"standard_error":0.1}}"#;
        assert_eq!(median(estimates), Some(41.5));
    }
}
