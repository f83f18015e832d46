//! An empty diagram: frame, light grid, round ticks, units at the axes.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

use super::axis::Scale;
use super::letters;
use super::page::{Area, SMALL, lettering, thick, units};
use super::style::{DARK, LIGHT, ZERO, failed};

/// A diagram to draw in.
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Scale, Scale>>;

/// Its grid stands at the ticks of the scale, whatever number of lines is asked for.
impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.share(*value) * f64::from(to - from)).round() as i32
    }
    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }
    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// Room below a diagram for the numbers and the unit of its lower axis, px.
pub const BELOW: f64 = 42.0;
/// Room to the right for half of the last number, px.
pub const RIGHT: f64 = 22.0;
const TICK: f64 = 4.0;

/// Room to the left that the numbers and the unit of scales need, px.
pub fn room<'a>(scales: impl IntoIterator<Item = &'a Scale>) -> f64 {
    let labels =
        scales.into_iter().flat_map(|scale| scale.ticks.iter().map(|t| letters::width(&scale.label(*t), SMALL)));
    labels.fold(0.0, f64::max) + 2.0 * TICK + 30.0
}

/// A diagram that fills an area but for `left` pixels; without a unit at the lower axis there are no numbers there either.
pub fn chart<'a, 'b: 'a>(
    area: &'a Area<'b>,
    left: f64,
    (x, x_unit): (&Scale, Option<&str>),
    (y, y_unit): (&Scale, &str),
) -> Result<Chart<'a, 'b>, Failure> {
    // The unit begins a little inside, so that no letter is cut.
    let inset = 8.0;
    let mut builder = ChartBuilder::on(area);
    builder.margin_left(units(inset)).margin_right(units(RIGHT)).y_label_area_size(units(left - inset));
    if x_unit.is_some() {
        builder.x_label_area_size(units(BELOW - 4.0)).margin_bottom(units(4.0));
    }
    let mut chart = builder.build_cartesian_2d(x.clone(), y.clone()).map_err(failed)?;
    chart
        .configure_mesh()
        .bold_line_style(LIGHT.stroke_width(thick(1.0)))
        .light_line_style(TRANSPARENT)
        .axis_style(DARK.stroke_width(thick(1.0)))
        .set_all_tick_mark_size(units(TICK))
        .x_label_formatter(&|v| x.label(*v))
        .y_label_formatter(&|v| y.label(*v))
        .x_desc(x_unit.unwrap_or_default())
        .y_desc(y_unit)
        .label_style(lettering(SMALL, DARK))
        .axis_desc_style(lettering(SMALL, DARK))
        .draw()
        .map_err(failed)?;
    let frame = [(x.low, y.low), (x.low, y.high), (x.high, y.high), (x.high, y.low), (x.low, y.low)];
    chart.draw_series([PathElement::new(frame, ZERO.stroke_width(thick(1.0)))]).map_err(failed)?;
    Ok(chart)
}
