//! The files of a correction: what `correct` and `learn` may write, and what a correction in memory holds beside its summary.

use serde::Serialize;
use truepath_chart::view::View;
use truepath_correction::correct::CorrectedPass;
use truepath_correction::learning::History;
use truepath_correction::summary::corrected_name;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::{OutputFolder, json};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::pages::REPORT;
use truepath_report::plot::predicted_error;
use truepath_report::{correction_csv, points_csv, wall_csv};

pub(super) use truepath_correction::learning::HISTORY;

use super::readings::{DIMENSIONS, PROBE, Readings};

/// The measured part as it was milled; `learn` writes it.
pub(super) const MILLED: &str = "milled.csv";
/// Files that these commands may write.
pub const FILES: &[&str] = &[
    HISTORY,
    "corrected.nc",
    "*.corrected*",
    "difference.txt",
    "correction.tpi",
    "correction.csv",
    MILLED,
    "wall.csv",
    "points.csv",
    "summary.json",
    "correction.svg",
    REPORT,
    PROBE,
    DIMENSIONS,
    "first-pass-surface.csv",
    "correction-pass-#.tpi",
    CONTOURS,
];

/// The folder of what belongs to one of several contours.
pub(super) const CONTOURS: &str = "contours/";

/// Writes the corrected program, where there is one.
pub(super) fn write_program(folder: &OutputFolder, pass: &Pass, done: &CorrectedPass) -> Result<(), Failure> {
    if let Some(text) = &done.program {
        folder.write("corrected.nc", text)?;
        // The same under a name that tells it from other parts at the machine.
        folder.write(&corrected_name(pass.program.name()), text)?;
        folder.write("difference.txt", done.summary.difference(pass.program.name()).as_bytes())?;
    }
    Ok(())
}

/// Writes what a correction in memory holds beside its summary and its program, and the history of the part, in the folder
/// `place` of the outputs.
pub(super) fn write_contour(
    folder: &OutputFolder,
    place: &str,
    measurement: &Measurement,
    done: &CorrectedPass,
    history: Option<&History>,
) -> Result<(), Failure> {
    let write = |name: &str, bytes: &[u8]| folder.write(&format!("{place}{name}"), bytes);
    if let Some(bytes) = &done.image {
        write("correction.tpi", bytes)?;
    }
    for (number, bytes) in &done.other_images {
        write(&format!("correction-pass-{number}.tpi"), bytes)?;
    }
    write("correction.csv", &correction_csv(&done.rows)?)?;
    write("wall.csv", &wall_csv(&done.rows)?)?;
    write("points.csv", &points_csv(measurement, &done.identified.observations)?)?;
    write("correction.svg", &predicted_error(&View::in_unit(done.summary.unit), &done.rows, &[])?)?;
    if let Some(history) = history {
        write(HISTORY, &history.text()?)?;
    }
    Ok(())
}

/// Writes what the outputs hold once, whatever the number of contours, and puts all of them in their place.
pub(super) fn commit(
    folder: OutputFolder,
    readings: &Readings,
    summary: &impl Serialize,
    report: &[u8],
) -> Result<(), Failure> {
    readings.keep(&folder)?;
    folder.write("summary.json", &json(summary)?)?;
    folder.write(REPORT, report)?;
    folder.commit()?;
    Ok(())
}

/// The folder of the outputs of one of several contours, by its name where that can be one.
pub(super) fn contour_folder(pass: &Pass) -> String {
    format!("{CONTOURS}{}/", contour_name(pass))
}

/// Where the outputs of a contour are below their folder: in it, or where there are `several` in one of its own.
pub(super) fn contour_place(pass: &Pass, several: bool) -> String {
    if several { contour_folder(pass) } else { String::new() }
}

/// What one of several contours is called in files and tables: its name where that can be a file's, or its number.
pub(super) fn contour_name(pass: &Pass) -> String {
    let plain = |id: &&String| {
        let usual = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
        (1..=64).contains(&id.len()) && id.chars().all(usual)
    };
    let plan = pass.plan.as_ref();
    let id = plan.and_then(|plan| plan.id.as_ref()).filter(plain);
    id.cloned().unwrap_or_else(|| format!("contour-{}", plan.map_or(1, |plan| plan.number)))
}
