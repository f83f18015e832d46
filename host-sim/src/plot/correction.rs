//! A correction along the contour: what is added to the path, and the wall error predicted without and with it.

use super::curve::Curve;
use super::error::uncertainty;
use super::panel::{Panel, panels};
use super::style::{ALONG_X, INK_ALONG_Y};
use super::view::View;
use super::wall::Wall;
use crate::diagnostics::Failure;
use crate::report::CorrectionRow;

/// Draws it.
///
/// # Errors
/// As [`panels`].
pub fn correction(view: &View, rows: &[CorrectionRow]) -> Result<Vec<u8>, Failure> {
    let over = |f: fn(&CorrectionRow) -> f64| rows.iter().map(|r| (r.s_mm, f(r))).collect::<Vec<_>>();
    let path =
        vec![Curve::new("along X", ALONG_X, over(|r| r.dx_mm)), Curve::new("along Y", INK_ALONG_Y, over(|r| r.dy_mm))];
    let errors = Wall::of_correction(rows).map(|wall| Curve::new(&*wall.name, wall.ink, wall.errors()));
    let mut wall = Panel::new("wall error (mm)", errors.into());
    wall.band = Some(uncertainty(rows));
    panels(view, "Correction of the path and predicted wall", &[Panel::new("correction (mm)", path), wall])
}
