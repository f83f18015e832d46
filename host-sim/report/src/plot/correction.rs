//! A correction along the contour: what is added to the path, and the wall error predicted without and with it.

use truepath_chart::curve::Curve;
use truepath_chart::panel::{Panel, panels};
use truepath_chart::style::{ALONG_X, INK_ALONG_Y};
use truepath_chart::view::View;
use truepath_correction::rows::CorrectionRow;
use truepath_ground::diagnostics::Failure;

use super::error::uncertainty;
use super::wall::Wall;

/// Draws it.
///
/// # Errors
/// As [`panels`].
pub fn correction(view: &View, rows: &[CorrectionRow]) -> Result<Vec<u8>, Failure> {
    let (unit, name) = (view.unit, view.unit.name());
    let over =
        |f: fn(&CorrectionRow) -> f64| rows.iter().map(|r| (unit.said(r.s_mm), unit.said(f(r)))).collect::<Vec<_>>();
    let path =
        vec![Curve::new("along X", ALONG_X, over(|r| r.dx_mm)), Curve::new("along Y", INK_ALONG_Y, over(|r| r.dy_mm))];
    let errors = Wall::of_correction(rows).map(|wall| Curve::new(&*wall.name, wall.ink, wall.said(unit).errors()));
    let mut wall = Panel::new(format!("wall error ({name})"), errors.into());
    wall.band = Some(uncertainty(rows, unit));
    panels(view, "Correction of the path and predicted wall", &[Panel::new(format!("correction ({name})"), path), wall])
}
