//! What the component costs in a servo period, from HAL's own counters: median and maximum, with and without a
//! correction, beside LinuxCNC's motion controller in the same periods, which shows how noisy the computer was.
//!
//! HAL counts clocks of the processor (`FUNCTION.time`, as in `halcmd show thread`). They are turned into time by the
//! frequency in /proc/cpuinfo. Nothing passes or fails by them.

use std::fmt::Write;
use std::fs;

use super::recording::Row;

const ACTIVE: u32 = 3;
/// Clocks that a function took in a period.
type Clocks = fn(&Row) -> i64;
/// What is measured, in the words of the table.
const FUNCTIONS: [(&str, Clocks); 3] = [
    ("`truepath.command`", |row| row.command_clocks),
    ("`truepath.feedback`", |row| row.feedback_clocks),
    ("`motion-controller`, for comparison", |row| row.controller_clocks),
];

/// The table in Markdown.
pub fn table(rows: &[Row]) -> String {
    let hz = clocks_per_second();
    let mut text = String::from(
        "| function | with a correction: median | largest | without: median | largest |\n|---|---:|---:|---:|---:|\n",
    );
    for (name, clocks) in FUNCTIONS {
        let [on, off] = [true, false].map(|on| {
            let rows = rows.iter().filter(|row| (row.state >= ACTIVE) == on);
            let mut times: Vec<i64> = rows.map(clocks).collect();
            times.sort_unstable();
            let microseconds = |clocks: Option<&i64>| clocks.map_or(f64::NAN, |&c| c as f64 * 1e6 / hz);
            (microseconds(times.get(times.len() / 2)), microseconds(times.last()))
        });
        let _ = writeln!(text, "| {name} | {:.2} µs | {:.0} µs | {:.2} µs | {:.0} µs |", on.0, on.1, off.0, off.1);
    }
    let corrected = rows.iter().filter(|row| row.state >= ACTIVE).count();
    let _ = writeln!(
        text,
        "\n{} periods of 1 ms, {corrected} with a correction; {}; no real-time kernel, other work on the same processors, \
         so the largest values are those of the computer: `motion-controller` has them as well.",
        rows.len(),
        processor(),
    );
    text
}

/// What our functions and the motion controller take in a period with a correction, µs: the medians.
pub fn typical(rows: &[Row]) -> Vec<(&'static str, f64)> {
    let of = |clocks: Clocks| rows.iter().filter(|row| row.state >= ACTIVE).map(clocks).collect();
    FUNCTIONS.iter().map(|(name, clocks)| (*name, median_us(of(*clocks)))).collect()
}

/// The median of what HAL counted, µs.
pub fn median_us(mut clocks: Vec<i64>) -> f64 {
    clocks.sort_unstable();
    clocks.get(clocks.len() / 2).map_or(f64::NAN, |&c| c as f64 * 1e6 / clocks_per_second())
}

fn info(key: &str) -> Option<String> {
    let info = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.split(':').next().is_some_and(|k| k.trim() == key))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Other processors than x86 count nanoseconds.
fn clocks_per_second() -> f64 {
    info("cpu MHz").and_then(|mhz| mhz.parse::<f64>().ok()).map_or(1e9, |mhz| mhz * 1e6)
}

fn processor() -> String {
    info("model name").unwrap_or_else(|| "unknown processor".to_owned())
}
