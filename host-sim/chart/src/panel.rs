//! Diagrams over arc length, one above the other on one axis.

use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

use super::axis::Scale;
use super::chart::{BELOW, RIGHT, chart, room};
use super::curve::{self, Band, Curve};
use super::legend::{Entry, Legend, Sign, dot};
use super::page::{Area, SMALL, fitted, picture, thick, title_height, units};
use super::style::{DARK, ZERO, failed};
use super::view::{SIZES, View, short};

/// The lower axis of all of them.
pub fn along_name(unit: Unit) -> String {
    format!("along the contour ({})", unit.name())
}
/// Usual height of one, two, three or more diagrams each, and the least, px.
const HEIGHTS: [f64; 4] = [300.0, 220.0, 180.0, 150.0];
const LEAST: f64 = 60.0;
/// Change of a value, as a share of it, below which it counts as constant.
const LEVEL: f64 = 1e-4;
/// Room between diagrams, px.
const BETWEEN: f64 = 12.0;

/// A measured place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Arc length, mm.
    pub s_mm: f64,
    /// Value.
    pub value: f64,
    /// Of little weight: drawn empty.
    pub outlying: bool,
}

/// One diagram.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// What the values are, with their unit.
    pub unit: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// What lies behind them.
    pub band: Option<Band>,
    /// What was measured.
    pub marks: Vec<Mark>,
}

impl Panel {
    /// Curves alone.
    pub fn new(unit: impl Into<String>, curves: Vec<Curve>) -> Self {
        Self { unit: unit.into(), curves, ..Self::default() }
    }

    fn entries(&self) -> Vec<Entry> {
        let curves = self.curves.iter().map(|c| Entry::line(c.ink, &c.name));
        let band = self.band.iter().map(|b| Entry { sign: Sign::Band, colour: b.colour, text: b.name.clone() });
        curves.chain(band).filter(|entry| !entry.text.is_empty()).collect()
    }

    /// First and last arc length of the curves.
    pub fn extent(&self) -> Option<(f64, f64)> {
        let ends = self.curves.iter().filter_map(|c| Some((c.points.first()?.0, c.points.last()?.0)));
        ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The scale of what is drawn in a window: with zero, unless the values lie far from it.
    pub fn scale(&self, window: (f64, f64), columns: usize) -> Scale {
        let curves = self.curves.iter().flat_map(|c| curve::within(&c.points, window, columns)).map(|p| p.1);
        let inside = |s: f64| s >= window.0 && s <= window.1;
        let band = self.band.iter().flat_map(|b| &b.edges).filter(|e| inside(e.0)).flat_map(|e| [e.1, e.2]);
        let marks = self.marks.iter().filter(|m| inside(m.s_mm)).map(|m| m.value);
        let values = curves.chain(band).chain(marks).filter(|v| v.is_finite());
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return Scale::new(0.0, 1.0, 5);
        }
        if (low, high) == (0.0, 0.0) {
            return Scale::new(0.0, 1.0, 5);
        }
        let span = high - low;
        // What does not change is a level, seen from zero: no digit of rounding is drawn as large as the diagram.
        let level = span < LEVEL * low.abs().max(high.abs());
        let low = if low > 0.0 && (low < 2.0 * span || level) { 0.0 } else { low };
        let high = if high < 0.0 && (-high < 2.0 * span || level) { 0.0 } else { high };
        let margin = (high - low) * 0.07;
        Scale::new(if low == 0.0 { low } else { low - margin }, if high == 0.0 { high } else { high + margin }, 6)
    }

    /// Draws it, with its legend, into an area with its upper left corner at (0, `top`), px.
    pub fn draw(
        &self,
        area: &Area,
        legend: &Legend,
        left: f64,
        (x, window): (&Scale, (f64, f64)),
        numbered: Option<&str>,
    ) -> Result<(), Failure> {
        let (width, height) = area.dim_in_pixel();
        let columns = columns(width);
        legend.draw(area, left, 0.0)?;
        let (_, below) = area.split_vertically(units(legend.height()));
        let y = self.scale(window, columns);
        let room =
            f64::from(height) / super::page::FINE - legend.height() - if numbered.is_some() { BELOW } else { 0.0 };
        let unit_fits = fitted(&self.unit, SMALL, room) >= 0.6 * SMALL;
        let unit = if unit_fits { self.unit.as_str() } else { "" };
        let mut chart = chart(&below, left, (x, numbered), (&y, unit))?;
        if let Some(band) = &self.band {
            curve::band(&mut chart, band, window, columns)?;
        }
        if y.low < 0.0 && y.high > 0.0 {
            let zero = PathElement::new([(x.low, 0.0), (x.high, 0.0)], ZERO.stroke_width(thick(1.0)));
            chart.draw_series([zero]).map_err(failed)?;
        }
        for each in &self.curves {
            let points = curve::within(&each.points, window, columns);
            let wide = f64::from(width) / super::page::FINE - left;
            curve::line(&mut chart, &points, each.ink, |at| points.get(at).map_or(0.0, |p| x.share(p.0) * wide))?;
        }
        for mark in self.marks.iter().filter(|m| m.s_mm >= window.0 && m.s_mm <= window.1) {
            chart.draw_series([dot((mark.s_mm, mark.value), DARK, !mark.outlying)]).map_err(failed)?;
        }
        Ok(())
    }
}

/// Columns a series is thinned to: one a pixel.
pub fn columns(units: u32) -> usize {
    (f64::from(units) / super::page::FINE) as usize
}

/// The axis along the contour.
pub fn along(window: (f64, f64)) -> Scale {
    Scale::new(window.0, window.1, 11)
}

/// A page of diagrams over arc length, one above the other.
///
/// # Errors
/// What the view asks for and cannot be, texts that are too long; internal, when it cannot be drawn.
pub fn panels(view: &View, title: &str, panels: &[Panel]) -> Result<Vec<u8>, Failure> {
    panels_over(view, title, &along_name(view.unit), panels)
}

/// The same over another axis.
///
/// # Errors
/// As [`panels`].
pub fn panels_over(view: &View, title: &str, axis: &str, panels: &[Panel]) -> Result<Vec<u8>, Failure> {
    let title = view.titled(title)?;
    for name in panels.iter().flat_map(|p| &p.curves) {
        short("a name", &name.name)?;
    }
    let extent = panels.iter().filter_map(Panel::extent).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let window = view.window(extent.unwrap_or((0.0, 1.0)))?;
    let (width, _) = view.size(*SIZES.end(), 0)?;
    let thin_to = columns(thick(f64::from(width)));
    let left = room(&panels.iter().map(|p| p.scale(window, thin_to)).collect::<Vec<_>>());
    let legends: Vec<Legend> =
        panels.iter().map(|p| Legend::new(p.entries(), f64::from(width) - left - RIGHT)).collect();
    let top = title_height(title);
    let fixed = top + BELOW + legends.iter().map(|l| l.height() + BETWEEN).sum::<f64>();
    let count = panels.len().max(1) as f64;
    let usual = fixed + HEIGHTS[(panels.len().max(1) - 1).min(3)] * count;
    let size = view.size(usual.ceil() as u32, (fixed + LEAST * count).ceil() as u32)?;
    let each = (f64::from(size.1) - fixed) / count;
    picture(size, title, |root| {
        let x = along(window);
        let mut y = top;
        for (k, (panel, legend)) in panels.iter().zip(&legends).enumerate() {
            let numbered = k + 1 == panels.len();
            let height = each + legend.height() + if numbered { BELOW } else { 0.0 };
            let area = root.clone().shrink((0, units(y)), (units(f64::from(size.0)), units(height)));
            panel.draw(&area, legend, left, (&x, window), numbered.then_some(axis))?;
            y += height + BETWEEN;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::DARK;

    #[test]
    fn a_constant_is_drawn_over_zero_with_round_numbers_and_not_as_its_rounding() {
        let scale = |values: &[f64]| {
            let points = values.iter().enumerate().map(|(k, v)| (k as f64, *v)).collect();
            let scale = Panel::new("", vec![Curve::new("", DARK, points)]).scale((0.0, 9.0), 100);
            (scale.low, scale.high, scale.ticks.iter().map(|t| scale.label(*t)).collect::<Vec<_>>())
        };
        assert_eq!(scale(&[40.0, 40.0, 40.0 + 1e-9]).2, ["0", "10", "20", "30", "40"]);
        let (low, high, ticks) = scale(&[-0.05, -0.05]);
        assert!(low < -0.05 && high == 0.0, "{low} {high}");
        assert_eq!(ticks, ["−0.04", "−0.02", "0.00"]);
        assert_eq!(scale(&[0.0, 0.0]).2.first().map(String::as_str), Some("0.0"));
        // A small change of a small value is a change.
        let (low, high, _) = scale(&[1e-6, 3e-6, 2e-6]);
        assert!(low == 0.0 && high < 4e-6, "{low} {high}");
    }
}
