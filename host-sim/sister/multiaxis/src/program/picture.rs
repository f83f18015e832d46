//! The chord error along the program, before and after, on a logarithmic scale with the tolerance (SVG).

use plotters::prelude::*;
use truepath_chart::style::{AFTER, BEFORE, DARK, FONT, LIGHT, failed, legend};
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

use super::profile::{Peak, Profile};

/// Errors below this share of the tolerance are drawn at the bottom.
const FLOOR: f64 = 1e-3;

/// Draws the profile of a program, with lengths in a unit.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn picture(profile: &Profile, tolerance_mm: f64, unit: Unit) -> Result<Vec<u8>, Failure> {
    let tolerance = unit.said(tolerance_mm);
    let said = |(at, peak): (f64, Peak)| (at, (unit.said(peak.0), unit.said(peak.1)));
    let stretches: Vec<(f64, Peak)> = profile.stretches().map(said).collect();
    let width = profile.width() as f64;
    let end = stretches.last().map_or(1.0, |s| s.0 + width);
    let greatest = stretches.iter().fold(tolerance, |m, s| m.max(s.1.0));
    let least = stretches.iter().map(|s| s.1.1).filter(|e| *e > 0.0).fold(tolerance, f64::min);
    let bottom = least.clamp(tolerance * FLOOR, tolerance / 3.0) / 2.0;
    // Room above the curves for the legend.
    let top = greatest * (greatest / bottom).powf(0.35);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (900, 420)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let mut chart = ChartBuilder::on(&root)
            .caption("Chord error along the program", (FONT, 20))
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d(1.0..end.max(2.0), (bottom..top).log_scale())
            .map_err(failed)?;
        let moves =
            if width > 1.0 { format!("five-axis move, largest of every {width}") } else { "five-axis move".into() };
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(LIGHT)
            .x_desc(moves)
            .y_desc(format!("chord error, {}", unit.name()))
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v}"))
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        let curves = [("as programmed", BEFORE, true), ("with inserted points", AFTER, false)];
        for (name, colour, first) in curves {
            let steps = stretches.iter().flat_map(|(at, peak)| {
                let error = if first { peak.0 } else { peak.1 }.max(bottom);
                [(*at, error), (at + width, error)]
            });
            chart
                .draw_series(LineSeries::new(steps, colour.stroke_width(1)))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        }
        chart
            .draw_series(DashedLineSeries::new([(1.0, tolerance), (end, tolerance)], 6, 4, DARK.stroke_width(2)))
            .map_err(failed)?
            .label(format!("tolerance {} {}", unit.of(tolerance_mm), unit.name()))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], DARK.stroke_width(2)));
        legend(&mut chart, 1)?;
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}
