//! Pictures of the study (SVG): factors on a logarithmic scale, per family and along a grid.
//!
//! A box reaches from the lower to the upper quartile with a bar at the median, its whiskers from the tenth to the
//! ninetieth percentile; every case is a dot. Colours are those of Okabe and Ito.

use plotters::prelude::*;
use truepath_chart::style::{AFTER as LEARNED, BEFORE as FIRST, FONT, failed};
use truepath_ground::diagnostics::Failure;

const GREY: RGBColor = RGBColor(120, 120, 120);

/// Range of factors shown; beyond it dots lie on the edge.
const FACTORS: std::ops::Range<f64> = 0.5..200.0;

/// Factors of a group of cases.
#[derive(Clone, Debug)]
pub struct Group {
    /// Name.
    pub name: String,
    /// Factors of the first correction.
    pub first: Vec<f64>,
    /// Factors after one more part.
    pub learned: Vec<f64>,
}

/// One line a group, one above the other.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn by_group(groups: &[Group]) -> Result<String, Failure> {
    let mut text = String::new();
    {
        let height = 70 + 26 * groups.len() as u32;
        let root = SVGBackend::with_string(&mut text, (900, height)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let rows = groups.len() as f64;
        let mut chart = ChartBuilder::on(&root)
            .margin(8)
            .margin_right(20)
            .x_label_area_size(40)
            .y_label_area_size(170)
            .build_cartesian_2d(FACTORS.log_scale(), -0.5..(rows - 0.5))
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .disable_y_mesh()
            .y_labels(0)
            .x_desc("largest wall error before / after")
            .x_label_formatter(&|v| format!("{v}"))
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        let plain = (FONT, 13).into_font();
        for (k, group) in groups.iter().enumerate() {
            let y = rows - 1.0 - k as f64;
            let (_, pixel) = chart.backend_coord(&(1.0, y));
            root.draw(&Text::new(group.name.clone(), (8, pixel - 6), plain.clone())).map_err(failed)?;
            for (values, colour, up) in [(&group.first, FIRST, 0.17), (&group.learned, LEARNED, -0.17)] {
                let middle = y + if group.learned.is_empty() { 0.0 } else { up };
                let elements = horizontal(values, middle, colour);
                chart.draw_series(elements.lines).map_err(failed)?;
                chart.draw_series(elements.dots).map_err(failed)?;
            }
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}

struct Elements {
    lines: Vec<PathElement<(f64, f64)>>,
    dots: Vec<Circle<(f64, f64), i32>>,
}

fn shown(value: f64) -> f64 {
    value.clamp(FACTORS.start, FACTORS.end)
}

fn horizontal(values: &[f64], y: f64, colour: RGBColor) -> Elements {
    let mut lines = Vec::new();
    let half = 0.12;
    if let Some(s) = super::statistics::Spread::of(values) {
        let [p10, p25, median, p75, p90] = [s.p10, s.p25, s.median, s.p75, s.p90].map(shown);
        let line = |points: Vec<(f64, f64)>, width| PathElement::new(points, colour.stroke_width(width));
        lines.push(line(vec![(p10, y), (p25, y)], 1));
        lines.push(line(vec![(p75, y), (p90, y)], 1));
        let (low, high) = (y - half, y + half);
        lines.push(line(vec![(p25, low), (p75, low), (p75, high), (p25, high), (p25, low)], 1));
        lines.push(line(vec![(median, low), (median, high)], 3));
    }
    let dots = values.iter().map(|v| Circle::new((shown(*v), y), 2, colour.mix(0.35).filled())).collect();
    Elements { lines, dots }
}

/// A grid: (value, factors of the first correction) per cell; the median with the band from tenth to ninetieth
/// percentile.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn along(title: &str, cells: &[(f64, Group)]) -> Result<String, Failure> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (900, 340)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let last = cells.iter().map(|(v, _)| *v).fold(1e-6, f64::max);
        let mut chart = ChartBuilder::on(&root)
            .margin(8)
            .margin_right(20)
            .x_label_area_size(40)
            .y_label_area_size(60)
            .build_cartesian_2d(-0.03 * last..1.03 * last, FACTORS.log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(title)
            .y_desc("before / after")
            .y_label_formatter(&|v| format!("{v}"))
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        let works = super::summary::WORKS;
        chart
            .draw_series([PathElement::new(vec![(-0.03 * last, works), (1.03 * last, works)], GREY.stroke_width(1))])
            .map_err(failed)?;
        for (pick, colour) in [(0usize, FIRST), (1, LEARNED)] {
            let values = |group: &Group| if pick == 0 { group.first.clone() } else { group.learned.clone() };
            let spreads: Vec<(f64, super::statistics::Spread)> = cells
                .iter()
                .filter_map(|(v, group)| Some((*v, super::statistics::Spread::of(&values(group))?)))
                .collect();
            if spreads.is_empty() {
                continue;
            }
            let mut band: Vec<(f64, f64)> = spreads.iter().map(|(v, s)| (*v, shown(s.p90))).collect();
            band.extend(spreads.iter().rev().map(|(v, s)| (*v, shown(s.p10))));
            chart.draw_series([Polygon::new(band, colour.mix(0.12).filled())]).map_err(failed)?;
            let medians = spreads.iter().map(|(v, s)| (*v, shown(s.median)));
            chart.draw_series(LineSeries::new(medians, colour.stroke_width(3))).map_err(failed)?;
            for (v, group) in cells {
                let dots = values(group).into_iter().map(|f| Circle::new((*v, shown(f)), 2, colour.mix(0.35).filled()));
                chart.draw_series(dots).map_err(failed)?;
            }
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}
