//! The depths of a feature: what was designed from the probed one is written for all that cut the same.
//!
//! A depth is corrected along when it follows the same path with the same feeds, speed and cut. Spring passes and
//! roughing are never corrected.

use truepath_core::cut::Path;
use truepath_core::job::ContourPass;
use truepath_core::probe::MOST_ALIKE;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;

use crate::job::JobFile;
use crate::pass::{Pass, PathBuffer};

/// What became of the depths.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    /// Numbers of those that were written, in the order of the program.
    pub written: Vec<u32>,
    /// Why others were not.
    pub left: Vec<String>,
}

/// Gives every depth that cuts as `pass` does to `write`, in the order of the program, with its own path. A pass
/// without a feature is its only depth, number 1.
///
/// # Errors
/// What `write` answers.
pub fn each(
    pass: &Pass,
    path: &Path,
    mut write: impl FnMut(u32, &Pass, &Path) -> Result<(), Failure>,
) -> Result<Levels, Failure> {
    let own = pass.level();
    let mut levels = Levels::default();
    for number in pass.plan.as_ref().map_or_else(|| vec![own], |plan| plan.levels()) {
        if number == own {
            write(number, pass, path)?;
            levels.written.push(number);
            continue;
        }
        let mut other = pass.at_level(number)?;
        if let Some(surface) = &pass.surface {
            // The earlier pass left the same at every depth that it cut alike.
            other = other.over(surface.clone())?;
        }
        let mut buffer = PathBuffer::default();
        let sampled = other.sample(&mut buffer)?.with_law(path.setup().law);
        match difference(pass, path, &other, &sampled) {
            None => {
                write(number, &other, &sampled)?;
                levels.written.push(number);
            }
            Some(what) => levels.left.push(format!(
                "pass {number} of the feature (lines {}-{}) is not corrected: {what}",
                other.core.contour.lines.first, other.core.contour.lines.last
            )),
        }
    }
    Ok(levels)
}

/// The finishing passes at all depths of the feature of a pass, in the order of the program.
///
/// # Errors
/// As [`Pass::at_level`].
pub fn depths(pass: &Pass) -> Result<Vec<Pass>, Failure> {
    let levels = pass.plan.as_ref().map(|plan| plan.levels()).unwrap_or_default();
    if levels.len() < 2 {
        return Ok(vec![pass.clone()]);
    }
    levels.into_iter().map(|level| pass.at_level(level)).collect()
}

/// Tips of the other depths that are cut as `pass` is, above its own, the nearest first; at most as many as count.
///
/// # Errors
/// As [`depths`].
pub fn alike(pass: &Pass) -> Result<Vec<Offset>, Failure> {
    Ok(among(pass, &depths(pass)?))
}

/// The same, of `depths`.
fn among(pass: &Pass, depths: &[Pass]) -> Vec<Offset> {
    let others = depths.iter().filter(|other| other.level() != pass.level() && other_cut(pass, other).is_none());
    let above = others.map(|other| other.core.contour.z - pass.core.contour.z);
    let mut tips: Vec<Offset> = above.filter(|above| *above != Offset::ZERO).collect();
    tips.sort_by_key(|tip| tip.abs());
    tips.truncate(MOST_ALIKE);
    tips
}

/// The compact form of a pass's job for a device that makes its own image: the device does not search, it is told which run
/// of the program the pass is, and at which depths points count.
///
/// # Errors
/// As [`depths`] and [`JobFile::compact`].
pub fn compact(pass: &Pass) -> Result<Vec<u8>, Failure> {
    let mut job: JobFile = pass.job.clone();
    job.numbers = with_alike(pass, &depths(pass)?).job;
    job.compact()
}

/// What the core knows of a pass, with those of `depths` that are cut alike: points on their walls are of this one as well.
pub fn with_alike(pass: &Pass, depths: &[Pass]) -> ContourPass {
    let mut core = pass.core.clone();
    if let Some(part) = &mut core.job.part {
        for (slot, tip) in part.alike.iter_mut().zip(among(pass, depths)) {
            *slot = tip;
        }
    }
    core
}

/// Why the correction of one depth does not hold at another.
fn difference(pass: &Pass, path: &Path, other: &Pass, sampled: &Path) -> Option<&'static str> {
    let rounded = (path.count() != sampled.count()).then_some("its path is rounded differently");
    other_cut(pass, other).or(rounded)
}

/// What is another at another depth along the same path; `None` where both are cut alike.
fn other_cut(pass: &Pass, other: &Pass) -> Option<&'static str> {
    let feeds = |pass: &Pass| pass.blocks.iter().map(|b| b.feed).collect::<Vec<_>>();
    if feeds(pass) != feeds(other) {
        Some("its feeds are others")
    } else if pass.core.setup != other.core.setup {
        Some("its spindle speed or direction is another")
    } else {
        None
    }
}
