//! Pictures (SVG): the traces of a pass along the contour, and the wall before and after its correction.

pub(crate) mod style;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::correction::Correction;
use crate::diagnostics::Failure;
use crate::pass::Pass;
use crate::report::{Trace, mm};
use style::{AFTER, BEFORE, DARK, FONT, LIGHT, failed, legend};
use truepath_core::geometry::Side;

const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Colours of many curves in one panel, the last one of the most important.
pub const COLOURS: [RGBColor; 5] =
    [RGBColor(60, 60, 60), RGBColor(230, 159, 0), RGBColor(204, 121, 167), BEFORE, AFTER];

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A named curve over arc length.
#[derive(Clone, Debug)]
pub struct Curve<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// (arc length in mm, value).
    pub points: Vec<(f64, f64)>,
    /// Colour.
    pub colour: RGBColor,
}

impl<'a> Curve<'a> {
    /// The state before the correction.
    pub fn before(name: &'a str, points: Vec<(f64, f64)>) -> Self {
        Self { name, points, colour: BEFORE }
    }
    /// The state after it.
    pub fn after(name: &'a str, points: Vec<(f64, f64)>) -> Self {
        Self { name, points, colour: AFTER }
    }
}

/// Draws curves over arc length in one panel, and behind them a band: (arc length in mm, from, to).
fn draw(panel: &Panel, unit: &str, curves: &[Curve], band: &[(f64, f64, f64)]) -> Result<(), Failure> {
    let all = || curves.iter().flat_map(|c| c.points.iter()).filter(|p| p.1.is_finite());
    let known = || band.iter().filter(|b| b.1.is_finite() && b.2.is_finite());
    let (low, high) = all().fold((0.0f64, 0.0f64), |(l, h), p| (l.min(p.1), h.max(p.1)));
    let (low, high) = known().fold((low, high), |(l, h), b| (l.min(b.1), h.max(b.2)));
    let end = all().fold(0.0f64, |m, p| m.max(p.0));
    let margin = (high - low).max(1e-6) * 0.08;
    // Room above the curves for the legend.
    let headroom = (high - low).max(1e-6) * (0.14 + 0.2 * curves.len() as f64);
    let mut chart = ChartBuilder::on(panel)
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end.max(1e-6), (low - margin)..(high + headroom))
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(LIGHT)
        .x_desc("along the contour, mm")
        .y_desc(unit)
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 13))
        .draw()
        .map_err(failed)?;
    for run in band.split(|b| !(b.1.is_finite() && b.2.is_finite())).filter(|run| !run.is_empty()) {
        let there = run.iter().map(|b| (b.0, b.2));
        let outline: Vec<(f64, f64)> = there.chain(run.iter().rev().map(|b| (b.0, b.1))).collect();
        chart.draw_series([Polygon::new(outline, AFTER.mix(0.22))]).map_err(failed)?;
    }
    for curve in curves {
        let colour = curve.colour;
        // A gap where the value is not known.
        for run in curve.points.split(|p| !p.1.is_finite()).filter(|run| !run.is_empty()) {
            chart.draw_series(LineSeries::new(run.iter().copied(), colour.stroke_width(2))).map_err(failed)?;
        }
        chart
            .draw_series(std::iter::empty::<PathElement<(f64, f64)>>())
            .map_err(failed)?
            .label(curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    legend(&mut chart, 1)
}

/// A page of panels over arc length, one above the other: (unit, curves).
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn panels(title: &str, rows: &[(&str, Vec<Curve>)]) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    {
        let height = 40 + 230 * rows.len() as u32;
        let root = SVGBackend::with_string(&mut text, (900, height)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, 20)).map_err(failed)?;
        for (panel, (unit, curves)) in page.split_evenly((rows.len(), 1)).iter().zip(rows) {
            draw(panel, unit, curves, &[])?;
        }
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}

/// The traces of a pass: engagement, forces, deflections, wall error.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn trace(trace: &Trace) -> Result<Vec<u8>, Failure> {
    let over = |f: fn(&crate::report::TraceRow) -> f64| trace.iter().map(|r| (r.s_mm, f(r))).collect::<Vec<_>>();
    let curve = |name, colour, f| Curve { name, points: over(f), colour };
    panels(
        "One pass along the contour",
        &[
            ("engagement, degrees", vec![curve("engagement angle", DARK, |r| r.arc_deg)]),
            (
                "mean force, N",
                vec![
                    curve("magnitude", DARK, |r| r.force_n),
                    curve("Fx", BEFORE, |r| r.fx_n),
                    curve("Fy", AFTER, |r| r.fy_n),
                ],
            ),
            ("deflection, mm", vec![curve("x", BEFORE, |r| r.dx_mm), curve("y", AFTER, |r| r.dy_mm)]),
            ("wall error, mm", vec![curve("material left (+), gouge (−)", GREEN, |r| r.error_mm)]),
        ],
    )
}

/// The wall of a part to scale, with its error magnified, and the error along the contour.
///
/// `curves` are errors along the contour, mm, and `band` lies behind them; `wall` is the nominal one, with the normal into
/// the free side, at the arc lengths `s`.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn part(
    title: &str,
    (s, wall): &(Vec<f64>, Wall),
    curves: &[Curve],
    band: &[(f64, f64, f64)],
) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (1000, 760)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, 20)).map_err(failed)?;
        let (top, bottom) = page.split_vertically(470);
        draw_part(&top, s, wall, curves)?;
        draw(&bottom, "wall error, mm", curves, band)?;
        root.present().map_err(failed)?;
    }
    Ok(text.into_bytes())
}

fn draw_part(panel: &Panel, s: &[f64], wall: &[([f64; 2], [f64; 2])], curves: &[Curve]) -> Result<(), Failure> {
    let bounds =
        |axis: usize| wall.iter().fold((f64::MAX, f64::MIN), |(l, h), (p, _)| (l.min(p[axis]), h.max(p[axis])));
    let ((x0, x1), (y0, y1)) = (bounds(0), bounds(1));
    let size = (x1 - x0).max(y1 - y0).max(1.0);
    let peak = curves.iter().flat_map(|c| &c.points).filter(|p| p.1.is_finite()).fold(1e-6f64, |m, p| m.max(p.1.abs()));
    // A round magnification that shows the largest error as about a tenth of the part.
    let raw = size / 10.0 / peak;
    let magnification =
        [500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0].into_iter().find(|m| *m <= raw).unwrap_or(1.0);
    let (width, height) = panel.dim_in_pixel();
    let (width, height) = (f64::from(width) - 70.0, f64::from(height) - 75.0);
    // Equal scales on both axes.
    let per_pixel = ((x1 - x0) * 1.3 / width).max((y1 - y0) * 1.3 / height).max(size / 1000.0);
    let (cx, cy) = ((x0 + x1) / 2.0, (y0 + y1) / 2.0);
    let (rx, ry) = (per_pixel * width / 2.0, per_pixel * height / 2.0);
    let mut chart = ChartBuilder::on(panel)
        .caption(
            format!("wanted wall (grey) and milled wall, its error drawn {magnification} times larger"),
            (FONT, 14),
        )
        .margin(8)
        .x_label_area_size(28)
        .y_label_area_size(48)
        .build_cartesian_2d((cx - rx)..(cx + rx), (cy - ry)..(cy + ry))
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(235, 235, 235))
        .x_desc("X, mm")
        .y_desc("Y, mm")
        .label_style((FONT, 12))
        .draw()
        .map_err(failed)?;
    let nominal: Vec<(f64, f64)> = wall.iter().map(|(p, _)| (p[0], p[1])).collect();
    chart.draw_series(LineSeries::new(nominal, DARK.stroke_width(2))).map_err(failed)?;
    for curve in curves {
        let colour = curve.colour;
        let shifted = s.iter().zip(wall).map(|(s, (p, inward))| {
            let error = value_at(&curve.points, *s) * magnification;
            (p[0] + inward[0] * error, p[1] + inward[1] * error)
        });
        let shifted: Vec<(f64, f64)> = shifted.filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
        chart.draw_series(LineSeries::new(shifted, colour.stroke_width(2))).map_err(failed)?;
    }
    Ok(())
}

/// Linear interpolation in points ordered by their first coordinate.
fn value_at(points: &[(f64, f64)], s: f64) -> f64 {
    let after = points.partition_point(|p| p.0 < s);
    match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
        (Some(a), Some(b)) if b.0 > a.0 => a.1 + (b.1 - a.1) * (s - a.0) / (b.0 - a.0),
        (_, Some(p)) | (Some(p), None) => p.1,
        (None, None) => f64::NAN,
    }
}

/// Points of the nominal wall with the normals into the free side.
type Wall = Vec<([f64; 2], [f64; 2])>;

/// Nominal wall of a pass with the normals into the free side, at arc lengths every tenth of a millimetre.
pub fn nominal_wall(pass: &Pass) -> (Vec<f64>, Wall) {
    let contour = pass.path_contour();
    let pieces = (mm(contour.length()) * 10.0).ceil().max(2.0) as i64;
    let mut hint = 0;
    let mut out = (Vec::new(), Vec::new());
    for k in 0..=pieces {
        let s = contour.length().scaled(truepath_core::units::Real::ratio(k, pieces));
        let Some(place) = contour.at(s, hint) else { continue };
        hint = place.block;
        let towards_wall = match pass.core.setup.wall {
            Side::Left => place.heading.left(),
            Side::Right => place.heading.right(),
        };
        let wall = place.point + towards_wall.times(pass.core.setup.radius);
        let inward = towards_wall.reversed();
        out.0.push(mm(s));
        out.1.push((
            [wall.x.nm() as f64 / 1e6, wall.y.nm() as f64 / 1e6],
            [crate::report::float(inward.x), crate::report::float(inward.y)],
        ));
    }
    out
}

/// The predicted wall before and after a correction.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn correction(pass: &Pass, s_mm: &[f64], correction: &Correction) -> Result<Vec<u8>, Failure> {
    let target = correction.wanted.target;
    let along = |f: &dyn Fn(usize) -> f64| s_mm.iter().enumerate().map(|(i, s)| (*s, f(i))).collect::<Vec<_>>();
    let before = along(&|i| mm(correction.predicted[i].before.aim(target, None)));
    let after = along(&|i| mm(correction.predicted[i].after.aim(target, None)));
    let wide = |i: usize| 2.0 * mm(correction.sigma[i]);
    let band: Vec<_> = after.iter().enumerate().map(|(i, (s, error))| (*s, error - wide(i), error + wide(i))).collect();
    part(
        "The wall as the model sees it",
        &nominal_wall(pass),
        &[
            Curve::before("without correction", before),
            Curve::after("with correction, and two standard deviations to either side", after),
        ],
        &band,
    )
}
