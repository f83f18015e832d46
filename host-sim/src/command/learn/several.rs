//! `learn` for several contours of one program: a history of each, one machine, one corrected program.

use std::fmt::Write;
use std::path::Path as FilePath;

use truepath_correction::as_milled::AsMilled;
use truepath_correction::codes::Q010;
use truepath_correction::learn::{ContourLearned, CorrectedWall, LearnSummary, learn_every};
use truepath_correction::remarks::said_of_every;
use truepath_correction::surface::touched::TouchedSurface;
use truepath_ground::diagnostics::Failure;
use truepath_ground::files;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::Route;
use truepath_job::pass::Pass;
use truepath_report::correction_csv;
use truepath_report::page::render_all;
use truepath_report::pages::learned;

use super::super::correction_files::{
    FILES, HISTORY, MILLED, commit, contour_folder, contour_name, write_contour, write_program,
};
use super::super::history::history_in;
use super::super::readings::Readings;

/// What was measured, and where the corrections of the part are.
pub(super) struct Measured<'a> {
    /// What was measured of it.
    pub(super) readings: &'a Readings,
    /// The folder of its corrections.
    pub(super) from: &'a FilePath,
    /// Its number, where it is said.
    pub(super) part: Option<u32>,
    /// Whether the next part is cut with a new cutter.
    pub(super) new_cutter: bool,
}

/// Learns from every contour that has a history.
pub(super) fn run(
    walls: Vec<Pass>,
    measured: &Measured<'_>,
    (output, force, route): (&FilePath, bool, Option<Route>),
    progress: &mut dyn FnMut(f64),
) -> Result<LearnSummary, Failure> {
    let Measured { readings, from, part, new_cutter } = *measured;
    let (mut passes, mut histories, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for pass in walls {
        let folder = from.join(contour_folder(&pass));
        if !files::exists(&folder.join(HISTORY)) {
            left.push(contour_name(&pass));
            continue;
        }
        let history = history_in(&folder, from)?.of_part(part)?.before_a_new_cutter(new_cutter);
        let level = history.facts.level().filter(|_| pass.job.which.pass.is_none() && pass.plan.is_some());
        let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass);
        passes.push(pass.cut_with(history.cut_with()));
        histories.push(history);
    }
    if passes.is_empty() {
        // Says which folder is expected.
        history_in(from, from)?;
    }
    let measured = readings.of_every(passes)?;
    if let Some((pass, _)) = measured.iter().find(|(_, measurement)| measurement.contacts.is_empty()) {
        let found = format!("no point is on the wall of {}, which was cut with a correction", contour_name(pass));
        return Err(Q010.error(found, "points on every corrected contour").in_file(readings.path()).into());
    }
    let folder = OutputFolder::create(output, force, FILES)?;
    let remarks: Vec<Vec<Remark>> =
        measured.iter().map(|(_, measurement)| measurement.remarks(&measurement.source)).collect();
    let walls: Vec<CorrectedWall> = measured
        .iter()
        .zip(&histories)
        .zip(&remarks)
        .map(|(((pass, measurement), history), remarks)| CorrectedWall { pass, history, measurement, remarks })
        .collect();
    let route = route.or(measured.first().map(|(pass, _)| pass.job.route)).unwrap_or_default();
    let done = learn_every(&walls, &[route], progress)?;

    let mut warnings: Vec<Remark> = left
        .iter()
        .map(|name| format!("{name} stays as it is: {} has no history of it", from.display()).into())
        .collect();
    let (mut contours, mut pages) = (Vec::new(), Vec::new());
    for (wall, done) in walls.iter().zip(&done) {
        let (name, place) = (contour_name(wall.pass), contour_folder(wall.pass));
        let milled = AsMilled::of(wall.pass, wall.history, &done.corrected)?;
        let summary = LearnSummary {
            correct: done.corrected.summary.clone(),
            verdict: done.verdict.clone(),
            whole_contour_error_mm: milled.whole_contour(),
            whole_surface: milled.surface,
            measured_surface: TouchedSurface::of_measurement(wall.pass, wall.measurement),
            contours: Vec::new(),
        };
        pages.push((name.clone(), learned(wall.pass, wall.measurement, &done.corrected, &milled, &summary)?));
        write_contour(&folder, &place, wall.measurement, &done.corrected, Some(&done.history))?;
        folder.write(&format!("{place}summary.json"), &json(&summary)?)?;
        folder.write(&format!("{place}{MILLED}"), &correction_csv(&milled.rows)?)?;
        contours.push(ContourLearned { contour: name, summary });
    }
    if let (Some(wall), Some(done)) = (walls.first(), done.first()) {
        write_program(&folder, wall.pass, &done.corrected)?;
    }
    let said = contours.iter().map(|one: &ContourLearned| (one.contour.as_str(), &one.summary.correct.warnings[..]));
    warnings.extend(said_of_every(said));
    let summary = LearnSummary::of_every(contours, warnings);
    let summary = summary.ok_or_else(|| Failure::Internal("no contour was learned from".to_owned()))?;
    commit(folder, readings, &summary, &render_all(&pages)?)?;
    Ok(summary)
}

/// A line for each contour.
pub(super) fn table(contours: &[ContourLearned], unit: Unit) -> String {
    let measured = format!("measured {}", unit.name());
    let mut text = format!(
        "{:<24}{:>6}{:>8}{:>14}{:>14}{:>14}\n",
        "contour", "part", "places", measured, "part before", "whole contour"
    );
    for one in contours {
        let v = &one.summary.verdict;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<24}{:>6}{:>8}{:>14.4}{:>14.4}{:>14.4}{}",
            one.contour,
            v.part,
            v.measured_error_mm.places,
            unit.of(v.measured_error_mm.max_mm),
            unit.of(v.previous_error_mm.max_mm),
            unit.of(one.summary.whole_contour_error_mm.max_mm),
            if v.rolled_back { "  rolled back" } else { "" }
        );
    }
    text + "\ncorrection of the next part\n"
}
