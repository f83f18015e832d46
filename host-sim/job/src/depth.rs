//! How deep the cutter is engaged, where the job does not say it: from the level above the contour's down to it.
//!
//! The level above the first one is the top of the stock, which is Z 0 in nearly all programs. A contour at Z 0 or above it
//! has its zero elsewhere: then the step to the next level is the depth, and a contour with one level has to be told.

use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::codes::J040;
use crate::feature::{Plan, Survey};
use crate::job::{Assumed, JobFile};
use crate::post::Post;

/// Steps that differ by less are the same.
const SAME: Offset = Offset::from_um(10);

/// Puts the depth into a job that leaves it open; `level` is that of the feature.
///
/// # Errors
/// `J040` when the program does not show it, `J008` when flutes or stick-out are shorter, and whatever is wrong with the
/// program.
pub(crate) fn settle(job: &mut JobFile, program: &Source, plan: Option<&Plan>, level: u32) -> Result<(), InputError> {
    if !job.open_depth {
        return Ok(());
    }
    let levels: Vec<(Position, u32)> = match plan {
        Some(plan) => plan.passes.iter().filter(|p| !p.spring).filter_map(|p| Some((p.z?, p.lines.first))).collect(),
        None => {
            let runs = Survey::read(job, program)?.runs;
            runs.iter().filter_map(|found| Some((found.run.z?, found.run.lines.first))).take(1).collect()
        }
    };
    let index = usize::try_from(level).unwrap_or(1).saturating_sub(1);
    // What has no height, or is not there, is refused where the contour is read.
    let Some(&(z, line)) = levels.get(index) else { return Ok(()) };
    // The program's own figures, as they stand in it.
    let unit = Post::read(program).unit.told();
    let told = |z: Position| unit.of(height(z));
    let above = index.checked_sub(1).and_then(|before| levels.get(before)).map(|(z, _)| *z);
    let (depth, why) = match above {
        Some(above) if above > z => {
            (above - z, format!("from the level before, Z {}, down to Z {}", told(above), told(z)))
        }
        _ if z < Position::ZERO => (
            Position::ZERO - z,
            format!("from Z 0, taken for the top of the stock, down to Z {} of line {line}", told(z)),
        ),
        _ => match levels.get(index + 1) {
            Some((next, _)) if *next < z => {
                (z - *next, format!("the step from Z {} to the next level, Z {}", told(z), told(*next)))
            }
            _ => {
                let found = format!(
                    "line {line} cuts at Z {}, and how far that is below the stock's top is not known",
                    told(z)
                );
                let expected = "axial_depth_mm in [cut], how deep the cutter is in the stock";
                return Err(J040.error(found, expected).with_keys_in(job.unit).at(program, program.line_span(line)));
            }
        },
    };
    if depth > Offset::from_um(200_000) {
        let found = format!("line {line} cuts at Z {}, {} mm below Z 0", told(z), mm(depth));
        let error = J040.error(found, "axial_depth_mm in [cut], up to 200 mm").told_in(unit).with_keys_in(job.unit);
        return Err(error.at(program, program.line_span(line)));
    }
    fits(job, depth, unit)?;
    let steps =
        levels.windows(2).map(|pair| pair[0].0 - pair[1].0).chain(levels.first().map(|(z, _)| Position::ZERO - *z));
    let uneven = levels.len() > 1 && steps.filter(|s| *s > Offset::ZERO).any(|s| (s - depth).abs() > SAME);
    let why = if uneven { why + "; other levels step by another depth, and are taken to cut as deep" } else { why };
    job.assumed.push(Assumed { key: "cut.axial_depth_mm", value: mm(depth).to_string(), why, line: Some(line) });
    job.numbers.cut.axial_depth = depth;
    job.numbers.correct.band = [Offset::ZERO, depth];
    job.open_depth = false;
    Ok(())
}

/// Flutes and stick-out are at least as long as the cut is deep.
fn fits(job: &JobFile, depth: Offset, unit: Unit) -> Result<(), InputError> {
    let lengths = [
        ("tool.flute_length_mm", job.shank.flute_length),
        ("tool.stickout_mm", job.numbers.tool.cantilever.map(|c| c.length)),
    ];
    let Some((key, length)) = lengths.into_iter().find_map(|(key, l)| Some((key, l.filter(|l| *l < depth)?))) else {
        return Ok(());
    };
    let found = format!("{key} is {} mm, and the program cuts {} mm below the level above it", mm(length), mm(depth));
    let help = "correct it, or say axial_depth_mm in [cut]: how deep the cutter is in the stock";
    let expected = format!("at least {} mm", mm(depth));
    let error =
        InputError::new(truepath_ground::codes::J008, found, expected, help).told_in(unit).with_keys_in(job.unit);
    Err(error.at(job.source(), job.span(key)))
}

fn height(z: Position) -> f64 {
    z.nm() as f64 / 1e6
}
