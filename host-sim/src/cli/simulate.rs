//! `truepath simulate`: the pass as the core predicts it, or as the plant cuts it.

use std::path::PathBuf;

use clap::Args;

use super::{Terminal, print, which};
use crate::command::simulate::{Options, run as simulate};
use crate::diagnostics::Failure;
use crate::feature::listing;
use crate::report::json;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// A virtual machine to cut with; without it the core predicts from the job's own numbers.
    #[arg(long, value_name = "PLANT.toml")]
    plant: Option<PathBuf>,
    /// Folder for trace.csv, trace.svg, report.html and summary.json.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    which: which::WhichArguments,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = Options {
        job: &arguments.job,
        plant: arguments.plant.as_deref(),
        out: &arguments.output,
        force: arguments.force,
        which: arguments.which.which(),
    };
    let summary = simulate(&options)?;
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    if terminal.json() {
        return print(&json(&summary)?);
    }
    let text = format!(
        "{}{:.1} mm of contour, {} milling, by the {}\n\
         largest wall error {:.4} mm (rms {:.4}), largest engagement {:.2} degrees, largest mean force {:.0} N\n\
         written to {}; to look at: {}\n",
        summary.feature.as_ref().map(listing).unwrap_or_default(),
        summary.length_mm,
        summary.milling,
        summary.by,
        summary.max_error_mm,
        summary.rms_error_mm,
        summary.max_arc_deg,
        summary.max_force_n,
        arguments.output.display(),
        arguments.output.join("report.html").display()
    );
    print(text.as_bytes())
}
