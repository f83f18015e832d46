//! `truepath split`: for a single part, a program that cuts half of the allowance.

use std::path::PathBuf;

use clap::Args;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_job::job::Which;

use super::{Terminal, print};
use crate::command::split::{Options, run as split};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job of the whole allowance.
    job: PathBuf,
    /// Folder for first-pass.nc and first-pass.toml.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The feature of the job, or of the markers in the program; needed when there are several to correct.
    #[arg(long, value_name = "ID")]
    feature: Option<String>,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let which = Which { feature: arguments.feature.clone(), pass: None };
    let options = Options { job: &arguments.job, out: &arguments.output, force: arguments.force, which };
    let split = split(&options)?;
    for warning in &split.warnings {
        terminal.warn(warning);
    }
    if terminal.json() {
        return print(&json(&split)?);
    }
    let (program, first, job) = (split.program.display(), split.job.display(), arguments.job.display());
    let text = format!(
        "{program}: the contour {:.3} mm away from the wall in {} moves; the second pass takes the other {:.3} mm\n\
         next:\n\
         1. mill {program} and leave the part clamped\n\
         2. probe its wall: truepath probe {first} ..., or your own probing routine\n\
         3. truepath correct {job} --first-pass {first} --probe FILE -o DIR\n\
         4. mill the corrected program\n",
        split.allowance_mm, split.moves, split.allowance_mm
    );
    print(text.as_bytes())
}
