//! The wall error over the height, at nodes along the contour.

use truepath_core::cut::{Loop, Path, Sample, State};
use truepath_core::units::{Offset, Real};
use truepath_correction::parallel_walls::walls_at;
use truepath_ground::units::{float, mm, rounded};

use super::column::FINE;
use super::kept::Kept;
use super::{Column, Heights};

/// The samples of the contour itself.
pub(super) fn samples<'a>(path: &Path<'a>) -> &'a [Sample] {
    &path.samples()[path.first()..path.first() + path.count()]
}

/// Heights: the tip, the top of the engaged depth, and between them every eighth.
pub(super) const HEIGHTS: usize = 9;

/// A height as a fraction of the engaged depth.
pub(super) fn fraction(k: usize) -> f64 {
    k as f64 / (HEIGHTS - 1) as f64
}

/// The wall errors that states of the elastic loop leave: node after node, in each every height; NaN where no wall stands.
pub(super) fn errors_at_heights(machine: &Loop, states: &[State], residual: &[Offset], kept: &Kept) -> Vec<f64> {
    let path = machine.path;
    let contour = samples(path);
    let heights: [Real; HEIGHTS] = std::array::from_fn(|row| Real::ratio(row as i64, HEIGHTS as i64 - 1));
    let standing: Vec<usize> = kept.nodes().filter(|i| contour[*i].on_wall).map(|i| path.first() + i).collect();
    let mut walls = standing.iter().zip(walls_at(machine, states, heights, &standing)).peekable();
    let each = |i: usize| {
        let wall = walls.next_if(|(index, _)| **index == path.first() + i);
        let beside = residual.get(i).copied().unwrap_or_default();
        wall.map_or([None; HEIGHTS], |(_, wall)| wall).map(|wall| wall.map_or(f64::NAN, |wall| mm(wall.error + beside)))
    };
    kept.nodes().flat_map(each).collect()
}

/// Wall errors over the height of the passes of a page: before, milled, after.
pub(super) type OfPasses = [Option<Vec<f64>>; 3];

/// The errors of the passes; `None` where no pass has a wall that varies over the height.
pub(super) fn heights(path: &Path, kept: &Kept, passes: OfPasses) -> Option<Heights> {
    of_depth(float(path.setup().axial_depth), kept, passes)
}

/// The same, of an engaged depth in mm.
pub(super) fn of_depth(depth_mm: f64, kept: &Kept, passes: OfPasses) -> Option<Heights> {
    let varies = |errors: &[f64]| {
        let (nodes, _) = errors.as_chunks::<HEIGHTS>();
        nodes.iter().any(|node| node.iter().any(|e| (e - node[0]).abs() > 1e-9))
    };
    if !passes.iter().flatten().any(|errors| varies(errors)) {
        return None;
    }
    let [before, milled, after] = passes.map(|errors| errors.map(|errors| Column::of(errors, FINE)));
    Some(Heights {
        z_mm: (0..HEIGHTS).map(|k| rounded(depth_mm * fraction(k), 6)).collect(),
        stride: kept.stride(),
        before,
        milled,
        after,
    })
}
