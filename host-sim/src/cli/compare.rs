//! `truepath compare`: all laws of correction on the same machine, in one table.

use std::path::PathBuf;

use clap::Args;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;

use super::{Terminal, print, probe_flags, which};
use crate::command::compare::{CompareSummary, Options, run as compare};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE")]
    probe: PathBuf,
    /// A virtual machine to compare on; without it the machine identified from the points.
    #[arg(long, value_name = "PLANT.toml")]
    plant: Option<PathBuf>,
    /// Folder for the tables, the summary and the picture.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    force: bool,
    #[command(flatten)]
    probe_flags: probe_flags::Arguments,
    #[command(flatten)]
    which: which::WhichArguments,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = Options {
        job: &arguments.job,
        probe: &arguments.probe,
        plant: arguments.plant.as_deref(),
        out: arguments.output.as_deref(),
        force: arguments.force,
        probe_flags: arguments.probe_flags.flags(),
        which: arguments.which.which(),
    };
    let mut bar = terminal.progress("comparing", 100);
    let summary = compare(&options, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    print(&if terminal.json() { json(&summary)? } else { words(&summary).into_bytes() })
}

fn words(s: &CompareSummary) -> String {
    let on = match s.machine {
        "plant" => "on the virtual machine, which shares no physics with the model",
        _ => "on the machine identified from the points: the model's own prediction",
    };
    let mut text = format!(
        "{on}\nerror of the target ({}, heights {:.1} to {:.1} mm) and at any height, without {:.1} mm at either end\n\n\
         law                     largest       rms  any height     gouge   factor   mm\n",
        s.target, s.band_mm[0], s.band_mm[1], s.trim_mm
    );
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"));
    for row in &s.laws {
        text += &format!(
            "{:<20} {:>10} {:>9} {:>11} {:>9} {:>8}\n",
            row.title,
            number(row.max_error_mm),
            number(row.rms_error_mm),
            number(row.worst_height_mm),
            number(row.gouge_mm),
            row.factor.map_or_else(|| "-".to_owned(), |f| format!("{f:.1}")),
        );
    }
    text.push('\n');
    for row in s.laws.iter().filter(|row| !row.remark.is_empty()) {
        text += &format!("{}: {}\n", row.title, row.remark);
    }
    text
}
