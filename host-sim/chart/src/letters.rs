//! The letters of the pictures: how wide a text is.
//!
//! Arimo (SIL Open Font License 1.1, `fonts/OFL.txt`) without the letters no picture needs: Latin, Greek, Cyrillic, the
//! signs of measuring. It has the widths of Arial, Helvetica and Liberation Sans, so that what is laid out with it fits in
//! a browser, and being part of the program it makes PNG pictures the same on every computer.

use std::sync::LazyLock;

use skrifa::MetadataProvider;
use skrifa::instance::{LocationRef, Size};

/// The font file.
pub const FILE: &[u8] = include_bytes!("../fonts/Arimo-subset.ttf");
/// Its family name.
pub const FAMILY: &str = "Arimo";

static FONT: LazyLock<Option<skrifa::FontRef<'static>>> = LazyLock::new(|| skrifa::FontRef::new(FILE).ok());

/// Width of a text in the unit of its size; a letter the font lacks counts as a square.
pub fn width(text: &str, size: f64) -> f64 {
    let Some(font) = FONT.as_ref() else { return size * text.chars().count() as f64 };
    let (map, metrics) = (font.charmap(), font.glyph_metrics(Size::new(1000.0), LocationRef::default()));
    let advance = |letter| map.map(letter).and_then(|glyph| metrics.advance_width(glyph));
    text.chars().map(|letter| advance(letter).map_or(1000.0, f64::from)).sum::<f64>() * size / 1000.0
}

/// The letters of a text that the font lacks, each once.
fn missing(text: &str) -> Vec<char> {
    let Some(font) = FONT.as_ref() else { return Vec::new() };
    let map = font.charmap();
    let mut lacking: Vec<char> = text.chars().filter(|letter| map.map(*letter).is_none()).collect();
    lacking.sort_unstable();
    lacking.dedup();
    lacking
}

/// A warning of letters in an SVG picture that will not be seen in a PNG one.
pub fn unknown_letters(svg: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(svg);
    let lacking = missing(&text.replace('\n', ""));
    let shown: String = lacking.iter().take(20).collect();
    let told =
        "a PNG picture has Latin, Greek and Cyrillic letters only; an SVG one shows all that the reader's computer has";
    (!lacking.is_empty()).then(|| format!("these letters are missing in the picture: {shown}; {told}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_the_widths_of_arial_and_the_signs_of_measuring() {
        // Units of 1/2048 of the size, as in the tables of Arial: digits 1139, W 1933, i 455, minus 1196.
        for (letter, units) in [("0", 1139.0), ("W", 1933.0), ("i", 455.0), ("−", 1196.0)] {
            assert!((width(letter, 2048.0) - units).abs() < 1.0, "{letter}: {}", width(letter, 2048.0));
        }
        assert!((width("00", 2048.0) - 2278.0).abs() < 1.0);
        assert_eq!(missing("before → after ±2σ, µm, 30°, mm², N·m, −0.1 × 100 ≤ 5, Деталь Ø20"), Vec::<char>::new());
        assert_eq!(missing("壁a壁"), ['壁']);
    }
}
