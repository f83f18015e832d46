//! Quantities along the contour.

use plotters::prelude::*;

use super::chart::Chart;
use super::page::{thick, units};
use super::style::{AFTER, BEFORE, failed};
use super::thin::kept;
use crate::diagnostics::Failure;

/// A named curve over arc length.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend; an empty one is left out there.
    pub name: String,
    /// (arc length in mm, value), arc length never falling; a gap where the value is not a number.
    pub points: Vec<(f64, f64)>,
    /// Colour.
    pub colour: RGBColor,
    /// A line of dashes.
    pub dashed: bool,
}

/// What lies to both sides of a curve.
#[derive(Clone, Debug)]
pub struct Band {
    /// Name in the legend.
    pub name: String,
    /// (arc length in mm, from, to); a gap where one is not a number.
    pub edges: Vec<(f64, f64, f64)>,
    /// Colour.
    pub colour: RGBColor,
}

impl Curve {
    /// A full line.
    pub fn new(name: impl Into<String>, colour: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, colour, dashed: false }
    }
    /// The state before the correction.
    pub fn before(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, BEFORE, points)
    }
    /// The state after it.
    pub fn after(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, AFTER, points)
    }
    /// The same with dashes.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
}

/// A series in a window, thinned to columns, with its values at the ends of the window.
pub(super) fn within(points: &[(f64, f64)], window: (f64, f64), columns: usize) -> Vec<(f64, f64)> {
    let (s, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let places = kept(&s, &values, window, columns);
    let mut out: Vec<(f64, f64)> = places.iter().filter_map(|at| points.get(*at).copied()).collect();
    let (from, to) = window;
    // Between the last place outside and the first one inside the curve is a straight line.
    let crossing = |end: f64| {
        let after = points.partition_point(|p| p.0 < end);
        let (a, b) = (points.get(after.checked_sub(1)?)?, points.get(after)?);
        (b.0 > a.0).then(|| (end, a.1 + (b.1 - a.1) * (end - a.0) / (b.0 - a.0)))
    };
    if let Some(first) = crossing(from).filter(|_| out.first().is_none_or(|p| p.0 > from)) {
        out.insert(0, first);
    }
    if let Some(last) = crossing(to).filter(|_| out.last().is_none_or(|p| p.0 < to)) {
        out.push(last);
    }
    out
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stroke {
    Full,
    Dashed,
    /// Under others that may lie on it.
    Broad,
}

/// Draws points as a line with gaps; a single one between two gaps as a dot.
pub(super) fn line(chart: &mut Chart, points: &[(f64, f64)], colour: RGBColor, stroke: Stroke) -> Result<(), Failure> {
    let style = colour.stroke_width(thick(if stroke == Stroke::Broad { 4.5 } else { 1.8 }));
    for run in points.split(|p| !(p.0.is_finite() && p.1.is_finite())).filter(|run| !run.is_empty()) {
        let run = if let [only] = run { vec![*only, *only] } else { run.to_vec() };
        if stroke == Stroke::Dashed {
            chart.draw_series(DashedLineSeries::new(run, units(6.0), units(4.0), style)).map_err(failed)?;
        } else {
            chart.draw_series([PathElement::new(run, style)]).map_err(failed)?;
        }
    }
    Ok(())
}

/// Draws a band with gaps.
pub(super) fn band(chart: &mut Chart, band: &Band, window: (f64, f64), columns: usize) -> Result<(), Failure> {
    let edge = |f: fn(&(f64, f64, f64)) -> f64| band.edges.iter().map(|e| (e.0, f(e))).collect::<Vec<_>>();
    let (low, high) = (within(&edge(|e| e.1), window, columns), within(&edge(|e| e.2), window, columns));
    let gap = |p: &(f64, f64)| !p.1.is_finite();
    for (low, high) in low.split(gap).zip(high.split(gap)).filter(|(low, high)| !low.is_empty() && !high.is_empty()) {
        let outline: Vec<(f64, f64)> = high.iter().chain(low.iter().rev()).copied().collect();
        chart.draw_series([Polygon::new(outline, band.colour.mix(0.22))]).map_err(failed)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_ends_on_the_line_between_two_places() {
        let points = [(0.0, 0.0), (10.0, 1.0), (20.0, 3.0)];
        assert_eq!(within(&points, (5.0, 15.0), 10), [(5.0, 0.5), (10.0, 1.0), (15.0, 2.0)]);
        assert_eq!(within(&points, (2.0, 3.0), 10), [(2.0, 0.2), (3.0, 0.3)]);
        assert_eq!(within(&points, (0.0, 20.0), 10), points);
    }
}
