//! `truepath probe`: the program with which a control touches a milled wall.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use truepath_correction::verification::{ProbeDialect, Settings};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;

use super::{Terminal, print, probe_flags, which};
use crate::command::probe::{Evidence, Options, Report, run as probe};

#[derive(Debug, Args)]
#[group(id = "probe_arguments")]
#[command(group = clap::ArgGroup::new("measured").multiple(true))]
pub(super) struct Arguments {
    /// The job.
    job: PathBuf,
    /// The control the program is for.
    #[arg(long, value_enum, required_unless_present = "next", requires = "output")]
    dialect: Option<ProbeDialect>,
    /// The program to write.
    #[arg(short, long, value_name = "FILE", required_unless_present = "next", requires = "dialect")]
    output: Option<PathBuf>,
    /// Further places, given what was measured: those after which the worst place of the corrected wall is most certain.
    #[arg(long, requires = "measured")]
    next: bool,
    /// What was measured on the part that will be touched again: cut by the job's program, or with the correction in DIR.
    #[arg(long, value_name = "FILE", requires = "next", group = "measured")]
    probe: Option<PathBuf>,
    /// Folder of correct or learn: touched is the part cut with the correction in it, its history is known.
    #[arg(long, value_name = "DIR", requires = "next", group = "measured")]
    from: Option<PathBuf>,
    /// Replace the file if it exists.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    which: which::WhichArguments,
    /// Places along the contour; each is touched at every height [default: 8; with --next at most 4].
    #[arg(long, value_name = "N")]
    points: Option<u32>,
    /// Heights at each place.
    #[arg(long, value_name = "N", default_value_t = Settings::default().heights)]
    heights: u32,
    /// From the ball's surface to the nominal wall where a touch begins, mm.
    #[arg(long, value_name = "MM", default_value_t = Settings::default().clearance)]
    clearance: f64,
    /// How far beyond the nominal wall a touch is searched, mm.
    #[arg(long, value_name = "MM", default_value_t = Settings::default().overtravel)]
    overtravel: f64,
    /// From the ball's lowest point to the floor, mm.
    #[arg(long, value_name = "MM", default_value_t = Settings::default().floor_clearance)]
    floor_clearance: f64,
    /// Width that is free before the wall, mm [default: the cutter's diameter, which the pass has cleared].
    #[arg(long, value_name = "MM")]
    free_width: Option<f64>,
    /// Z for moves between places, mm [default: 50 mm above the engaged depth, and no lower than the part's program moves].
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    safe_z: Option<f64>,
    /// Feed of moves that should touch nothing, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_move)]
    feed_move: f64,
    /// Feed of the first touch, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_fast)]
    feed_fast: f64,
    /// Feed of the second touch, which counts, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_slow)]
    feed_slow: f64,
    /// Call the probe as this tool (T, M6, G43 H) instead of stopping for the operator.
    #[arg(long, value_name = "N")]
    probe_tool: Option<u32>,
    #[command(flatten)]
    probe_flags: probe_flags::Arguments,
}

/// Further places that are looked for, when the user does not say how many.
const FURTHER: u32 = 4;

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = Options {
        job: &arguments.job,
        program: arguments.dialect.zip(arguments.output.as_deref()),
        force: arguments.force,
        which: arguments.which.which(),
        settings: Settings {
            places: arguments.points.unwrap_or(if arguments.next { FURTHER } else { Settings::default().places }),
            heights: arguments.heights,
            clearance: arguments.clearance,
            overtravel: arguments.overtravel,
            floor_clearance: arguments.floor_clearance,
            free_width: arguments.free_width,
            safe_z: arguments.safe_z,
            feed_move: arguments.feed_move,
            feed_fast: arguments.feed_fast,
            feed_slow: arguments.feed_slow,
            probe_tool: arguments.probe_tool,
        },
        measured: arguments.next.then(|| Evidence {
            probe: arguments.probe.as_deref(),
            flags: arguments.probe_flags.flags(),
            from: arguments.from.as_deref(),
        }),
    };
    let mut bar = terminal.progress("choosing places", 100);
    let report = probe(&options, &mut |share| bar.reached((100.0 * share) as u64))?;
    drop(bar);
    for warning in &report.warnings {
        terminal.warn(warning);
    }
    if terminal.json() {
        return print(&json(&report)?);
    }
    let written = arguments.output.as_ref().map(|out| format!("written to {}\n", out.display()));
    print((words(&report) + &written.unwrap_or_default()).as_bytes())
}

fn words(report: &Report) -> String {
    let mut text = String::from(" point      s mm       X mm       Y mm       Z mm\n");
    let mut last = usize::MAX;
    for p in &report.points {
        if p.rank != last {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "       {} (line {}): {}", p.what, p.line, p.why);
            if let Some(gain) = p.gain {
                let _ = writeln!(
                    text,
                    "       corrected wall least certain at s = {:.2} mm: {:.4} mm -> {:.4} mm (one sigma){}",
                    gain.worst_s_mm,
                    gain.max_sigma_before_mm,
                    gain.max_sigma_after_mm,
                    if gain.worth_it { "" } else { ", below the noise of a reading" }
                );
            }
            last = p.rank;
        }
        let _ = writeln!(
            text,
            "{:>6} {:>9.2} {:>10.4} {:>10.4} {:>10.4}  {}",
            p.id, p.s_mm, p.x_mm, p.y_mm, p.z_mm, p.why_height
        );
    }
    text += "\nuncertainty left of what the job states:";
    for u in &report.unknowns {
        let _ = write!(text, " {} {:.0} %;", u.words, 100.0 * u.remaining);
    }
    let wall = if report.points.iter().any(|p| p.gain.is_some()) {
        "corrected wall where it is least certain"
    } else {
        "predicted wall"
    };
    let _ = writeln!(
        text,
        "\n{wall}, one sigma: {:.4} mm before the touches, {:.4} mm after",
        report.wall_sigma_before_mm, report.wall_sigma_after_mm
    );
    for kept in &report.kept_off {
        let _ = writeln!(text, "kept off {} places {}", kept.places, kept.words);
    }
    let _ = writeln!(
        text,
        "safe height Z{:.3} mm, stand-off {:.3} mm before the wall{}",
        report.safe_z_mm,
        report.clearance_mm,
        report.probe_format.map_or_else(String::new, |f| format!("; read the results with [probe] format = \"{f}\""))
    );
    text
}
