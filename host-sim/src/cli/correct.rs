//! `truepath correct`: from a probe file to the corrected program or the correction image.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use truepath_correction::summary::CorrectSummary;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_job::feature::listing;
use truepath_job::job::Route;

use super::{Terminal, pocket, print, probe_flags, which};
use crate::command::correct::{Options, run as correct};
use crate::command::pocket as compensation;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE", required_unless_present = "no_probe")]
    probe: Option<PathBuf>,
    /// From tool and material data alone: the same as truepath pocket.
    #[arg(long, conflicts_with_all = ["probe", "route", "first_pass"])]
    no_probe: bool,
    /// Folder for the corrected program (or image), tables, summary, report and picture.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Correct in the program text or in the coprocessor; the job says it otherwise.
    #[arg(long, value_enum)]
    route: Option<RouteArgument>,
    /// The probe file is of the first of two passes, with this job (written by truepath split).
    #[arg(long, value_name = "FIRST-PASS.toml")]
    first_pass: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    probe_flags: probe_flags::Arguments,
    #[command(flatten)]
    which: which::WhichArguments,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum RouteArgument {
    Program,
    Coprocessor,
}

impl From<RouteArgument> for Route {
    fn from(argument: RouteArgument) -> Self {
        match argument {
            RouteArgument::Program => Self::Program,
            RouteArgument::Coprocessor => Self::Coprocessor,
        }
    }
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let Some(probe) = &arguments.probe else {
        let options = compensation::Options {
            job: &arguments.job,
            out: &arguments.output,
            force: arguments.force,
            tolerance_mm: None,
            per_section: None,
            which: arguments.which.which(),
        };
        return pocket::compensate(&options, terminal);
    };
    let options = Options {
        job: &arguments.job,
        probe,
        out: &arguments.output,
        force: arguments.force,
        route: arguments.route.map(Route::from),
        first_pass: arguments.first_pass.as_deref(),
        probe_flags: arguments.probe_flags.flags(),
        which: arguments.which.which(),
    };
    let mut bar = terminal.progress("correcting", 100);
    let summary = correct(&options, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    print(&if terminal.json() { json(&summary)? } else { words(&summary, &arguments.output).into_bytes() })
}

pub(super) fn words(s: &CorrectSummary, output: &Path) -> String {
    let factor = s.max_error_before_mm / s.max_error_after_mm.max(1e-6);
    let mut text = s.feature.as_ref().map(listing).unwrap_or_default();
    text += &format!(
        "{} points used, {} set aside; wall follows the {} force, {} milling\n\
         \n\
         largest wall error without correction  {:>8.4} mm\n\
         with correction, as the model sees it  {:>8.4} mm  ({factor:.0} times less)\n\
         what the points leave open (1 sigma)   {:>8.4} mm\n\
         \x20 where the largest error is expected  {:>8.4} mm\n\
         left over the height, beyond X and Y   {:>8.4} mm\n\
         deepest cut at any height              {:>8.4} mm\n\
         largest correction                     {:>8.4} mm\n\
         \n\
         identified                      value      sigma   before\n",
        s.points_used,
        s.points_rejected + s.points_outlying,
        s.wall_law,
        s.milling,
        s.max_error_before_mm,
        s.max_error_after_mm,
        s.max_sigma_mm,
        s.sigma_at_max_error_mm,
        s.axial_form_error_mm,
        s.worst_gouge_mm,
        s.max_correction_mm,
    );
    for (name, p) in &s.identified {
        let seen = if p.observable { "" } else { "  not decided by the points" };
        text +=
            &format!("  {name:<24} {:>10.4} {:>10.4} {:>8.4} {:<5}{seen}\n", p.value + 0.0, p.sigma, p.prior, p.unit);
    }
    text += &format!("\nwritten to {}; to look at: {}\n", output.display(), output.join("report.html").display());
    text
}
