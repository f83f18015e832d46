//! The wall unrolled over the depth: how a helix inclines the marks, and the profile along a generatrix.

use plotters::coord::Shift;
use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

use super::{BLUE, FONT, LIGHT, failed};

/// Shades between the deepest and the highest place.
const SHADES: usize = 24;

/// A piece of wall: heights (outer) over places along it.
#[derive(Clone, Debug)]
pub struct Patch<'a> {
    /// Heights above the tip, mm, ascending.
    pub z_mm: &'a [f64],
    /// Places along the wall, mm, ascending.
    pub along_mm: &'a [f64],
    /// Radius less the largest, mm.
    pub deviation_mm: &'a [Vec<f64>],
}

/// Draws the patch and the generatrix through its middle.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn wall(title: &str, patch: &Patch) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (1000, 520)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, 18)).map_err(failed)?;
        let (left, right) = page.split_horizontally(640);
        map(&left, patch)?;
        generatrix(&right, patch)?;
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}

/// First and last of ascending places.
fn ends(places: &[f64]) -> (f64, f64) {
    (places.first().copied().unwrap_or(0.0), places.last().copied().unwrap_or(1.0))
}

fn lowest(patch: &Patch) -> f64 {
    patch.deviation_mm.iter().flatten().copied().fold(-1e-9, f64::min)
}

fn map(panel: &DrawingArea<SVGBackend, Shift>, patch: &Patch) -> Result<(), Failure> {
    let ((x0, x1), (z0, z1)) = (ends(patch.along_mm), ends(patch.z_mm));
    let lowest = lowest(patch);
    let mut chart = ChartBuilder::on(panel)
        .caption(format!("the wall unrolled: dark is deepest, light {:.3} µm higher", -lowest * 1e3), (FONT, 14))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(56)
        .build_cartesian_2d(x0..x1, z0..z1)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("along the wall in the direction of travel, mm")
        .y_desc("height above the tip, mm")
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 13))
        .draw()
        .map_err(failed)?;
    let shade = |level: usize| {
        let share = level as f64 / SHADES as f64;
        let mix = |dark: f64, light: f64| (dark + (light - dark) * share).round() as u8;
        RGBColor(mix(0.0, 245.0), mix(60.0, 240.0), mix(110.0, 215.0)).filled()
    };
    let level = |mean: f64| ((mean / lowest).clamp(0.0, 1.0) * SHADES as f64).round() as usize;
    for (rows, z) in patch.deviation_mm.windows(2).zip(patch.z_mm.windows(2)) {
        let means =
            rows[0].windows(2).zip(rows[1].windows(2)).map(|(low, high)| (low[0] + low[1] + high[0] + high[1]) / 4.0);
        let cells: Vec<(usize, &[f64])> = means.map(level).zip(patch.along_mm.windows(2)).collect();
        // Neighbours of one shade are one rectangle: a picture of a third of the size.
        let runs = cells.chunk_by(|a, b| a.0 == b.0).filter_map(|run| {
            let (first, last) = (run.first()?, run.last()?);
            Some(Rectangle::new([(first.1[0], z[0]), (last.1[1], z[1])], shade(first.0)))
        });
        chart.draw_series(runs).map_err(failed)?;
    }
    Ok(())
}

fn generatrix(panel: &DrawingArea<SVGBackend, Shift>, patch: &Patch) -> Result<(), Failure> {
    let (z0, z1) = ends(patch.z_mm);
    let lowest = lowest(patch) * 1e3;
    let middle = patch.along_mm.len() / 2;
    let mut chart = ChartBuilder::on(panel)
        .caption("along the generatrix in the middle", (FONT, 14))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(40)
        .build_cartesian_2d(lowest * 1.15..-lowest * 0.15, z0..z1)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(LIGHT)
        .x_labels(5)
        .x_desc("radius − largest radius, µm")
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 13))
        .draw()
        .map_err(failed)?;
    let line = patch.z_mm.iter().zip(patch.deviation_mm).filter_map(|(z, row)| Some((row.get(middle)? * 1e3, *z)));
    chart.draw_series(LineSeries::new(line, BLUE.stroke_width(2))).map_err(failed)?;
    Ok(())
}
