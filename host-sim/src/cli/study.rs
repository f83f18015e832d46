//! `truepath study`: how well the method does on machines that the model has never seen.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Terminal, print};
use crate::command::study::{Options, run as study};
use crate::diagnostics::Failure;
use crate::report::json;
use crate::study::families::FAMILIES;
use crate::study::id::Axis;
use crate::study::outcome::Outcome;
use crate::study::seeds::Set;
use crate::study::statistics::{Spread, mean};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the results; an interrupted study goes on there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Which seeds: those for tuning, or those kept for judging.
    #[arg(long, value_enum, default_value_t = SetArgument::Tuning)]
    set: SetArgument,
    /// Only these families.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    families: Vec<String>,
    /// Seeds a family.
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// A grid instead of single cases: the factor against one thing.
    #[arg(long, value_enum)]
    axis: Option<AxisArgument>,
    /// So many wholly random machines instead of the seeds of a set.
    #[arg(long, value_name = "N", conflicts_with_all = ["set", "seeds", "axis"])]
    random: Option<u64>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Drop earlier results.
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SetArgument {
    Tuning,
    Test,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AxisArgument {
    /// Probe noise.
    Noise,
    /// Number of touches.
    Points,
    /// Mistakes of the job.
    Prior,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let set = match (arguments.random, arguments.set) {
        (Some(_), _) => Set::Random,
        (None, SetArgument::Tuning) => Set::Tuning,
        (None, SetArgument::Test) => Set::Test,
    };
    let axis = arguments.axis.map(|axis| match axis {
        AxisArgument::Noise => Axis::Noise,
        AxisArgument::Points => Axis::Points,
        AxisArgument::Prior => Axis::Prior,
    });
    let options = Options {
        out: &arguments.output,
        set,
        families: &arguments.families,
        seeds: arguments.random.unwrap_or(arguments.seeds),
        axis,
        force: arguments.force,
        threads: arguments.threads,
    };
    let mut bar = terminal.progress("studying", 1000);
    let outcomes = study(&options, &mut |done, all| bar.reached(done * 1000 / all.max(1)))?;
    drop(bar);
    print(&if terminal.json() { json(&outcomes)? } else { words(&outcomes, arguments).into_bytes() })
}

fn words(outcomes: &[Outcome], arguments: &Arguments) -> String {
    let mut text = format!(
        "{:<22} {:>5} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8}\n",
        "family", "cases", "median", "P10", "worst", "coverage", "failures", "worse"
    );
    let of = |name: &str| -> Vec<&Outcome> {
        outcomes.iter().filter(|o| o.id().is_some_and(|id| id.family == name && id.cell.is_none())).collect()
    };
    let mut all: Vec<&Outcome> = Vec::new();
    for family in FAMILIES {
        let these = of(family.name);
        if !these.is_empty() {
            text += &row(family.name, &these);
        }
        all.extend(these);
    }
    text += &row("all", &all);
    for failed in outcomes.iter().filter(|o| !o.failure.is_empty()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}: {}", failed.case, failed.failure);
    }
    let _ = writeln!(text, "\nwritten to {}", arguments.output.display());
    text
}

fn row(name: &str, outcomes: &[&Outcome]) -> String {
    let factors: Vec<f64> = outcomes.iter().filter_map(|o| o.factor).collect();
    let coverage: Vec<f64> = outcomes.iter().filter_map(|o| o.coverage).collect();
    let spread = Spread::of(&factors);
    let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.1}"));
    format!(
        "{name:<22} {:>5} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8}\n",
        outcomes.len(),
        show(spread.map(|s| s.median)),
        show(spread.map(|s| s.p10)),
        show(spread.map(|s| s.worst)),
        mean(&coverage).map_or_else(|| "-".to_owned(), |c| format!("{:.1} %", 100.0 * c)),
        outcomes.iter().filter(|o| !o.failure.is_empty()).count(),
        outcomes.iter().filter(|o| o.worse()).count(),
    )
}
