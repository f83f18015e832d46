//! Further touches: from what was measured so far to the places that tell most of the part that is cut next.

use truepath_core::correct::{Law, Node};
use truepath_core::cut::Path;
use truepath_core::job;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::units::mm;
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use crate::codes::Q002;
use crate::correct::{as_its_points_tell, identify_beside};
use crate::correction::{DesignRequest, Identification, design_correction};
use crate::feeds;
use crate::learn::refuse_feeds;
use crate::learning::{History, Part, PartPoints, joint, refuse_uncorrected};
use crate::told::{self, Told};
use crate::verification::{Measured, Plan, Settings, WallSensitivity, plan_next};

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
    let (known, along, discrepancy) = identify_beside(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let path = sampled.with_law(known.law());
    let table = known.table();
    let machine = known.machine(&path, &table);
    let law = job::law(&pass.core, &machine, &measurement.contacts);
    let request = DesignRequest { beside: &along, ..DesignRequest::of(law) };
    // The wall that counts is cut at the feeds the correction is for.
    let feeds = feeds::planned(pass, &machine, &known, true, &[Route::Program])?;
    let mut fed = PathBuffer::default();
    let to_cut = pass.sample_fed(&mut fed, feeds.schedule.as_ref())?.with_law(known.law());
    let machine = known.machine(&to_cut, &table);
    let correction = design_correction(pass, &machine, &known, &request, |share| progress(0.2 + 0.3 * share))?;
    let goal =
        WallSensitivity::of(&to_cut, &known, &correction.wanted, &correction.nodes, &mut |s| progress(0.5 + 0.2 * s));
    let touched = places(measurement);
    let open = discrepancy.map(|discrepancy| discrepancy.open(&sampled, 0, &known.core));
    let measured = Measured {
        identified: &known,
        path: &path,
        nodes: &[],
        is_next: false,
        wall: &goal,
        touched_mm: &touched,
        open: open.as_ref(),
    };
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
    let pass = &as_parts_tell(pass, &parts)?;
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let points: Option<Vec<PartPoints>> = parts.iter().map(|part| PartPoints::of(part, &sampled)).collect();
    let nodes = history.next.correction.nodes().filter(|nodes| nodes.len() == sampled.count());
    let (Some(points), Some(nodes)) = (points, nodes) else { return Err(other_contour(&sampled).into()) };
    if let (true, Some((newest, earlier @ [_, ..]))) = (measurement.is_some(), points.split_last()) {
        let before = joint(pass, &sampled, earlier, &[], None, &mut |share| progress(0.2 * share));
        refuse_uncorrected(&sampled, newest, &before, pass.unit())?;
    }
    let joint = joint(pass, &sampled, &points, &[], None, &mut |share| progress(0.2 + 0.3 * share));
    let observations: Vec<_> = joint.observations.into_iter().flatten().collect();
    joint.core.check(&observations).map_err(|error| pass.refused(&error))?;
    let known = Identification { core: joint.core, observations };
    let path = sampled.with_law(known.law());
    let touched = measurement.map(places).unwrap_or_default();
    let goal = goal(pass, &path, &known, &nodes, &mut |share| progress(0.5 + 0.2 * share));
    let is_next = measurement.is_none();
    let open = joint.beside.map(|beside| beside.discrepancy.open(&sampled, 0, &known.core));
    let measured = Measured {
        identified: &known,
        path: &path,
        nodes: &nodes,
        is_next,
        wall: &goal,
        touched_mm: &touched,
        open: open.as_ref(),
    };
    let plan = plan_next(pass, settings, &measured, &mut |share| progress(0.7 + 0.3 * share))?;
    Ok(Plan { correction: history.correction(), ..plan })
}

/// The pass as the points of its parts have it, which is how `learn` will see it.
fn as_parts_tell(pass: &Pass, parts: &[Part]) -> Result<Pass, Failure> {
    let heard = told::passes(&[pass], false, &|_, path| {
        let points = |part| PartPoints::of(part, path).ok_or_else(|| other_contour(path).into());
        parts.iter().map(|part| points(part).map(Told::from)).collect()
    })?;
    Ok(heard.passes.into_iter().next().unwrap_or_else(|| pass.clone()))
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
