//! `truepath simulate`: the pass as the core predicts it, or as the plant cuts it.

use std::path::{Path, PathBuf};

use clap::Args;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::json;
use truepath_job::feature::listing;
use truepath_trial::replay::Placement;
use truepath_trial::setpoints::Setpoints;

use super::placement::PlacementArguments;
use super::{Terminal, print, which};
use crate::command::simulate::{Options, Recording, run as simulate};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// A virtual machine to cut with; without it the core predicts from the job's own numbers.
    #[arg(long, value_name = "PLANT.toml")]
    plant: Option<PathBuf>,
    /// Cut along a recorded tool path, not along the program's: `# frame = program` or `machine`, then t_s,x_mm,y_mm,z_mm
    /// and other columns as for `truepath replay`.
    #[arg(long, value_name = "FILE", requires = "plant")]
    setpoints: Option<PathBuf>,
    #[command(flatten)]
    placement: PlacementArguments,
    /// Also write probed-wall.csv: the wall as cut at several heights, for a simulated probe.
    #[arg(long, requires = "plant")]
    probed_wall: bool,
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
    let recorded = arguments.setpoints.as_deref().map(|file| read(file, arguments)).transpose()?;
    let options = Options {
        recording: recorded.as_ref().map(|(setpoints, placement)| Recording { setpoints, placement: *placement }),
        probed_wall: arguments.probed_wall,
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
    let cut = summary.recorded.as_ref().map_or_else(String::new, |facts| {
        format!(
            "recorded from {:.3} to {:.3} s, at most {:.4} mm from the program's path, feed {:.0} to {:.0} %\n",
            facts.from_s,
            facts.to_s,
            facts.farthest_mm,
            100.0 * facts.least_feed,
            100.0 * facts.greatest_feed
        )
    });
    let judged = summary.judged.map_or_else(String::new, |score| {
        format!("away from the ends: largest wall error {:.4} mm (rms {:.4})\n", score.max_error_mm, score.rms_error_mm)
    });
    let text = format!(
        "{}{:.1} mm of contour, {} milling, by the {}\n\
         largest wall error {:.4} mm (rms {:.4}), largest engagement {:.2} degrees, largest mean force {:.0} N\n\
         {judged}{cut}written to {}; to look at: {}\n",
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

/// A recording and where the program stood in the machine.
fn read(file: &Path, arguments: &Arguments) -> Result<(Setpoints, Placement), Failure> {
    let source = Source::read(file)?;
    let setpoints = Setpoints::parse(&source)?;
    let placement = arguments.placement.of(&setpoints, &source)?;
    Ok((setpoints, placement))
}
