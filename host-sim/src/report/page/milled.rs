//! A pass as a virtual machine cut it: columns along its own samples, or along those of the core.
//!
//! The virtual machine samples the path for itself. `simulate` shows its samples as they are, with the digits of `trace.csv`; where
//! two of its passes stand beside a correction, theirs are taken linearly between its samples at the arc lengths of the
//! correction. Limits: a place of the corrected pass belongs to the nominal place nearest to its commanded centre.

use super::heights::{HEIGHTS, fraction, of_depth};
use super::kept::Kept;
use super::model::{Along, FINE, UNIT, columns};
use super::{Column, Contour, PassColumns};
use crate::plant::Milled;
use crate::report::Trace;

/// A single pass with its trace, one row per sample of the nominal path.
pub fn milled(pass: &Milled, trace: &Trace, label: &str) -> Along {
    let (path, cut) = (&pass.path, &pass.cut);
    let kept = Kept::of(path.s_mm.len());
    let column = |of: &dyn Fn(usize) -> f64, decimals| Column::of(kept.indices().map(of), decimals);
    let rows = kept.indices().map(|i| trace.get(i).copied());
    let feeds = column(&|i| cut.feed_at(path.s_mm[i]), 3);
    let contour = Contour {
        s_mm: column(&|i| path.s_mm[i], FINE),
        x_mm: column(&|i| path.centre[i][0], FINE),
        y_mm: column(&|i| path.centre[i][1], FINE),
        nx: Some(column(&|i| path.normal[i][0], UNIT)),
        ny: Some(column(&|i| path.normal[i][1], UNIT)),
        correction_x_mm: None,
        correction_y_mm: None,
        before: Some(PassColumns { feed_mm_per_min: Some(feeds), ..columns(label, rows) }),
        after: None,
    };
    let errors = over_height(pass);
    let nodes = kept.nodes().flat_map(|i| errors.iter().map(move |row| row[i])).collect();
    Along { contour, heights: of_depth(cut.axial_depth_mm, &kept, nodes, None), note: kept.note() }
}

/// Wall errors, for each height those of every nominal sample.
fn over_height(pass: &Milled) -> Vec<Vec<f64>> {
    pass.wall_errors(&(0..HEIGHTS).map(fraction).collect::<Vec<_>>())
}
