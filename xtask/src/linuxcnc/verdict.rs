//! What the scenarios came to, as a table on the terminal and in the document.

use std::fmt::Write;

use super::check::equal::Equality;
use super::check::limits::Extremes;
use crate::step::{Failure, Outcome, Passed};

/// What a scenario came to.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    pub name: &'static str,
    /// Servo periods.
    pub periods: usize,
    /// What `truepath replay` gave as well.
    pub equality: Option<Equality>,
    pub extremes: Extremes,
    /// What is wrong.
    pub found: Vec<String>,
    /// What LinuxCNC said to the operator.
    pub said: Vec<String>,
}

const HEAD: [&str; 8] = [
    "scenario",
    "periods",
    "replayed",
    "correction mm",
    "speed",
    "acceleration",
    "following error mm",
    "changed by mm",
];

impl Verdict {
    fn cells(&self) -> [String; 8] {
        let e = &self.extremes;
        let percent = |part: f64| format!("{:.0} %", 100.0 * part);
        [
            self.name.to_owned(),
            self.periods.to_string(),
            self.equality.map_or("–".to_owned(), |e| e.corrected.to_string()),
            format!("{:.4}", e.correction_mm),
            percent(e.velocity),
            percent(e.acceleration),
            format!("{:.4}", e.following_error_mm),
            format!("{:.4}", e.following_change_mm),
        ]
    }
}

/// The table for the document.
pub fn document(verdicts: &[Verdict]) -> String {
    let mut text = format!("| {} |\n|---|{}\n", HEAD.join(" | "), "---:|".repeat(HEAD.len() - 1));
    for verdict in verdicts {
        let _ = writeln!(text, "| {} |", verdict.cells().join(" | "));
    }
    text
}

/// The table on the terminal, what was found, and the outcome.
pub fn tell(verdicts: &[Verdict]) -> Outcome {
    let cells: Vec<[String; 8]> =
        [HEAD.map(str::to_owned)].into_iter().chain(verdicts.iter().map(Verdict::cells)).collect();
    let widths: Vec<usize> =
        (0..HEAD.len()).map(|c| cells.iter().map(|row| row[c].chars().count()).max().unwrap_or(0)).collect();
    let ends = [""].into_iter().chain(verdicts.iter().map(|v| if v.found.is_empty() { "  ok" } else { "  FAILED" }));
    for (row, end) in cells.iter().zip(ends) {
        let [name, numbers @ ..] = row;
        let numbers: Vec<String> = numbers.iter().zip(&widths[1..]).map(|(n, w)| format!("{n:>w$}")).collect();
        println!("{name:<w$}  {}{end}", numbers.join("  "), w = widths[0]);
    }
    for verdict in verdicts.iter().filter(|v| !v.found.is_empty()) {
        for finding in &verdict.found {
            eprintln!("{}: {finding}", verdict.name);
        }
        for said in &verdict.said {
            eprintln!("    LinuxCNC said: {said}");
        }
    }
    match verdicts.iter().filter(|v| !v.found.is_empty()).count() {
        0 => Ok(Passed::Done),
        failed => Err(Failure::found(format!("{failed} of {} scenarios", verdicts.len()))),
    }
}
