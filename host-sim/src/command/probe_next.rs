//! `probe --next`: the places to touch next, given what was measured.

use std::path::Path as FilePath;

use truepath_core::job;

use super::feeds;
use crate::correction::{corrected, identified};
use crate::diagnostics::{Failure, Source};
use crate::job::Route;
use crate::measurement::Measurement;
use crate::pass::{Pass, PathBuffer};
use crate::report::mm;
use crate::verification::{Goal, Measured, Plan, Settings, plan_next};

/// Plans further touches of the part that a probe file is of; gives the pass they are on as well. `progress` is told
/// the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with the file, a correction beyond the clamp, and as [`plan_next`].
pub(super) fn of_file(
    pass: Pass,
    file: &FilePath,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let file = Source::read(file)?;
    let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
    let mut plan = next(&pass, &measurement, settings, progress)?;
    plan.warnings.extend(measurement.remarks(&file));
    Ok(plan)
}

/// Plans further touches of an uncorrected part that was measured, in memory. `progress` is told the share done, 0…1.
///
/// # Errors
/// As [`of_file`].
pub fn next(
    pass: &Pass,
    measurement: &Measurement,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let known = identified(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let path = sampled.with_law(known.law());
    let table = known.table();
    let machine = known.machine(&path, &table);
    let law = job::law(&pass.core, &machine, &measurement.contacts);
    // The wall that counts is cut at the feeds the correction is for.
    let feeds = feeds::planned(pass, &machine, &known, true, &[Route::Program])?;
    let mut fed = PathBuffer::default();
    let to_cut = pass.sample_fed(&mut fed, feeds.schedule.as_ref())?.with_law(known.law());
    let machine = known.machine(&to_cut, &table);
    let correction = corrected(pass, &machine, &known, law, |share| progress(0.2 + 0.3 * share))?;
    let goal = Goal::of(&to_cut, &known, &correction.wanted, &correction.nodes, &mut |s| progress(0.5 + 0.2 * s));
    let touched: Vec<f64> = measurement.contacts.iter().map(|contact| mm(contact.s)).collect();
    let measured =
        Measured { identified: &known, path: &path, nodes: &[], is_next: false, goal: &goal, touched_mm: &touched };
    plan_next(pass, settings, &measured, &mut |share| progress(0.7 + 0.3 * share))
}
