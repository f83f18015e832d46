//! `truepath demo`: the whole story, on parts that come with the program.

use std::path::PathBuf;

use clap::Args;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;

use super::{Terminal, print};
use crate::command::demo::{Earlier, Outcome, run as demo};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder for the programs, probe files, corrections, reports and pictures.
    #[arg(short, long, value_name = "DIR", default_value = "out/demo")]
    output: PathBuf,
    /// Keep the files of an earlier run: stop when there are some.
    #[arg(long)]
    keep: bool,
    /// Replace the files of an earlier run, edited ones too.
    #[arg(long, conflicts_with = "keep")]
    force: bool,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let mut bar = terminal.progress("milling, probing, correcting, milling again", 100);
    let earlier = match (arguments.keep, arguments.force) {
        (true, _) => Earlier::Stop,
        (_, true) => Earlier::Replace,
        _ => Earlier::ReplaceUnchanged,
    };
    let outcomes = demo(&arguments.output, earlier, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    print(&if terminal.json() { json(&outcomes)? } else { words(&outcomes).into_bytes() })
}

fn words(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "Each part was milled on a virtual machine, touched with a probe, corrected, and milled again.\n\
         Largest error of the wall (mean over the height):\n\n\
         part                                                          points   before mm   after mm   times less\n",
    );
    for o in outcomes {
        text +=
            &format!("{:<62}{:>6}{:>12.4}{:>11.4}{:>11.1}x\n", o.title, o.points, o.before_mm, o.after_mm, o.factor);
    }
    text += "\nLook at the reports (open them in a browser):\n";
    for o in outcomes {
        text += &format!("  {}\n", o.folder.join("report.html").display());
    }
    text += "Pictures (before-after.svg), corrected programs (corrected.nc) and images for the coprocessor (correction.tpi) lie\n\
             beside them.\n";
    text
}
