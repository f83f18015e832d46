//! Height of the waviness over number of teeth (both axes logarithmic) and over runout.

use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

use super::{BLUE, DARK, FONT, LIGHT, ORANGE, TEETH, failed, legend, short};
use crate::dependence::{RunoutRow, TeethRow, exponent};

/// Height over number of teeth, both directions.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn teeth(title: &str, rows: &[TeethRow]) -> Result<Vec<u8>, Failure> {
    let points = |of: fn(&TeethRow) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|r| Some((f64::from(r.teeth), of(r)? * 1e3))).collect()
    };
    let curves = [("conventional", points(|r| r.conventional_mm), BLUE), ("climb", points(|r| r.climb_mm), ORANGE)];
    let all = || curves.iter().flat_map(|c| c.1.iter()).map(|p| p.1);
    let (low, high) = all().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    let (low, high) = if high > low { (low * 0.6, high * 2.2) } else { (0.1, 10.0) };
    let most = rows.iter().map(|r| r.teeth).max().unwrap_or(1);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (760, 520)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, 18)).map_err(failed)?;
        let mut chart = ChartBuilder::on(&page)
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d((0.9..f64::from(most) * 1.12).log_scale(), (low..high).log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(LIGHT)
            .x_desc("teeth")
            .y_desc("height of the waviness Pt, µm")
            .x_label_formatter(&|x| short(*x))
            .y_label_formatter(&|y| short(*y))
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        for (name, points, colour) in curves {
            let power = exponent(points.iter().copied());
            let name = power.map_or_else(|| name.to_owned(), |e| format!("{name}, exponent {e:.2}"));
            chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2))).map_err(failed)?;
            chart
                .draw_series(points.iter().map(|p| Circle::new(*p, 4, colour.filled())))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        }
        legend(&mut chart, 1)?;
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}

/// Height over runout, coloured by how many teeth cut.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn runout(title: &str, rows: &[RunoutRow]) -> Result<Vec<u8>, Failure> {
    let points = || rows.iter().map(|r| (r.runout_mm * 1e3, r.height_mm * 1e3));
    let (right, high) = points().fold((1e-6f64, 1e-6f64), |(x, y), p| (x.max(p.0), y.max(p.1)));
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (760, 480)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, 18)).map_err(failed)?;
        let mut chart = ChartBuilder::on(&page)
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d(0.0..right * 1.02, 0.0..high * 1.35)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(LIGHT)
            .x_desc("runout (offset of the axes), µm")
            .y_desc("height of the waviness Pt, µm")
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        chart.draw_series(LineSeries::new(points(), DARK.stroke_width(2))).map_err(failed)?;
        let mut counts: Vec<usize> = rows.iter().map(|r| r.cutting_teeth).collect();
        counts.sort_unstable();
        counts.dedup();
        for count in counts.into_iter().rev() {
            let colour = TEETH[count % TEETH.len()];
            let of = rows.iter().filter(|r| r.cutting_teeth == count);
            chart
                .draw_series(of.map(|r| Circle::new((r.runout_mm * 1e3, r.height_mm * 1e3), 4, colour.filled())))
                .map_err(failed)?
                .label(if count == 1 {
                    "1 tooth leaves marks".to_owned()
                } else {
                    format!("{count} teeth leave marks")
                })
                .legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
        }
        legend(&mut chart, 1)?;
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}
