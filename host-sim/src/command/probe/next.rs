//! `probe --next`: the places to touch next, given what was measured.
//!
//! | given | touched is | what is known |
//! |---|---|---|
//! | a probe file | the part it is of, which no correction was cut with | that file |
//! | a folder of `correct` or `learn` | the next part, cut with the correction in it | the parts of its history |
//! | both | the part cut with that correction, once more | the parts of its history, and that file |
//! | a folder of `plan`, or of `learn` from there | the next part, cut with the planned program in it | the job |

use std::path::Path as FilePath;

use truepath_core::correct::{Law, Node};
use truepath_core::cut::Path;
use truepath_core::job;
use truepath_correction::codes::{Q002, Q003, Q007};
use truepath_correction::correct::as_its_points_tell;
use truepath_correction::correction::{DesignRequest, Identification, design_correction, identify};
use truepath_correction::feeds;
use truepath_correction::learn::refuse_feeds;
use truepath_correction::learning::{History, Part, PartPoints, joint, refuse_uncorrected};
use truepath_correction::verification::{Measured, Plan, Settings, WallSensitivity, plan_every, plan_next};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::units::mm;
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use crate::command::history::{history_in, holds_planned, planned_in};

/// Plans further touches from files. `progress` is told the share done, 0…1.
///
/// # Errors
/// Neither file nor folder; whatever is wrong with them, a correction beyond the clamp, and as [`plan_next`].
pub(super) fn of_files(
    job: JobFile,
    (probe, from): (Option<&FilePath>, Option<&FilePath>),
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let file = probe.map(Source::read).transpose()?;
    let Some(folder) = from else {
        let Some(file) = file else {
            let help = "give --probe, --from or both";
            return Err(InputError::new(C001, "--next without anything measured", "measured points", help).into());
        };
        let (pass, measurement) = Measurement::of_any_depth(Pass::read(job)?, &file)?;
        let mut plan = next(&pass, &measurement, settings, progress)?;
        plan.warnings.extend(measurement.remarks(&file));
        return Ok(plan);
    };
    if holds_planned(folder) {
        return planned_part(job, folder, settings, progress);
    }
    let pass = Pass::read(job)?;
    let history = history_in(folder, folder)?;
    let level = history.facts.level().filter(|_| pass.job.which.pass.is_none() && pass.plan.is_some());
    let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass).cut_with(history.cut_with());
    let measurement = file.as_ref().map(|file| Measurement::read(&pass, file)).transpose()?;
    let mut plan = next_part(&pass, &history, measurement.as_ref(), settings, progress).map_err(|failure| {
        match (failure, probe) {
            (Failure::Input(error), Some(probe)) if [Q003.code, Q007.code].contains(&error.code()) => {
                error.in_file(probe).into()
            }
            (failure, _) => failure,
        }
    })?;
    plan.warnings.extend(measurement.iter().zip(&file).flat_map(|(m, file)| m.remarks(file)));
    Ok(plan)
}

/// Plans touches of the part cut with the planned program of a folder, of all its contours: at heights that tell the profile, since every
/// height counts.
fn planned_part(
    job: JobFile,
    folder: &FilePath,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let cuts = planned_in(folder, job)?.cuts;
    cuts.iter().try_for_each(|(pass, history)| history.facts.agree(pass))?;
    let narrowest = cuts.iter().map(|(_, history)| history.next.tolerance_mm).reduce(f64::min);
    let settings = Settings { tolerance: settings.tolerance.or(narrowest), ..settings.clone() };
    let program = cuts.first().and_then(|(_, history)| history.program());
    let passes: Vec<Pass> = cuts.into_iter().map(|(pass, _)| pass).collect();
    Ok(Plan { correction: program, ..plan_every(&passes, &settings, progress)? })
}

/// Plans further touches of an uncorrected part that was measured, in memory. `progress` is told the share done, 0…1.
///
/// # Errors
/// Points that do not fit, a correction beyond the clamp, and as [`plan_next`].
pub fn next(
    pass: &Pass,
    measurement: &Measurement,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let pass = &as_its_points_tell(pass.clone(), measurement)?;
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let known = identify(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let path = sampled.with_law(known.law());
    let table = known.table();
    let machine = known.machine(&path, &table);
    let request = DesignRequest::of(job::law(&pass.core, &machine, &measurement.contacts));
    // The wall that counts is cut at the feeds the correction is for.
    let feeds = feeds::planned(pass, &machine, &known, true, &[Route::Program])?;
    let mut fed = PathBuffer::default();
    let to_cut = pass.sample_fed(&mut fed, feeds.schedule.as_ref())?.with_law(known.law());
    let machine = known.machine(&to_cut, &table);
    let correction = design_correction(pass, &machine, &known, &request, |share| progress(0.2 + 0.3 * share))?;
    let goal =
        WallSensitivity::of(&to_cut, &known, &correction.wanted, &correction.nodes, &mut |s| progress(0.5 + 0.2 * s));
    let touched = places(measurement);
    let measured =
        Measured { identified: &known, path: &path, nodes: &[], is_next: false, wall: &goal, touched_mm: &touched };
    plan_next(pass, settings, &measured, &mut |share| progress(0.7 + 0.3 * share))
}

/// Plans touches of the part cut with the correction of a history, which `measurement` is of, if there is one.
/// `progress` is told the share done, 0…1.
///
/// # Errors
/// A history of another cut, points it already holds, of a part without its correction or that do not fit, and as
/// [`plan_next`].
pub fn next_part(
    pass: &Pass,
    history: &History,
    measurement: Option<&Measurement>,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    history.facts.agree(pass)?;
    refuse_feeds(pass)?;
    let mut parts: Vec<Part> = history.parts.iter().filter(|part| !part.set_aside).cloned().collect();
    if let Some(measurement) = measurement {
        let part = Part::new(history.next_number(), measurement, Some(history.next.correction.clone()))?;
        history.refuse_known(&part)?;
        parts.push(part);
    }
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let points: Option<Vec<PartPoints>> = parts.iter().map(|part| PartPoints::of(part, &sampled)).collect();
    let nodes = history.next.correction.nodes().filter(|nodes| nodes.len() == sampled.count());
    let (Some(points), Some(nodes)) = (points, nodes) else { return Err(other_contour(&sampled).into()) };
    if let (true, Some((newest, earlier @ [_, ..]))) = (measurement.is_some(), points.split_last()) {
        let before = joint(pass, &sampled, earlier, &[], None, &mut |share| progress(0.2 * share));
        refuse_uncorrected(&sampled, newest, &before)?;
    }
    let joint = joint(pass, &sampled, &points, &[], None, &mut |share| progress(0.2 + 0.3 * share));
    let observations: Vec<_> = joint.observations.into_iter().flatten().collect();
    joint.core.check(&observations).map_err(|error| pass.refused(&error))?;
    let known = Identification { core: joint.core, observations };
    let path = sampled.with_law(known.law());
    let touched = measurement.map(places).unwrap_or_default();
    let goal = goal(pass, &path, &known, &nodes, &mut |share| progress(0.5 + 0.2 * share));
    let is_next = measurement.is_none();
    let measured =
        Measured { identified: &known, path: &path, nodes: &nodes, is_next, wall: &goal, touched_mm: &touched };
    let plan = plan_next(pass, settings, &measured, &mut |share| progress(0.7 + 0.3 * share))?;
    Ok(Plan { correction: history.correction(), ..plan })
}

fn goal(
    pass: &Pass,
    path: &Path,
    known: &Identification,
    nodes: &[Node],
    progress: &mut dyn FnMut(f64),
) -> WallSensitivity {
    WallSensitivity::of(path, known, &pass.job.numbers.design(Law::Model), nodes, progress)
}

fn places(measurement: &Measurement) -> Vec<f64> {
    measurement.contacts.iter().map(|contact| mm(contact.s)).collect()
}

fn other_contour(path: &Path) -> InputError {
    let help = "correct again with truepath correct";
    let expected = format!("one entry for each of {} samples", path.count());
    InputError::new(Q002, "a correction of the history does not lie along this contour", expected, help)
}
