//! What all pictures share: colours, letters, legend.
//!
//! Colours are those of Okabe and Ito, distinguishable by colour-blind readers and in grey.

use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;

use crate::diagnostics::Failure;

/// What was before the correction.
pub(crate) const BEFORE: RGBColor = RGBColor(213, 94, 0);
/// What is after it.
pub(crate) const AFTER: RGBColor = RGBColor(0, 114, 178);
/// What is nominal, allowed, or measured against.
pub(crate) const DARK: RGBColor = RGBColor(60, 60, 60);
/// Lines of a grid.
pub(crate) const LIGHT: RGBColor = RGBColor(225, 225, 225);
/// Letters.
pub(crate) const FONT: &str = "sans-serif";

/// A picture that cannot be drawn is a fault of the program.
pub(crate) fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(format!("a picture cannot be drawn: {error}"))
}

/// The names of the series, in the upper right corner; `fine` is the number of units of the picture to a pixel.
pub(crate) fn legend<'a, 'b: 'a, X: Ranged, Y: Ranged>(
    chart: &mut ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>,
    fine: i32,
) -> Result<(), Failure> {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200).stroke_width(fine.unsigned_abs()))
        .margin(fine.unsigned_abs() * 10)
        .legend_area_size(fine.unsigned_abs() * 30)
        .label_font((FONT, fine * 13))
        .draw()
        .map_err(failed)
}
