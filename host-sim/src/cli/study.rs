//! `truepath study`: how well the method does on machines that the model has never seen.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_study::id::{Axis, CaseId};
use truepath_study::reference::words as words_of_goals;
use truepath_study::seeds::Set;
use truepath_study::summary::{Row, Summary};
use truepath_study::{export, parallel};

use super::{Terminal, print};
use crate::command::study::{Options, reference, run as study};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the results; an interrupted study goes on there.
    #[arg(short, long, value_name = "DIR", required_unless_present = "case")]
    output: Option<PathBuf>,
    /// One case in detail instead, by its id.
    #[arg(long, value_name = "ID", conflicts_with_all = ["output", "set", "families", "seeds", "axis", "random"])]
    case: Option<CaseId>,
    /// Write program, job, machine, probe file and corrected program of that case.
    #[arg(long, value_name = "DIR", requires = "case")]
    export: Option<PathBuf>,
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
    /// The reference goals instead: the papers' corner, --seeds noise seeds (200 are usual) for each.
    #[arg(long, conflicts_with_all = ["set", "families", "axis", "random", "first"])]
    reference: bool,
    /// Only the first correction; nothing is learned from a second part.
    #[arg(long)]
    first: bool,
    /// Put the tables into a Markdown file, between its two marks.
    #[arg(long, value_name = "FILE.md")]
    write: Option<PathBuf>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Drop earlier results; with --export, replace files.
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
    if let Some(id) = &arguments.case {
        return single(id, arguments, terminal);
    }
    // clap has seen to it that one of the two is there.
    let output = arguments.output.as_deref().unwrap_or_else(|| Path::new("."));
    if arguments.reference {
        return goals(output, arguments, terminal);
    }
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
        out: output,
        set,
        families: &arguments.families,
        seeds: arguments.random.unwrap_or(arguments.seeds),
        axis,
        first_only: arguments.first,
        write: arguments.write.as_deref(),
        force: arguments.force,
        threads: arguments.threads,
    };
    let mut bar = terminal.progress("studying", 1000);
    let studied = study(&options, &mut |done, all| bar.reached(done * 1000 / all.max(1)))?;
    drop(bar);
    print(&if terminal.json() { json(&studied.summary)? } else { words(&studied.summary, output).into_bytes() })
}

/// The reference goals.
fn goals(output: &Path, arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let mut bar = terminal.progress("studying", 1000);
    let threads = arguments.threads.unwrap_or_else(parallel::cores);
    let reached = reference(arguments.seeds, threads, output, arguments.force, &mut |done, all| {
        bar.reached(done * 1000 / all.max(1));
    })?;
    drop(bar);
    print(&if terminal.json() { json(&reached)? } else { words_of_goals(&reached).into_bytes() })
}

/// One case in detail.
fn single(id: &CaseId, arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let detail = export::detail(id)?;
    if let Some(folder) = &arguments.export {
        export::export(&detail, folder, arguments.force)?;
    }
    print(&if terminal.json() { json(&detail.outcome)? } else { export::words(&detail).into_bytes() })
}

fn words(summary: &Summary, output: &Path) -> String {
    let mut text = format!(
        "{:<22} {:>5} {:>7} {:>7} {:>7} {:>8} {:>8} {:>7} {:>7} {:>8} {:>8} {:>6}\n",
        "", "cases", "median", "P10", "worst", "in 2 sg", "learned", "P10", "worst", "in 2 sg", "refused", "worse"
    );
    for set in &summary.sets {
        let _ = writeln!(text, "{} seeds", set.set.name());
        for one in set.families.iter().chain([&set.all]) {
            text += &row(one);
        }
    }
    for axis in &summary.axes {
        let _ = writeln!(text, "{}", axis.axis);
        for (_, one) in &axis.cells {
            text += &row(one);
        }
    }
    for failed in summary.failures.iter().chain(&summary.worse) {
        let _ = writeln!(text, "{}: {}", failed.case, failed.what);
    }
    let _ = writeln!(text, "\nwritten to {}", output.display());
    text
}

fn row(row: &Row) -> String {
    let mut text = format!("  {:<20} {:>5}", row.name, row.cases);
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.1}"));
    for (spread, coverage) in [(row.first, row.coverage), (row.learned, row.learned_coverage)] {
        for value in [spread.map(|s| s.median), spread.map(|s| s.p10), spread.map(|s| s.worst)] {
            let _ = write!(text, " {:>7}", number(value));
        }
        let _ = write!(text, " {:>7}%", number(coverage.map(|c| 100.0 * c)));
    }
    let _ = writeln!(text, " {:>8} {:>6}", row.failures + row.learn_failures, row.worse);
    text
}
