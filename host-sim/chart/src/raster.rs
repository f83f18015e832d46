//! An SVG of ours as PNG, with the letters that are part of the program: the same picture on every computer.
//!
//! | code | meaning |
//! |---|---|
//! | Z005 | a scale outside [`SCALES`], or a picture of more than [`PIXELS`] |

use std::ops::RangeInclusive;
use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};
use truepath_ground::diagnostics::{Failure, InputError};

use crate::codes::Z005;
use crate::letters::{FAMILY, FILE};
use crate::style::failed;

/// Pixels of a PNG picture to one of the view.
pub const SCALES: RangeInclusive<f64> = 0.1..=20.0;
/// Most pixels of a PNG picture: 240 MB while it is drawn.
pub const PIXELS: u64 = 60_000_000;

static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(FILE.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    Arc::new(fonts)
});

/// The picture `scale` times larger than the pixels of its view, rounded to whole pixels.
///
/// # Errors
/// `Z005`; internal, when it cannot be drawn.
pub fn png(svg: &[u8], scale: f64) -> Result<Vec<u8>, Failure> {
    if !SCALES.contains(&scale) {
        let expected = format!("{} to {}", SCALES.start(), SCALES.end());
        let help = "96 dots per inch times the scale is what is printed: 3.125 for 300 dpi";
        return Err(InputError::new(Z005, format!("the scale is {scale}"), expected, help).into());
    }
    let options = Options { fontdb: FONTS.clone(), font_family: FAMILY.to_owned(), ..Options::default() };
    let tree = Tree::from_data(svg, &options).map_err(failed)?;
    let pixels = |length: f32| (f64::from(length) * scale).round().max(1.0) as u32;
    let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
    if u64::from(width) * u64::from(height) > PIXELS {
        let found = format!("the picture would have {width} × {height} pixels");
        let expected = format!("at most {PIXELS} pixels");
        return Err(Z005.error(found, expected).into());
    }
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| failed("no memory for its pixels"))?;
    let (across, down) = (width as f32 / tree.size().width(), height as f32 / tree.size().height());
    resvg::render(&tree, Transform::from_scale(across, down), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(failed)
}
