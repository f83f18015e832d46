//! `truepath inspect`: the accuracy of the wall from measurements alone, and the verdict on the part.

use std::path::PathBuf;

use clap::Args;
use truepath_correction::inspection::PointVerdict;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_job::feature::listing;
use truepath_job::job::PartFlags;

use super::{Terminal, print, probe_flags, which};
use crate::command::inspect::{Inspection, Options, run as inspect};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// The probe file.
    #[arg(long, value_name = "FILE")]
    probe: PathBuf,
    /// Folder for report.html, the points as a table, the summary and the probe file as it is.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    force: bool,
    /// Serial number of the part, in place of part.serial of the job.
    #[arg(long, value_name = "TEXT")]
    serial: Option<String>,
    /// Half the width of the tolerance of the wall, mm, in place of the limits of the job.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: Option<String>,
    /// When the part was measured, for the report; without it none is named.
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,
    #[command(flatten)]
    probe_flags: probe_flags::Arguments,
    #[command(flatten)]
    which: which::WhichArguments,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let inspection = inspect(&Options {
        job: &arguments.job,
        probe: &arguments.probe,
        out: arguments.output.as_deref(),
        force: arguments.force,
        part: PartFlags {
            serial: arguments.serial.clone(),
            tolerance: arguments.tolerance.clone(),
            date: arguments.date.clone(),
        },
        probe_flags: arguments.probe_flags.flags(),
        which: arguments.which.which(),
    })?;
    for warning in &inspection.summary.warnings {
        terminal.warn(warning);
    }
    print(&if terminal.json() { json(&inspection)? } else { words(&inspection).into_bytes() })
}

fn words(inspection: &Inspection) -> String {
    let mut text = inspection.summary.feature.as_ref().map(listing).unwrap_or_default();
    let judged = inspection.summary.tolerance.is_some();
    text.push_str("  line     s mm       X mm       Y mm   height mm   error mm");
    text.push_str(if judged { "  verdict\n" } else { "\n" });
    for p in &inspection.contacts {
        text += &format!(
            "{:>6} {:>8.2} {:>10.4} {:>10.4} {:>11.3} {:>10.*}{}\n",
            p.line,
            p.s_mm,
            p.x_mm,
            p.y_mm,
            p.height_mm,
            inspection.decimals,
            p.error_mm,
            p.verdict.map_or("", word)
        );
    }
    let s = &inspection.summary;
    text += &format!(
        "\n{} points; material left is positive\nmean {:.4} mm (a wear offset removes it), largest {:.d$}, smallest {:.d$}, rms {:.4}, spread over height {:.4} mm\n",
        s.points,
        s.mean_error_mm,
        s.max_error_mm,
        s.min_error_mm,
        s.rms_error_mm,
        s.spread_over_height_mm,
        d = inspection.decimals
    );
    text += &s.statements.join("\n");
    text + &format!("\nverdict: {}\n", s.verdict.text)
}

const fn word(verdict: PointVerdict) -> &'static str {
    match verdict {
        PointVerdict::Pass => "  pass",
        PointVerdict::Fail => "  FAIL",
        PointVerdict::Open => "  undecided",
    }
}
