//! The wall of a part to scale with its error magnified, and below it the error along the contour.

use truepath_chart::chart::{RIGHT, room};
use truepath_chart::curve::{Band, Curve};
use truepath_chart::legend::{Entry, Legend, Sign};
use truepath_chart::page::{picture, thick, title_height, units};
use truepath_chart::panel::{Mark, Panel, along, along_name, columns};
use truepath_chart::style::AFTER;
use truepath_chart::view::{View, short};
use truepath_correction::rows::CorrectionRow;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

use super::part::Part;
use super::wall::{Probed, Wall};

/// Least height, px.
const LEAST: u32 = 320;
/// Height of the diagram below, and its share of a height that is asked for.
const DIAGRAM: f64 = 230.0;
const SHARE: f64 = 0.32;
/// Height of the part to scale, whatever its shape: from that of a narrow strip to that of half a page.
const PART: std::ops::RangeInclusive<f64> = 200.0..=500.0;

/// Walls of one part, the first of which also gives the nominal one; the places that were probed.
///
/// # Errors
/// What the view asks for and cannot be, names that are too long; internal, when it cannot be drawn.
pub fn error(
    view: &View,
    title: &str,
    walls: &[Wall],
    band: Option<Band>,
    probed: &[Probed],
) -> Result<Vec<u8>, Failure> {
    let title = view.titled(title)?;
    walls.iter().try_for_each(|wall| short("a name", &wall.name))?;
    let unit = view.unit;
    // Everything that is drawn is in the unit of the view.
    let walls: Vec<Wall> = walls.iter().map(|wall| wall.said(unit)).collect();
    let probed: Vec<Probed> = probed.iter().map(|p| Probed { place: p.place.said(unit), ..*p }).collect();
    let marks = probed.iter().map(|p| Mark { s_mm: p.place.s_mm, value: p.place.error_mm, outlying: p.outlying });
    let panel = Panel {
        unit: format!("wall error ({})", unit.name()),
        curves: walls.iter().map(|w| Curve::new(&*w.name, w.ink, w.errors())).collect(),
        band,
        marks: marks.collect(),
    };
    let window = view.window(panel.extent().unwrap_or((0.0, 1.0)))?;
    let part = Part::new(&walls, &probed, window, view)?;
    let (width, _) = view.size(LEAST, 0)?;
    let fitting = part.height(f64::from(width)).clamp(*PART.start(), *PART.end());
    let size = view.size((title_height(title) + 40.0 + fitting + DIAGRAM).round() as u32, LEAST)?;
    let (width, height) = (f64::from(size.0), f64::from(size.1));
    let banded = panel.band.as_ref().map(|b| Entry { sign: Sign::Band, colour: b.colour, text: b.name.clone() });
    let top = title_height(title);
    let lower = if view.height.is_some() { (height - top) * SHARE } else { DIAGRAM };
    // How many rows the legend takes is known only with the scale, which depends on it a little.
    let upper = |legend: f64| height - top - lower - legend;
    // The numbers of the diagram below need room as well.
    let least = room([&panel.scale(window, columns(thick(width)))]);
    let (_, _, left, per_px) = part.axes(width, upper(20.0), least);
    let rows = part.legend(banded.clone(), per_px, width - left - RIGHT).height();
    let (x, y, left, per_px) = part.axes(width, upper(rows), least);
    let legend = part.legend(banded, per_px, width - left - RIGHT);
    picture(size, title, |root| {
        legend.draw(root, left, top)?;
        let area = |from: f64, high: f64| root.clone().shrink((0, units(from)), (units(width), units(high)));
        part.draw(&area(top + rows, upper(rows)), left, (&x, &y), per_px)?;
        let below = area(height - lower, lower);
        let along = along(window);
        panel.draw(&below, &Legend::default(), left, (&along, window), Some(&along_name(view.unit)))
    })
}

/// The predicted wall without and with a correction.
///
/// # Errors
/// As [`error`].
pub fn predicted_error(view: &View, rows: &[CorrectionRow], probed: &[Probed]) -> Result<Vec<u8>, Failure> {
    error(view, "The wall as the model sees it", &Wall::of_correction(rows), Some(uncertainty(rows, view.unit)), probed)
}

/// Two standard deviations to either side of what is predicted with a correction, in a unit.
pub(super) fn uncertainty(rows: &[CorrectionRow], unit: Unit) -> Band {
    let edge = |r: &CorrectionRow| {
        let error = r.predicted_error_after_mm.unwrap_or(f64::NAN);
        let wide = 2.0 * r.sigma_mm.unwrap_or(f64::NAN);
        (unit.said(r.s_mm), unit.said(error - wide), unit.said(error + wide))
    };
    Band { name: "±2σ with correction".to_owned(), edges: rows.iter().map(edge).collect(), colour: AFTER }
}
