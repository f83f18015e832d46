//! A program on the virtual machine as a whole: every run that it makes along the wall of a pass, in order, on one part.
//!
//! Which runs these are is seen from where they go, not from what the program says of them: whatever the feature's tool does
//! within the stock and 3 mm of the nominal path, in either direction, at any depth. Levels, radial steps, spring passes and
//! runs in the other direction are all of one part.

use truepath_core::units::Real;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::{float, mm};
use truepath_job::feature::Survey;
use truepath_job::levels;
use truepath_job::pass::Pass;
use truepath_plant as plant;

use crate::codes::S008;
use crate::virtual_mill;

/// Places on an arc are at most this far apart, mm.
const ARC_MM: f64 = 0.05;

/// Cuts the part that a program makes: all its runs along the wall of the pass, in order.
///
/// # Errors
/// What the plant refuses, whatever is wrong with the program, and `S008` for one that does not go along the wall.
pub fn cut(pass: &Pass, machine: &plant::Machine, program: &Source) -> Result<plant::Part, Failure> {
    let tip = z_mm(pass);
    let depth = float(pass.core.setup.axial_depth);
    let mut tips: Vec<f64> = levels::alike(pass)?.into_iter().map(|above| tip + mm(above)).collect();
    tips.push(tip);
    let runs = runs(pass, program)?;
    let (path, set_up) = virtual_mill::path_and_cut(pass, machine)?;
    let stock = mm(pass.core.setup.allowance);
    let along: Vec<&plant::Run> = runs.iter().filter(|run| plant::laps_along(&path, run, stock) > 0).collect();
    if along.is_empty() {
        let found = format!("{} runs, none along the contour", runs.len());
        return Err(S008.error(found, "runs along the contour of the job").in_file(program.name().as_ref()).into());
    }
    let edges_z_mm: Vec<f64> = along.iter().flat_map(|run| run.tip_z_mm.first().copied()).collect();
    let bottom = tips.iter().copied().fold(f64::INFINITY, f64::min);
    let top = tips.iter().copied().fold(f64::NEG_INFINITY, f64::max) + depth;
    // What deeper runs cut below the wall pushes them away from it.
    let stock_from_z_mm = edges_z_mm.iter().copied().fold(bottom, f64::min);
    let heights = plant::Heights { stock_from_z_mm, edges_z_mm, ..plant::Heights::of(bottom, top) };
    let refused = |error: plant::PlantError| virtual_mill::refused(&error);
    let mut part = plant::Part::new(&path, &set_up, machine, &heights).map_err(refused)?;
    for run in along {
        part.cut(run).map_err(refused)?;
    }
    Ok(part)
}

/// How often a program goes along the wall of the pass.
///
/// # Errors
/// Whatever is wrong with the program.
pub fn laps(pass: &Pass, program: &Source) -> Result<usize, Failure> {
    let path = virtual_mill::nominal(pass)?;
    let stock = mm(pass.core.setup.allowance);
    let runs = runs(pass, program)?;
    Ok(runs.iter().map(|run| plant::laps_along(&path, run, stock)).sum())
}

fn z_mm(pass: &Pass) -> f64 {
    pass.core.contour.z.nm() as f64 / 1e6
}

/// The runs of a program with the tool of the pass.
fn runs(pass: &Pass, program: &Source) -> Result<Vec<plant::Run>, Failure> {
    let survey = Survey::read(&pass.job, program)?;
    let numbers = &pass.job.numbers;
    let tool = numbers.tool.number.or(own_tool(pass)?);
    let setup_rpm = float(pass.core.setup.spindle_rpm);
    let mut runs = Vec::new();
    for found in &survey.runs {
        let Some(z) = found.run.z else { continue };
        if found.run.tool.zip(tool).is_some_and(|(its, own)| its != own) {
            continue;
        }
        let (mut centre, mut feeds) = (Vec::new(), Vec::new());
        for block in found.blocks(&survey.blocks) {
            let arc = matches!(block.curve.shape(), truepath_core::geometry::Shape::Arc { .. });
            let pieces = if arc { (mm(block.curve.length()) / ARC_MM).ceil().max(1.0) as i64 } else { 1 };
            let skip = i64::from(!centre.is_empty());
            let feed = numbers.cut.feed_mm_per_min.map_or(float(block.feed), float);
            for k in skip..=pieces {
                centre.push(virtual_mill::coordinates(block.curve.point(Real::ratio(k, pieces))));
                feeds.push(feed);
            }
        }
        let rpm = match (numbers.cut.spindle_rpm, found.run.speed) {
            (None, Some(speed)) if speed > Real::ZERO => float(speed),
            _ => setup_rpm,
        };
        let tip_z_mm = vec![z.nm() as f64 / 1e6; centre.len()];
        runs.push(plant::Run { centre, tip_z_mm, feed_mm_per_min: feeds, spindle_rpm: rpm });
    }
    Ok(runs)
}

/// The tool in the spindle where the job's own program has the contour.
fn own_tool(pass: &Pass) -> Result<Option<u32>, Failure> {
    let own = pass.core.contour.lines;
    let survey = Survey::read(&pass.job, &pass.program)?;
    let found = survey.runs.iter().find(|found| found.run.lines.first <= own.first && found.run.lines.last >= own.last);
    Ok(found.and_then(|found| found.run.tool))
}
