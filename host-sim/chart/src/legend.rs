//! The names of what is drawn, in rows above the drawing and never over it.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use truepath_ground::diagnostics::Failure;

use super::letters;
use super::page::{Area, SMALL, fitted, lettering, thick, units};
use super::style::{DARK, Ink, failed};

/// What stands before a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// A line with these dashes.
    Line(&'static [f64]),
    /// A broad line.
    Broad,
    /// A band.
    Band,
    /// A full point.
    Point,
    /// An empty point.
    Ring,
    /// A bar of this many pixels.
    Bar(f64),
}

/// One name.
#[derive(Clone, Debug)]
pub struct Entry {
    /// What stands for it.
    pub sign: Sign,
    /// Its ink.
    pub colour: RGBColor,
    /// Its name.
    pub text: String,
}

/// Height of a row, px.
const ROW: f64 = 19.0;
const GAP: f64 = 22.0;

impl Entry {
    /// Of a line.
    pub fn line(ink: Ink, text: &str) -> Self {
        Self { sign: Sign::Line(ink.dashes), colour: ink.colour, text: text.to_owned() }
    }

    fn sign_width(&self) -> f64 {
        match self.sign {
            Sign::Point | Sign::Ring => 12.0,
            Sign::Bar(length) => length.min(200.0),
            Sign::Line(_) => 32.0,
            _ => 24.0,
        }
    }

    fn width(&self) -> f64 {
        self.sign_width() + 6.0 + letters::width(&self.text, SMALL)
    }
}

/// Entries with their places, px from the upper left corner of the legend.
#[derive(Clone, Debug, Default)]
pub struct Legend {
    placed: Vec<(f64, f64, f64, Entry)>,
    rows: u32,
}

impl Legend {
    /// Sets entries in rows of a width in pixels; one that is wider gets smaller letters.
    pub fn new(entries: Vec<Entry>, width: f64) -> Self {
        let mut legend = Self::default();
        let mut x = 0.0;
        for entry in entries {
            if legend.rows == 0 || x + entry.width() > width {
                (x, legend.rows) = (0.0, legend.rows + 1);
            }
            let size = fitted(&entry.text, SMALL, width - entry.sign_width() - 6.0);
            let next = x + entry.width() + GAP;
            legend.placed.push((x, f64::from(legend.rows) * ROW - ROW / 2.0, size, entry));
            x = next;
        }
        legend
    }

    /// Height, px.
    pub fn height(&self) -> f64 {
        f64::from(self.rows) * ROW
    }

    /// Draws it with its upper left corner there, px.
    pub fn draw(&self, area: &Area, left: f64, top: f64) -> Result<(), Failure> {
        for (x, y, size, entry) in &self.placed {
            let (x, y) = (left + x, top + y);
            let end = x + entry.sign_width();
            let at = |x: f64, y: f64| (units(x), units(y));
            let line = |from: f64, to: f64, px: f64| {
                let line = PathElement::new([at(from, y), at(to, y)], entry.colour.stroke_width(thick(px)));
                area.draw(&line).map_err(failed)
            };
            match entry.sign {
                Sign::Line([]) => line(x, end, 2.5)?,
                Sign::Line(dashes) => {
                    line(x, end, 0.8)?;
                    let mut from = x;
                    for (k, length) in dashes.iter().cycle().enumerate() {
                        let to = (from + length).min(end);
                        if k % 2 == 0 {
                            line(from, to, 2.8)?;
                        }
                        if to >= end {
                            break;
                        }
                        from = to;
                    }
                }
                Sign::Broad => line(x, end, 5.0)?,
                Sign::Band => {
                    let band = Rectangle::new([at(x, y - 5.0), at(end, y + 5.0)], entry.colour.mix(0.22).filled());
                    area.draw(&band).map_err(failed)?;
                }
                Sign::Point => area.draw(&dot(at(x + 6.0, y), entry.colour, true)).map_err(failed)?,
                Sign::Ring => area.draw(&dot(at(x + 6.0, y), entry.colour, false)).map_err(failed)?,
                Sign::Bar(_) => {
                    line(x, end, 1.5)?;
                    for tip in [x, end] {
                        let tip = [at(tip, y - 4.0), at(tip, y + 4.0)];
                        area.draw(&PathElement::new(tip, entry.colour.stroke_width(thick(1.5)))).map_err(failed)?;
                    }
                }
            }
            let style = lettering(*size, DARK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(entry.text.clone(), at(end + 6.0, y), style)).map_err(failed)?;
        }
        Ok(())
    }
}

/// A probe point, full or empty.
pub fn dot<C>(at: C, colour: RGBColor, full: bool) -> Circle<C, i32> {
    let style = if full { colour.filled() } else { colour.stroke_width(thick(1.5)) };
    Circle::new(at, units(if full { 3.5 } else { 3.0 }), style)
}
