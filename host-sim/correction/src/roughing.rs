//! How far the roughing cutter was pushed away, where it is the cutter of the pass itself: what it left more on the wall than its paths say.
//!
//! The machine that the points of the finished wall find pushes it as the model has it, deepest where most is in the way: in an inside corner the
//! finishing pass then meets stock that is larger twice over. Stock and machine go with each other, so both are found in turn until
//! the stock stays what it is.
//!
//! Limits: runs of the same diameter as the pass, at the feeds of the program; their depth is the step from run to run; into the full where no run
//! of the program came before; the mean over the height.

use rayon::prelude::*;
use truepath_core::cut::Path;
use truepath_core::job::Identified;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_job::roughed_stock::Pushed;

use crate::discrepancy::{PartCut, plain};
use crate::force_tables::force_table;
use crate::identification::asked;
use crate::surface::predicted::{COUNT, errors};

/// Places along a run at which it is told how far it was pushed, about as far from each other, mm.
const APART_MM: f64 = 0.5;
/// Runs of which it is told, the last ones before the pass.
const MOST_RUNS: usize = 40;

/// The passes over the stock that their roughing leaves, pushed by the machine that the points of the cuts find, and by how much the
/// stock changed at most, mm; `None` where no pass is of that kind.
///
/// # Errors
/// What is wrong with a program.
pub fn pushed(walls: &[&Pass], groups: &[(&Pass, Vec<PartCut<'_>>)]) -> Result<Option<(Vec<Pass>, f64)>, Failure> {
    if !walls.iter().any(|pass| pass.is_roughed_by_its_cutter()) {
        return Ok(None);
    }
    let found: Vec<Identified> = groups
        .par_iter()
        .map(|(pass, cuts)| plain(pass, asked(pass.core.job.force.model), cuts, &mut |_| ()).core)
        .collect();
    let (mut passes, mut most) = (Vec::new(), 0.0f64);
    for (k, pass) in walls.iter().enumerate() {
        let machine = found.get(k).or(found.first());
        let told = match machine.filter(|_| pass.is_roughed_by_its_cutter()) {
            Some(machine) => of_runs(pass, machine)?,
            None => {
                passes.push((*pass).clone());
                continue;
            }
        };
        let (over, change) = pass.over_pushed(told)?;
        most = most.max(change);
        passes.push(over);
    }
    Ok(Some((passes, most)))
}

/// By how much every run that leaves the stock of a pass was pushed away by a machine.
fn of_runs(pass: &Pass, machine: &Identified) -> Result<Vec<Pushed>, Failure> {
    let runs = pass.roughing_runs()?;
    let of = |number: &u32| {
        // A run that is no contour, for instance on an arc tighter than the cutter, is taken as it is programmed.
        let rough = pass.roughed_by(*number).ok()?;
        let mut buffer = PathBuffer::default();
        let path = rough.sample(&mut buffer).ok()?.with_law(machine.law);
        Some(rough.pushed(&path, along(&path, machine).into_iter()))
    };
    Ok(runs.iter().rev().take(MOST_RUNS).filter_map(of).collect())
}

/// What a run leaves more on its wall than its path says, mean over the height, mm, at samples of its path.
fn along(path: &Path, machine: &Identified) -> Vec<(usize, f64)> {
    let table = force_table(&machine.fit.parameters);
    let cut = machine.machine(path, &table);
    let spacing = (mm(path.length()) / path.count().max(1) as f64).max(1e-3);
    let every = ((APART_MM / spacing) as usize).max(1);
    let places: Vec<usize> = (path.first()..path.first() + path.count()).step_by(every).collect();
    let all = errors(&cut, &[], &places);
    let mean = |column: &[f64]| column.iter().sum::<f64>() / COUNT as f64;
    places.iter().copied().zip(all.chunks(COUNT).map(mean)).collect()
}
