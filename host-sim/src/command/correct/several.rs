//! `correct` for several contours of one program: one probe file, one machine, one corrected program, one report.

use std::fmt::Write;
use std::path::Path as FilePath;

use truepath_correction::correct::{MeasuredWall, correct_every};
use truepath_correction::learning::History;
use truepath_correction::remarks::said_of_every;
use truepath_correction::summary::{ContourSummary, CorrectSummary};
use truepath_correction::warnings::misread;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::Route;
use truepath_job::pass::Pass;
use truepath_report::page::render_all;
use truepath_report::pages::{self, Points};

use super::super::correction_files::{
    FILES, HISTORY, commit, contour_folder, contour_name, write_contour, write_program,
};
use super::super::history::refuse_replacing;
use super::super::readings::{Readings, apart, contours_apart};

/// Corrects the walls that were touched, and leaves the others as they are.
pub(super) fn run(
    walls: Vec<Pass>,
    readings: &Readings,
    (output, force, route): (&FilePath, bool, Option<Route>),
    progress: &mut dyn FnMut(f64),
) -> Result<CorrectSummary, Failure> {
    let measured = readings.of_every(walls)?;
    let folder = OutputFolder::create(output, force, FILES)?;
    let (touched, untouched): (Vec<_>, Vec<_>) = measured.iter().partition(|(_, m)| !m.contacts.is_empty());
    let mut remarks = Vec::new();
    for (pass, measurement) in touched.iter().copied() {
        let history = output.join(contour_folder(pass)).join(HISTORY);
        refuse_replacing(&history, readings.path(), pass, measurement)?;
        let mut said = measurement.remarks(&measurement.source);
        said.extend(misread(pass, false, &measurement.contacts));
        remarks.push(said);
    }
    let walls: Vec<MeasuredWall> = touched
        .iter()
        .zip(&remarks)
        .map(|((pass, measurement), remarks)| MeasuredWall { pass, measurement, remarks })
        .collect();
    let routes = [route.or(touched.first().map(|(pass, _)| pass.job.route)).unwrap_or_default()];
    let mut corrected = correct_every(&walls, &routes, progress)?;
    for (wall, done) in walls.iter().zip(&mut corrected) {
        done.summary.warnings.extend(apart(wall.pass, wall.measurement, &done.identified)?);
    }

    let mut warnings = match corrected.first() {
        Some(done) => {
            let measured: Vec<_> = touched.iter().map(|(pass, measurement)| (pass, measurement)).collect();
            contours_apart(&measured, &done.identified)?
        }
        None => Vec::new(),
    };
    let mut pages = Vec::new();
    let mut contours = Vec::new();
    for (pass, measurement) in &untouched {
        let name = contour_name(pass);
        let lines = pass.core.contour.lines;
        warnings.push(format!(
            "{name} (lines {}-{}) stays as it is: nothing was measured on its wall. Touch it with the program of truepath probe, or correct it alone with --feature",
            lines.first, lines.last
        ).into());
        warnings.extend(measurement.remarks(&measurement.source));
        contours.push(ContourSummary {
            contour: name,
            corrected: false,
            lines: [lines.first, lines.last],
            summary: None,
        });
    }
    for ((pass, measurement), done) in touched.iter().copied().zip(&corrected) {
        let (name, place, lines) = (contour_name(pass), contour_folder(pass), pass.core.contour.lines);
        let history = History::first(pass, measurement, done)?;
        write_contour(&folder, &place, measurement, done, Some(&history))?;
        folder.write(&format!("{place}summary.json"), &json(&done.summary)?)?;
        pages.push((name.clone(), pages::corrected(pass, measurement, done, Points::ThisPass)?));
        let summary = Some(CorrectSummary { program: None, ..done.summary.clone() });
        contours.push(ContourSummary { contour: name, corrected: true, lines: [lines.first, lines.last], summary });
    }
    contours.sort_unstable_by_key(|contour| contour.lines);
    let said = contours.iter().filter_map(|one| Some((one.contour.as_str(), &one.summary.as_ref()?.warnings[..])));
    warnings.extend(said_of_every(said));
    let summary = CorrectSummary::of_every(contours, warnings);
    let summary = summary.ok_or_else(|| Failure::Internal("no contour was corrected".to_owned()))?;
    if let (Some((pass, _)), Some(done)) = (touched.first(), corrected.first()) {
        write_program(&folder, pass, done)?;
    }
    commit(folder, readings, &summary, &render_all(&pages)?)?;
    Ok(summary)
}

/// A line for each contour.
pub(super) fn table(contours: &[ContourSummary], unit: Unit) -> String {
    let [before, after, sigma] = ["before", "after", "sigma"].map(|of| format!("{of} {}", unit.name()));
    let mut text = format!("{:<24}{:<14}{:>8}{:>12}{:>12}{:>12}\n", "contour", "lines", "points", before, after, sigma);
    for one in contours {
        let lines = format!("{}-{}", one.lines[0], one.lines[1]);
        let _ = match &one.summary {
            Some(s) => writeln!(
                text,
                "{:<24}{lines:<14}{:>8}{:>12.4}{:>12.4}{:>12.4}",
                one.contour,
                s.points_used,
                unit.of(s.max_error_before_mm),
                unit.of(s.max_error_after_mm),
                unit.of(s.max_sigma_mm)
            ),
            None => writeln!(text, "{:<24}{lines:<14}   not touched: stays as it is", one.contour),
        };
    }
    text + "\n"
}
