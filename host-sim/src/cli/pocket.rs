//! `truepath pocket`: a whole pocket compensated from tool and material data alone.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_job::job::{Mode, PerSection};
use truepath_pocket::{PocketSummary, materials, materials_text, sections_text};

use super::{Terminal, print, which};
use crate::command::pocket::{Options, run as pocket};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job: with `stickout_mm` and `material` in `[tool]`, and `[pocket]`.
    #[arg(required_unless_present = "materials")]
    job: Option<PathBuf>,
    /// Folder for corrected.nc, sections.csv, correction.csv, before-after.svg and summary.json.
    #[arg(short, long, value_name = "DIR", required_unless_present = "materials")]
    output: Option<PathBuf>,
    /// Half of the width of the band the walls may lie in, mm; over that of the job.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// How a section out of the band is shifted; over what the job says.
    #[arg(long, value_name = "WAY")]
    per_section: Option<Way>,
    /// The force coefficients of materials, with their sources, and nothing else.
    #[arg(long, conflicts_with_all = ["job", "output", "tolerance", "per_section"])]
    materials: bool,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    which: which::WhichArguments,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Way {
    /// By the predicted profile of the error.
    Profile,
    /// By one value.
    Constant,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let (Some(job), Some(out), false) = (&arguments.job, &arguments.output, arguments.materials) else {
        let rows = materials();
        return print(&if terminal.json() { json(&rows)? } else { materials_text(&rows).into_bytes() });
    };
    let per_section = arguments.per_section.map(|way| match way {
        Way::Profile => PerSection::Profile,
        Way::Constant => PerSection::Constant,
    });
    let (tolerance_mm, which) = (arguments.tolerance, arguments.which.which());
    compensate(&Options { job, out, force: arguments.force, tolerance_mm, per_section, which }, terminal)
}

/// Compensates and prints; `truepath correct --no-probe` comes here as well.
pub(super) fn compensate(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let mut bar = terminal.progress("compensating", 100);
    let summary = pocket(options, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    if terminal.json() {
        return print(&json(&summary)?);
    }
    print(format!("{}written to {}\n", words(&summary), options.out.display()).as_bytes())
}

fn words(s: &PocketSummary) -> String {
    let what = match s.mode {
        Mode::Wall => "finishing pass",
        Mode::Slot => "slot, near wall on the",
    };
    let side = if s.mode == Mode::Slot { format!(" {}", s.near_wall) } else { String::new() };
    let cutter = &s.cutter;
    let mut text = format!(
        "{what}{side}, {:.1} mm, {} milling; cutter {:.1} mm free, {:.1} of it fluted: {:.3} µm/N at the tip, {:.3} at the top of the cut\n\n",
        s.length_mm, s.milling, cutter.stickout_mm, cutter.flute_length_mm, cutter.tip_um_per_n, cutter.top_um_per_n,
    );
    text += &sections_text(&s.sections);
    text += &format!(
        "\nband ±{} mm: {} of {} sections shifted, largest error {:.4} -> {:.4} mm, predicted\n\
         without a probe this is as good as the force coefficients:\n",
        s.tolerance_mm,
        s.sections_shifted,
        s.sections.len(),
        s.max_error_before_mm,
        s.max_error_after_mm
    );
    if s.max_error_sharp_mm > 0.0 {
        text += &format!("  (corners without an arc apart: {:.4} mm remain there)\n", s.max_error_sharp_mm);
    }
    for case in &s.sensitivity {
        let out = match case.sections_out {
            0 => "all sections within the band".to_owned(),
            1 => "1 section out of the band".to_owned(),
            n => format!("{n} sections out of the band"),
        };
        text += &format!(
            "  coefficients {:+.0} %: largest error {:.4} -> {:.4} mm, {out}\n",
            100.0 * (case.factor - 1.0),
            case.max_error_before_mm,
            case.max_error_after_mm
        );
    }
    text
}
