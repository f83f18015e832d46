//! Quantities along the contour.

use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

use super::chart::Chart;
use super::page::thick;
use super::style::{INK_AFTER, INK_BEFORE, Ink, failed};
use super::thin::kept;

/// A named curve over arc length.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend; an empty one is left out there.
    pub name: String,
    /// (arc length in mm, value), arc length never falling; a gap where the value is not a number.
    pub points: Vec<(f64, f64)>,
    /// Colour and dashes.
    pub ink: Ink,
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
    /// A line; of a colour alone a full one.
    pub fn new(name: impl Into<String>, ink: impl Into<Ink>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, ink: ink.into() }
    }
    /// The state before the correction.
    pub fn before(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, INK_BEFORE, points)
    }
    /// The state after it.
    pub fn after(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, INK_AFTER, points)
    }
}

/// A series in a window, thinned to columns, with its values at the ends of the window.
pub fn within(points: &[(f64, f64)], window: (f64, f64), columns: usize) -> Vec<(f64, f64)> {
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

/// Thickness of a full line, px; of one with dashes that of the strokes and of what joins them.
const FULL: f64 = 1.8;
const STROKE: f64 = 2.6;
const JOINT: f64 = 0.8;
/// Of one under others that may lie on it.
const BROAD: f64 = 4.5;

/// Draws points as a line with gaps where one is not a number; a single one between two gaps as a dot.
///
/// Dashes are strokes on a thin line, so that no peak falls into a gap between them. `along` is how far each point lies along
/// the line, px: measured along the contour, so that a line full of peaks has no more strokes than a smooth one.
pub fn line(chart: &mut Chart, points: &[(f64, f64)], ink: Ink, along: impl Fn(usize) -> f64) -> Result<(), Failure> {
    if ink.dashes.is_empty() {
        return runs(chart, points, ink.colour, FULL);
    }
    runs(chart, points, ink.colour, JOINT)?;
    let places: Vec<f64> = (0..points.len()).map(along).collect();
    strokes(points, &places, ink.dashes).iter().try_for_each(|stroke| runs(chart, stroke, ink.colour, STROKE))
}

/// Draws a broad line under others.
pub fn broad(chart: &mut Chart, points: &[(f64, f64)], colour: RGBColor) -> Result<(), Failure> {
    runs(chart, points, colour, BROAD)
}

fn runs(chart: &mut Chart, points: &[(f64, f64)], colour: RGBColor, px: f64) -> Result<(), Failure> {
    for run in points.split(|p| !(p.0.is_finite() && p.1.is_finite())).filter(|run| !run.is_empty()) {
        let run = if let [only] = run { vec![*only, *only] } else { run.to_vec() };
        chart.draw_series([PathElement::new(run, colour.stroke_width(thick(px)))]).map_err(failed)?;
    }
    Ok(())
}

/// The strokes of a line of dashes: `along` rises from point to point, and a stroke ends at a point that is no number.
fn strokes(points: &[(f64, f64)], along: &[f64], dashes: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let period: f64 = dashes.iter().sum();
    // Whether a stroke is on behind a place, and where that ends.
    let phase = |place: f64| {
        let turn = (place / period).floor() * period;
        let mut end = turn;
        for (k, length) in dashes.iter().enumerate() {
            end += length;
            if place < end - 1e-9 {
                return (k % 2 == 0, end);
            }
        }
        (true, turn + period + dashes.first().copied().unwrap_or(period))
    };
    let mut strokes: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut begun = false;
    for (pair, places) in points.windows(2).zip(along.windows(2)) {
        let (&[a, b], &[from, to]) = (pair, places) else { continue };
        if !(a.1.is_finite() && b.1.is_finite() && a.0.is_finite() && b.0.is_finite() && to >= from) {
            begun = false;
            continue;
        }
        let at = |place: f64| {
            let share = if to > from { (place - from) / (to - from) } else { 1.0 };
            (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share)
        };
        let mut place = from;
        loop {
            let (on, end) = phase(place);
            let reached = end.min(to);
            if on {
                if !begun {
                    strokes.push(vec![at(place)]);
                }
                strokes.last_mut().into_iter().for_each(|stroke| stroke.push(at(reached)));
            }
            begun = on && end > to;
            if end >= to {
                break;
            }
            place = end;
        }
    }
    strokes
}

/// Draws a band with gaps.
pub fn band(chart: &mut Chart, band: &Band, window: (f64, f64), columns: usize) -> Result<(), Failure> {
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

    #[test]
    fn strokes_lie_on_the_line_with_gaps_between_and_none_over_a_hole() {
        let line: Vec<(f64, f64)> = (0..=30).map(|k| (f64::from(k), f64::from(k % 7))).collect();
        let along: Vec<f64> = line.iter().map(|p| p.0).collect();
        let drawn = strokes(&line, &along, &[4.0, 3.0]);
        let ends: Vec<(f64, f64)> = drawn.iter().map(|s| (s[0].0, s[s.len() - 1].0)).collect();
        assert_eq!(ends, [(0.0, 4.0), (7.0, 11.0), (14.0, 18.0), (21.0, 25.0), (28.0, 30.0)]);
        assert!(drawn.iter().flatten().all(|p| line.contains(p)), "a corner of the line is cut");
        // Strokes much longer and much shorter than the steps of the line.
        assert_eq!(strokes(&line, &along, &[100.0, 1.0]).len(), 1);
        assert_eq!(strokes(&[(0.0, 0.0), (10.0, 10.0)], &[0.0, 10.0], &[0.5, 0.5]).len(), 10);
        let mut holed = line;
        holed[9].1 = f64::NAN;
        assert!(strokes(&holed, &along, &[40.0, 1.0]).iter().flatten().all(|p| !(p.0 > 8.0 && p.0 < 10.0)));
        assert_eq!(strokes(&holed, &along, &[40.0, 1.0]).len(), 2);
    }
}
