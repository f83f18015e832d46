//! What all pictures share: colours, letters, legend.
//!
//! Colours are those of Okabe and Ito, distinguishable by colour-blind readers. Some of them are the same grey: lines that are drawn
//! over each other also differ in their dashes.

use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

/// What was before the correction.
pub const BEFORE: RGBColor = RGBColor(213, 94, 0);
/// What is after it.
pub const AFTER: RGBColor = RGBColor(0, 114, 178);
/// Along x.
pub const ALONG_X: RGBColor = RGBColor(0, 158, 115);
/// Along y.
pub const ALONG_Y: RGBColor = RGBColor(204, 121, 167);
/// What is nominal, allowed, or measured against.
pub const DARK: RGBColor = RGBColor(60, 60, 60);
/// The nominal wall, under the milled ones.
pub const NOMINAL: RGBColor = RGBColor(190, 190, 190);
/// The line of zero.
pub const ZERO: RGBColor = RGBColor(160, 160, 160);
/// Lines of a grid.
pub const LIGHT: RGBColor = RGBColor(225, 225, 225);
/// Of things of one kind in their order.
pub const IN_ORDER: [RGBColor; 7] =
    [BEFORE, AFTER, ALONG_X, ALONG_Y, RGBColor(230, 159, 0), RGBColor(86, 180, 233), DARK];
/// How a line is drawn: told by its colour, and by its dashes where all is grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// Colour.
    pub colour: RGBColor,
    /// Lengths of strokes and gaps in turn, px; none for a full line.
    pub dashes: &'static [f64],
}

impl From<RGBColor> for Ink {
    fn from(colour: RGBColor) -> Self {
        Self { colour, dashes: &[] }
    }
}

/// Strokes and gaps of a dashed line, px.
pub const DASHES: &[f64] = &[8.0, 5.0];
/// Of lines of one kind in their order.
pub const INKS: [Ink; IN_ORDER.len()] = [
    Ink { colour: IN_ORDER[0], dashes: DASHES },
    Ink { colour: IN_ORDER[1], dashes: &[] },
    Ink { colour: IN_ORDER[2], dashes: &[12.0, 4.0, 2.0, 4.0] },
    Ink { colour: IN_ORDER[3], dashes: &[2.0, 4.0] },
    Ink { colour: IN_ORDER[4], dashes: &[18.0, 6.0] },
    Ink { colour: IN_ORDER[5], dashes: &[12.0, 4.0, 2.0, 4.0, 2.0, 4.0] },
    Ink { colour: IN_ORDER[6], dashes: &[2.0, 10.0] },
];
/// The line before the correction.
pub const INK_BEFORE: Ink = INKS[0];
/// The line after it.
pub const INK_AFTER: Ink = INKS[1];
/// Along y, beside a full line along x.
pub const INK_ALONG_Y: Ink = Ink { colour: ALONG_Y, dashes: DASHES };
/// What has no direction, beside its parts along x and y.
pub const INK_MAGNITUDE: Ink = Ink { colour: DARK, dashes: &[2.0, 4.0] };
/// Letters: the first of these a reader has. All but the last have the same widths as the font the PNG pictures are drawn with.
pub const FONT: &str = "Arimo, Arial, Helvetica, Liberation Sans, sans-serif";

/// A picture that cannot be drawn is a fault of the program.
pub fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(format!("a picture cannot be drawn: {error}"))
}

/// The names of the series, in the upper right corner; `fine` is the number of units of the picture to a pixel.
pub fn legend<'a, 'b: 'a, X: Ranged, Y: Ranged>(
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
