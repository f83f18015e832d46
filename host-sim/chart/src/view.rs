//! How a picture is wanted: its size, the stretch of the contour it shows, its title, its magnification.

use std::ops::RangeInclusive;

use truepath_ground::diagnostics::InputError;
use truepath_ground::length::Unit;

use crate::axis::plain;
use crate::codes::{Z001, Z002, Z003, Z004};

/// Width and height a picture may have, px.
pub const SIZES: RangeInclusive<u32> = 200..=8000;
/// Magnifications of the error.
pub const MAGNIFICATIONS: RangeInclusive<f64> = 0.01..=1e6;
/// Most letters of a title or of a name.
pub const LETTERS: usize = 200;
/// Width of a picture that is not asked for otherwise, px.
const WIDTH: u32 = 900;

/// How a picture is wanted; what is left out follows from the data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// The line above it; an empty one leaves no room for it.
    pub title: Option<String>,
    /// Width, px of the screen or 1/96 inch on paper.
    pub width: Option<u32>,
    /// Height.
    pub height: Option<u32>,
    /// First place shown, mm along the contour.
    pub from_mm: Option<f64>,
    /// Last place shown, mm along the contour.
    pub to_mm: Option<f64>,
    /// How many times larger than the wall the error is drawn.
    pub magnify: Option<f64>,
    /// The unit of what is drawn.
    pub unit: Unit,
}

impl View {
    /// The usual view, in a unit.
    pub fn in_unit(unit: Unit) -> Self {
        Self { unit, ..Self::default() }
    }

    /// The title, or the usual one.
    pub fn titled<'a>(&'a self, usual: &'a str) -> Result<&'a str, InputError> {
        let title = self.title.as_deref().unwrap_or(usual);
        short("the title", title)?;
        Ok(title)
    }

    /// Width and height: the usual height, or what is asked for unless it is below the least one.
    pub fn size(&self, usual: u32, least: u32) -> Result<(u32, u32), InputError> {
        let asked = |name: &str, size: Option<u32>, usual: u32| match size {
            Some(size) if !SIZES.contains(&size) => {
                let expected = format!("{} to {} px", SIZES.start(), SIZES.end());
                let help = "for a sharper PNG picture raise --scale";
                Err(InputError::new(Z001, format!("the {name} is {size} px"), expected, help))
            }
            size => Ok(size.unwrap_or(usual)),
        };
        let (width, height) = (asked("width", self.width, WIDTH)?, asked("height", self.height, usual)?);
        if height < least {
            let found = format!("a height of {height} px is too low for what is to be drawn");
            let help = "make it higher, or draw fewer things (--columns)";
            return Err(InputError::new(Z001, found, format!("at least {least} px"), help));
        }
        Ok((width, height))
    }

    /// The stretch shown, of a contour that reaches from `start` to `end`; all in the unit of the view.
    pub fn window(&self, (start, end): (f64, f64)) -> Result<(f64, f64), InputError> {
        let said = |mm: f64| self.unit.said(mm);
        let (from, to) = (self.from_mm.map_or(start, said), self.to_mm.map_or(end, said));
        let name = self.unit.name();
        // What is told apart, mm: much less than a step of any table.
        const LEAST: f64 = 1e-4;
        if from.max(start) + said(LEAST) > to.min(end) || !from.is_finite() || !to.is_finite() {
            // Of a number nobody means not every digit.
            let told = |at: f64| if at.abs() < 1e9 { plain(at) } else { format!("{at:e}") };
            let found = format!("the stretch from {} to {} {name} holds nothing of the contour", told(from), told(to));
            let expected = format!("a stretch between {} and {} {name}", plain(start), plain(end));
            return Err(Z002.error(found, expected));
        }
        Ok((from.max(start), to.min(end)))
    }

    /// The magnification of the error, or the usual one.
    pub fn magnification(&self, usual: f64) -> Result<f64, InputError> {
        let magnify = self.magnify.unwrap_or(usual);
        if MAGNIFICATIONS.contains(&magnify) {
            return Ok(magnify);
        }
        let expected = format!("{} to {}", MAGNIFICATIONS.start(), MAGNIFICATIONS.end());
        Err(Z003.error(format!("the magnification is {magnify}"), expected))
    }
}

/// Refuses a text too long for a picture.
pub fn short(what: &str, text: &str) -> Result<(), InputError> {
    let letters = text.chars().count();
    if letters <= LETTERS {
        return Ok(());
    }
    let found = format!("{what} has {letters} letters");
    Err(Z004.error(found, format!("at most {LETTERS}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_is_cut_to_the_contour_and_refused_off_it() {
        let view = |from_mm, to_mm| View { from_mm, to_mm, ..View::default() };
        assert_eq!(view(None, None).window((0.0, 50.0)).ok(), Some((0.0, 50.0)));
        assert_eq!(view(Some(-5.0), Some(20.0)).window((0.0, 50.0)).ok(), Some((0.0, 20.0)));
        for (from, to) in [(60.0, 70.0), (20.0, 10.0), (20.0, 20.0), (-9.0, -1.0), (f64::NAN, 9.0), (0.0, f64::NAN)] {
            let error = view(Some(from), Some(to)).window((0.0, 50.0)).expect_err("refused");
            assert_eq!(error.code(), "Z002", "{from} {to}");
        }
        let far = view(Some(1e300), None).window((0.0, 50.0)).expect_err("refused");
        assert!(far.to_string().contains("from 1e300 to 50 mm"), "{far}");
    }

    #[test]
    fn sizes_magnifications_and_titles_have_limits() {
        let view = View { width: Some(199), ..View::default() };
        assert_eq!(view.size(400, 100).expect_err("narrow").code(), "Z001");
        let view = View { height: Some(300), magnify: Some(f64::INFINITY), ..View::default() };
        assert_eq!(view.size(400, 301).expect_err("low").code(), "Z001");
        assert_eq!(view.size(400, 300).ok(), Some((900, 300)));
        assert_eq!(view.magnification(1.0).expect_err("infinite").code(), "Z003");
        let view = View { title: Some("ä".repeat(201)), ..View::default() };
        assert_eq!(view.titled("").expect_err("long").code(), "Z004");
    }
}
