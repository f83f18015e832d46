//! The circular plot: the bore to scale with its deviations magnified, as a roundness instrument draws it.

use std::f64::consts::TAU;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use truepath_ground::diagnostics::Failure;

use super::{BLUE, DARK, FINE, FONT, LIGHT, ORANGE, failed, length, round_below, shown};
use crate::envelope::Profile;

/// Width and height as shown.
const SHOWN: (i32, i32) = (760, 800);
/// Width as drawn.
const SIZE: i32 = FINE * SHOWN.0;
/// Points a stretch between two marks, and the most in all.
const A_STRETCH: usize = 12;
const MOST: usize = 40_000;

/// Draws a profile; `title` names the bore.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn circular(title: &str, profile: &Profile) -> Result<Vec<u8>, Failure> {
    let (high, height) = (profile.passes.highest(), profile.height());
    let factor = round_below(0.22 * high / height);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (SIZE as u32, (FINE * SHOWN.1) as u32)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let centre = (SIZE / 2, SIZE / 2 + 30 * FINE);
        let scale = f64::from(SIZE) / 2.0 * 0.82 / high;
        let label = |text: String, at: (i32, i32), size: i32, anchor: Pos| {
            let style = (FONT, FINE * size).into_font().color(&DARK).pos(anchor);
            root.draw(&Text::new(text, at, style)).map_err(failed)
        };
        let centred = Pos::new(HPos::Center, VPos::Center);
        label(title.to_owned(), (SIZE / 2, 16 * FINE), 18, centred)?;
        // φ = 0 at the top, clockwise.
        let place = |phi: f64, radius: f64| {
            let (s, c) = phi.sin_cos();
            (centre.0 + (radius * scale * s).round() as i32, centre.1 - (radius * scale * c).round() as i32)
        };
        for step in 0..12 {
            let phi = TAU * f64::from(step) / 12.0;
            let ends = [place(phi, 0.06 * high), place(phi, 1.03 * high)];
            root.draw(&PathElement::new(ends, LIGHT.stroke_width(FINE as u32))).map_err(failed)?;
            label(format!("{}°", step * 30), place(phi, 1.11 * high), 13, centred)?;
        }
        let circle = |radius: f64, colour: RGBColor| {
            let points: Vec<_> = (0..=720).map(|n| place(TAU * f64::from(n) / 720.0, radius)).collect();
            root.draw(&PathElement::new(points, colour.stroke_width(FINE as u32))).map_err(failed)
        };
        circle(high, ORANGE)?;
        circle(high - factor * height, LIGHT)?;
        let count = (A_STRETCH * profile.stretches.len()).clamp(720, MOST);
        let drawn = |n: usize| {
            let phi = TAU * n as f64 / count as f64;
            place(phi, high - factor * (high - profile.at(phi).0))
        };
        root.draw(&PathElement::new((0..=count).map(drawn).collect::<Vec<_>>(), BLUE.stroke_width(FINE as u32)))
            .map_err(failed)?;
        let lines = [
            format!("deviations drawn {factor} times larger than the bore"),
            format!("outer circle: radius {high:.4} mm, the deepest the teeth reach"),
            format!("inner circle: {} less, the highest crest (Pt)", length(height)),
            "angle along the travel of the cutter".to_owned(),
        ];
        for (n, line) in lines.into_iter().enumerate() {
            label(line, (SIZE / 2, centre.1 + FINE * (22 * n as i32 - 34)), 14, centred)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(shown(text, SHOWN))
}
