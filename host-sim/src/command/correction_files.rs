//! The files of a correction: what `correct` and `learn` may write, and what a correction in memory holds beside its summary.

use truepath_chart::view::View;
use truepath_correction::correct::CorrectedPass;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::OutputFolder;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::pages::REPORT;
use truepath_report::plot::predicted_error;
use truepath_report::{correction_csv, points_csv, wall_csv};

/// The parts so far; see [`learning`](truepath_correction::learning).
pub(super) const HISTORY: &str = "history.json";
/// The measured part as it was milled; `learn` writes it.
pub(super) const MILLED: &str = "milled.csv";
/// Files that these commands may write.
pub(super) const FILES: &[&str] = &[
    HISTORY,
    "corrected.nc",
    "difference.txt",
    "correction.tpi",
    "correction.csv",
    MILLED,
    "wall.csv",
    "points.csv",
    "summary.json",
    "correction.svg",
    REPORT,
    "probe-raw.txt",
    "first-pass-surface.csv",
    "correction-pass-#.tpi",
];

/// Writes what a correction in memory holds beside its summary.
pub(super) fn write(
    folder: &OutputFolder,
    pass: &Pass,
    measurement: &Measurement,
    done: &CorrectedPass,
) -> Result<(), Failure> {
    if let Some(text) = &done.program {
        folder.write("corrected.nc", text)?;
        folder.write("difference.txt", done.summary.difference(pass.program.name()).as_bytes())?;
    }
    if let Some(bytes) = &done.image {
        folder.write("correction.tpi", bytes)?;
    }
    for (number, bytes) in &done.other_images {
        folder.write(&format!("correction-pass-{number}.tpi"), bytes)?;
    }
    folder.write("correction.csv", &correction_csv(&done.rows)?)?;
    folder.write("wall.csv", &wall_csv(&done.rows)?)?;
    folder.write("points.csv", &points_csv(measurement, &done.identified.observations)?)?;
    folder.write("correction.svg", &predicted_error(&View::default(), &done.rows, &[])?)?;
    Ok(())
}
