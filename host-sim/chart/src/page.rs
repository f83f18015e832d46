//! One picture as a file: an SVG drawn ten times finer than a pixel, with its title as the name a screen reader says.
//!
//! `plotters` puts everything on whole units; at ten units a pixel a curve is smooth and a peak stands where it belongs.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use truepath_ground::diagnostics::Failure;

use super::letters;
use super::style::{DARK, FONT, failed};

/// Units of the drawing to a pixel.
pub const FINE: f64 = 10.0;
/// Size of the letters of axes and legends, px.
pub const SMALL: f64 = 12.0;
const TITLE: f64 = 16.0;

/// Part of a picture.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Units of a length in pixels.
pub fn units(px: f64) -> i32 {
    (px * FINE).round() as i32
}

/// Thickness of a line in pixels.
pub fn thick(px: f64) -> u32 {
    units(px).unsigned_abs()
}

/// The room a title takes, px.
pub fn title_height(title: &str) -> f64 {
    if title.is_empty() { 8.0 } else { 34.0 }
}

/// Letters of a size in pixels.
pub fn lettering<'a>(size: f64, colour: RGBColor) -> TextStyle<'a> {
    // plotters divides the size by 1.24 when it writes it.
    TextStyle { color: colour.to_backend_color(), ..TextStyle::from((FONT, size * FINE * 1.24)) }
}

/// The largest size up to `size` at which a text is no wider than `available`.
pub fn fitted(text: &str, size: f64, available: f64) -> f64 {
    size.min(size * available.max(1.0) / letters::width(text, size).max(1.0))
}

/// Draws a picture of a size in pixels under a title.
pub fn picture(
    (width, height): (u32, u32),
    title: &str,
    draw: impl FnOnce(&Area) -> Result<(), Failure>,
) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    let fine = |px: u32| thick(f64::from(px));
    {
        let root = SVGBackend::with_string(&mut text, (fine(width), fine(height))).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        if !title.is_empty() {
            let size = fitted(title, TITLE, f64::from(width) - 24.0);
            let style = lettering(size, DARK).pos(Pos::new(HPos::Center, VPos::Center));
            let middle = (units(f64::from(width) / 2.0), units(18.0));
            root.draw(&Text::new(title.to_owned(), middle, style)).map_err(failed)?;
        }
        draw(&root)?;
        root.present().map_err(failed)?;
    }
    let body = text.find('>').and_then(|end| text.get(end + 1..)).ok_or_else(|| failed("no SVG"))?;
    let name = title.replace('&', "&amp;").replace('<', "&lt;");
    let (body, name) = (well_formed(body), well_formed(&name));
    let head = format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" \
         stroke-linejoin=\"round\" stroke-linecap=\"round\">\n<title>{name}</title>",
        fine(width),
        fine(height)
    );
    Ok((head + &body).into_bytes())
}

/// Text that XML allows: letters it has no room for become U+FFFD, and `]]>` must not stand in a text.
fn well_formed(text: &str) -> String {
    let allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{FFFD}' | '\u{10000}'..);
    let text: String = text.chars().map(|c| if allowed(c) { c } else { char::REPLACEMENT_CHARACTER }).collect();
    text.replace("]]>", "]]&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::png;

    #[test]
    fn a_title_of_any_letters_gives_a_picture_that_is_well_formed() {
        let svg = picture((300, 200), "\u{1}\u{1b}\u{8}\u{ffff} a ]]> <b> &amp;", |_| Ok(())).expect("drawn");
        let text = String::from_utf8(svg.clone()).expect("text");
        assert!(!text.contains("]]>") && !text.contains('\u{ffff}'), "{text}");
        assert!(text.chars().all(|c| c == '\n' || c >= ' '), "{text}");
        assert!(png(&svg, 1.0).is_ok());
    }
}
