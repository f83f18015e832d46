//! `truepath replay`: recorded setpoints through the device's own code.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::output::{OutputFile, json};
use truepath_trial::codes::R004;
use truepath_trial::replay::{Run, replay, settings};
use truepath_trial::setpoints::{Frame, Setpoints};

use super::image;
use super::placement::PlacementOptions;
use crate::settings::changed;
use crate::terminal::{Terminal, print};

/// What is replayed.
#[derive(Debug, Args)]
pub struct Options {
    /// The correction image.
    image: PathBuf,
    /// Recorded setpoints: `# frame = program` or `machine`, then t_s,x_mm,y_mm,z_mm and any of spindle_rpm, flags,
    /// frame_crc, disarm.
    #[arg(long, value_name = "FILE")]
    setpoints: PathBuf,
    /// Corrected setpoints with correction, state and reason of every tick.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    placement: PlacementOptions,
    /// Serial number of the part.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    part: u32,
    /// A setting that differs from the usual ones, named as by `truepath device settings`, for instance
    /// `hold_after_ticks=40`; may be repeated.
    #[arg(long = "setting", value_name = "NAME=VALUE")]
    settings: Vec<String>,
    /// Say lengths in inches; files stay in millimetres.
    #[arg(long)]
    inch: bool,
    /// Replace the output file if it exists.
    #[arg(long)]
    force: bool,
}

/// Rows between two steps of the progress bar.
const BAR_STEP: usize = 4096;

/// Replays and prints what came of it.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let bytes = image::read(&options.image)?;
    let image = image::check(&bytes, &options.image)?;
    let source = Source::read(&options.setpoints)?;
    let setpoints = Setpoints::parse(&source)?;
    let placement = options.placement.of(&setpoints, &source)?;
    let settings = changed(&settings(setpoints.period_ns), &options.settings)
        .map_err(|e| InputError::new(R004, e.found, "a setting of the rewriter as NAME=VALUE", e.help))?;
    let run = Run { placement, part_serial: options.part, settings };
    if setpoints.rows.first().is_some_and(|row| row.spindle_rpm.is_none()) {
        terminal.note("the file has no spindle_rpm; the image's nominal speed is taken");
    }
    let mut file = OutputFile::create(&options.output, options.force)?;
    let failed = |e: std::io::Error| Failure::from(InputError::unwritable(&options.output, &e));
    let frame = if setpoints.frame == Frame::Program { "program" } else { "machine" };
    writeln!(file, "# frame = {frame}\nt_s,x_mm,y_mm,z_mm,dx_mm,dy_mm,state,reason,status,node").map_err(failed)?;
    let mut progress = terminal.progress("replaying", setpoints.rows.len() as u64);
    let summary = replay(image, &setpoints, &run, |index, output| {
        if index % BAR_STEP == 0 {
            progress.reached(index as u64);
        }
        let time = Billionths(setpoints.start_ns + setpoints.period_ns * index as i64);
        let [x, y, z, ..] = output.axes.map(Millionths);
        let [dx, dy, ..] = output.correction_nm.map(|nm| Millionths(nm.into()));
        let (state, reason, status) = (output.mode, output.reason.code(), output.status.0);
        let node = output.place.node;
        writeln!(file, "{time},{x},{y},{z},{dx},{dy},{state},{reason},{status},{node}").map_err(failed)
    })?;
    drop(progress);
    file.commit()?;
    if terminal.json() {
        return print(&json(&summary)?);
    }
    if summary.fault {
        terminal.warn(&format!("the correction was dropped: {}", summary.reason_text));
    } else if summary.corrected_ticks == 0 {
        terminal.warn("no setpoint came to the start of the path, so nothing was corrected");
    } else if summary.state == "Active" || summary.state == "Hold" {
        terminal.warn("the file ends before the path does; the correction was still on");
    }
    let unit = if options.inch { Unit::Inch } else { Unit::Millimetre };
    let text = format!(
        "{} ticks, {} with a correction, largest {:.4} {}; {} above the warn level, {} cut by the clamp, {} faded\n\
         ended in state {}: {}\n\
         fingerprint {}\n\
         written to {}\n",
        summary.ticks,
        summary.corrected_ticks,
        unit.of(summary.max_correction_mm),
        unit.name(),
        summary.warned_ticks,
        summary.saturated_ticks,
        summary.faded_ticks,
        summary.state,
        summary.reason_text,
        summary.digest,
        options.output.display(),
    );
    print(text.as_bytes())
}

/// Millionths printed with six decimals: nanometres as millimetres.
struct Millionths(i64);
/// Billionths printed with nine decimals: nanoseconds as seconds.
struct Billionths(i64);

impl std::fmt::Display for Millionths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (sign, nm) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}.{:06}", nm / 1_000_000, nm % 1_000_000)
    }
}

impl std::fmt::Display for Billionths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (sign, ns) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
    }
}
