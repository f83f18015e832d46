//! `truepath learn`: from the probe file of a corrected part to the correction of the next one.

use std::path::PathBuf;

use clap::Args;
use truepath_correction::learn::LearnSummary;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_job::job::Route;

use super::correct::{RouteArgument, words as correction};
use super::{Terminal, print, probe_flags, which};
use crate::command::learn::{Options, run as learn};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// What the probe measured on the part cut with the correction in --from.
    #[arg(long, value_name = "FILE")]
    probe: PathBuf,
    /// Folder that truepath correct, or truepath learn, wrote that correction into.
    #[arg(long, value_name = "DIR")]
    from: PathBuf,
    /// Folder for the correction of the next part; another one than --from.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Correct in the program text or in the coprocessor; the job says it otherwise.
    #[arg(long, value_enum)]
    route: Option<RouteArgument>,
    /// Replace the files of an earlier run.
    #[arg(long)]
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
        from: &arguments.from,
        out: &arguments.output,
        force: arguments.force,
        route: arguments.route.map(Route::from),
        probe_flags: arguments.probe_flags.flags(),
        which: arguments.which.which(),
    };
    let mut bar = terminal.progress("learning", 100);
    let summary = learn(&options, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    for warning in &summary.correct.warnings {
        terminal.warn(warning);
    }
    let text = words(&summary) + &correction(&summary.correct, &arguments.output);
    print(&if terminal.json() { json(&summary)? } else { text.into_bytes() })
}

fn words(s: &LearnSummary) -> String {
    let (v, whole) = (&s.verdict, &s.whole_contour_error_mm);
    let mut text = format!(
        "part {} at {} places, error of the target      largest      rms\n\
         \x20 measured                           {:>12.4} {:>8.4} mm\n\
         \x20 part {} there                       {:>12.4} {:>8.4} mm\n\
         \x20 promised                           {:>12.4}          mm, {} of {} places within 2 sigma\n\
         \x20 whole contour, by the model        {:>12.4}          mm, at s = {:.1} mm, sigma {:.4} mm\n",
        v.part,
        v.measured_error_mm.places,
        v.measured_error_mm.max_mm,
        v.measured_error_mm.rms_mm,
        v.previous_error_mm.part,
        v.previous_error_mm.max_mm,
        v.previous_error_mm.rms_mm,
        v.promise.max_mm,
        v.promise.within_two_sigma,
        v.promise.places,
        whole.max_mm,
        whole.s_mm,
        whole.sigma_mm,
    );
    if let Some(held) = &v.holdout_residual_mm {
        text += &format!(
            "\x20 at {} places kept from a first fit the model missed {:.4} mm before and {:.4} mm after learning\n",
            held.places.len(),
            held.before_mm,
            held.after_mm
        );
    }
    if let Some(again) = v.used_again.filter(|_| v.rolled_back) {
        text += &format!("  rolled back: {}\n", again.words());
    }
    text + &format!("\ncorrection of part {}\n", v.part.saturating_add(1))
}
