//! The depths of a feature: what was designed from the probed one is written for all that cut the same.
//!
//! A depth is corrected along when it follows the same path with the same feeds, speed and cut. Spring passes and
//! roughing are never corrected.

use truepath_core::cut::Path;
use truepath_ground::diagnostics::Failure;

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

/// Why the correction of one depth does not hold at another.
fn difference(pass: &Pass, path: &Path, other: &Pass, sampled: &Path) -> Option<&'static str> {
    let feeds = |pass: &Pass| pass.blocks.iter().map(|b| b.feed).collect::<Vec<_>>();
    if feeds(pass) != feeds(other) {
        Some("its feeds are others")
    } else if pass.core.setup != other.core.setup {
        Some("its spindle speed or direction is another")
    } else if path.count() != sampled.count() {
        Some("its path is rounded differently")
    } else {
        None
    }
}
