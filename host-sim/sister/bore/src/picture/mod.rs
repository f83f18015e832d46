//! Pictures of a bore (SVG): circular plot, profile diagram, dependences, wall over the depth.

mod circular;
mod dependence;
mod diagram;
mod wall;

use plotters::style::RGBColor;
use truepath_chart::style::{AFTER as BLUE, BEFORE as ORANGE, DARK, FONT, LIGHT, failed, legend};

pub use circular::circular;
pub use dependence::{runout, teeth};
pub use diagram::diagram;
pub use wall::{Patch, wall};

/// Of teeth, by turns.
const TEETH: [RGBColor; 6] =
    [BLUE, RGBColor(230, 159, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167), ORANGE, RGBColor(86, 180, 233)];

/// The largest of 1, 2, 5, 10, … that is not above a number.
fn round_below(number: f64) -> f64 {
    if !(number > 0.0 && number.is_finite()) {
        return 1.0;
    }
    let decade = 10f64.powf(number.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * decade).find(|m| *m <= number).unwrap_or(decade)
}

/// A length with a unit a reader takes in at a glance.
fn length(mm: f64) -> String {
    if mm.abs() >= 0.1 { format!("{} mm", short(mm)) } else { format!("{} µm", short(mm * 1e3)) }
}

/// Three significant digits, without trailing zeros.
fn short(number: f64) -> String {
    let digits = if number == 0.0 { 0 } else { (2 - number.abs().log10().floor() as i32).clamp(0, 6) as usize };
    let text = format!("{number:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Pictures with many marks are drawn this much larger and shown smaller, since a line ends on whole pixels.
const FINE: i32 = 4;

/// Shows a picture drawn `FINE` times too large at its own size.
fn shown(drawn: String, (width, height): (i32, i32)) -> Vec<u8> {
    let size = |by: i32| format!("<svg width=\"{}\" height=\"{}\"", by * width, by * height);
    drawn.replacen(&size(FINE), &size(1), 1).into_bytes()
}
