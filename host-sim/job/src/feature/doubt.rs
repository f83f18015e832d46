//! Finishing contours that may be something else: then the user is asked, and not every one of them is corrected.

use truepath_core::gcode::{Found, Role};
use truepath_core::geometry::{Block, Contour};
use truepath_core::units::{Offset, Real};

use super::survey::Survey;

/// Finishing contours of a program at most; more are lines of a surface, or of an engraving.
const MOST: u32 = 100;
/// Places looked at along a path.
const PLACES: i64 = 32;

/// Why not all of several finishing contours are taken, with what to do about it.
pub(super) fn doubt(runs: &[Found], contours: u32, survey: &Survey, allowance: Offset) -> Option<&'static str> {
    let tools: std::collections::BTreeSet<_> = finishing(runs).map(|found| found.run.tool).collect();
    if tools.len() > 1 {
        return Some(
            "number in [tool] says which of the cutters the job describes: the contours of that tool are taken",
        );
    }
    if contours > MOST {
        return Some(
            "name those that matter with [[feature]], or with (TRUEPATH BEGIN id) … (TRUEPATH END) around them",
        );
    }
    let heads: Vec<&[Block]> = finishing(runs).map(|found| found.blocks(&survey.blocks)).collect();
    let beside = |(at, a): (usize, &&[Block])| heads.iter().skip(at + 1).any(|b| lies_beside(a, b, allowance));
    heads.iter().enumerate().any(beside).then_some(
        "two of them lie beside each other at the distance of the allowance: where one is roughing of the other that runs the other way, name the finishing one with --feature contour-N (as it stands at the end of its line) or [[feature]]; where both are walls, as of a slot, name both with [[feature]]",
    )
}

/// The first run of each finishing contour.
fn finishing(runs: &[Found]) -> impl Iterator<Item = &Found> {
    runs.iter().filter(|found| matches!(found.role, Role::Finish { level: 1, .. }))
}

/// Whether most of a path lies no farther from another one than half as much again as the allowance.
fn lies_beside(path: &[Block], other: &[Block], allowance: Offset) -> bool {
    let (Some(path), Some(other)) = (Contour::new(path), Contour::new(other)) else { return false };
    let reach = allowance + Offset::from_nm(allowance.nm() / 2);
    let near = |k: &i64| {
        let s = path.length().scaled(Real::ratio(*k, PLACES));
        let Some(place) = path.at(s, 0) else { return false };
        let mut least = Offset::MAX;
        other.feet(place.point, |foot| least = least.min(foot.left.abs()));
        least <= reach
    };
    2 * (0..PLACES).filter(near).count() as i64 > PLACES
}
