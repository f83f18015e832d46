//! The wall of a part to scale, X and Y alike, with its error magnified, and the probed places with their deviations.

use plotters::element::{PathElement, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use truepath_chart::axis::{Scale, number, plain, round_below};
use truepath_chart::chart::{BELOW, Chart, RIGHT, chart, room};
use truepath_chart::curve::{broad, line};
use truepath_chart::legend::{Entry, Legend, Sign, dot};
use truepath_chart::letters;
use truepath_chart::page::{Area, FINE, SMALL, lettering, thick, units};
use truepath_chart::style::{DARK, NOMINAL, failed};
use truepath_chart::thin::kept;
use truepath_chart::view::View;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;

use super::wall::{Place, Probed, Wall};

/// Most columns the places of a wall are thinned to; see [`kept`].
const COLUMNS: f64 = 3000.0;
/// Most probed spots whose deviations are written beside them, and how near to each other places are one spot, mm.
const WRITTEN: usize = 60;
const SPOT: f64 = 0.5;
/// Height of a text, px.
const HIGH: f64 = 14.0;

/// What is drawn to scale, in a window of the contour.
pub(super) struct Part<'a> {
    walls: &'a [Wall],
    probed: Vec<Probed>,
    window: (f64, f64),
    /// Times the error is drawn larger.
    magnify: f64,
    /// The unit of all of it.
    unit: Unit,
}

impl<'a> Part<'a> {
    pub(super) fn new(
        walls: &'a [Wall],
        probed: &[Probed],
        window: (f64, f64),
        view: &View,
    ) -> Result<Self, InputError> {
        let inside = |s: f64| s >= window.0 && s <= window.1;
        let probed: Vec<Probed> = probed.iter().filter(|p| inside(p.place.s_mm)).copied().collect();
        let places = || walls.iter().flat_map(|w| &w.places).filter(|p| inside(p.s_mm));
        let (x, y) = bounds(places().map(|p| (p.wall[0], p.wall[1])));
        let size = (x.1 - x.0).max(y.1 - y.0);
        let errors = places().map(|p| p.error_mm).chain(probed.iter().map(|p| p.place.error_mm));
        let peak = errors.filter(|e| e.is_finite()).fold(0.0f64, |m, e| m.max(e.abs()));
        // The largest error is drawn about a tenth as long as the part.
        let usual = if peak > 0.0 { round_below(size / 10.0 / peak).clamp(1.0, 1e5) } else { 1.0 };
        Ok(Self { walls, probed, window, magnify: view.magnification(usual)?, unit: view.unit })
    }

    /// The places of a wall that are drawn, for a scale in mm to a pixel.
    fn places(&self, wall: &'a Wall, per_px: f64) -> Vec<&'a Place> {
        let (s, errors): (Vec<f64>, Vec<f64>) = wall.errors().into_iter().unzip();
        let columns = ((self.window.1 - self.window.0) / per_px * 2.0).clamp(100.0, COLUMNS);
        kept(&s, &errors, self.window, columns as usize).into_iter().filter_map(|at| wall.places.get(at)).collect()
    }

    /// The legend, for a width in pixels: also of the diagram below, where a band is drawn.
    pub(super) fn legend(&self, band: Option<Entry>, per_px: f64, width: f64) -> Legend {
        let entry = |sign, colour, text: &str| Entry { sign, colour, text: text.to_owned() };
        let mut entries = vec![entry(Sign::Broad, NOMINAL, "nominal wall")];
        entries.extend(self.walls.iter().map(|w| Entry::line(w.ink, &w.name)));
        entries.extend(band);
        if self.probed.iter().any(|p| !p.outlying) {
            entries.push(entry(Sign::Point, DARK, &format!("probed (deviation in {})", self.unit.word())));
        }
        if self.probed.iter().any(|p| p.outlying) {
            entries.push(entry(Sign::Ring, DARK, "probed, of little weight"));
        }
        // A round error about 50 px long.
        let shown = round_below(50.0 * per_px / self.magnify);
        let text =
            format!("{} {} of error, drawn {} times larger", plain(shown), self.unit.name(), plain(self.magnify));
        entries.push(entry(Sign::Bar(shown * self.magnify / per_px), DARK, &text));
        Legend::new(entries, width)
    }

    /// Everything there is to be seen: x from, to; y from, to, mm.
    fn box_mm(&self) -> ((f64, f64), (f64, f64)) {
        let inside = |p: &&Place| p.s_mm >= self.window.0 && p.s_mm <= self.window.1;
        let places = self.walls.iter().flat_map(|w| &w.places).filter(inside);
        let places = places.chain(self.probed.iter().map(|p| &p.place));
        let points = places.flat_map(|p| [(p.wall[0], p.wall[1]), p.milled(self.magnify)]);
        bounds(points)
    }

    /// Millimetres to a pixel in an area of so many pixels, with a little room around.
    pub(super) fn per_px(&self, width: f64, height: f64) -> f64 {
        let (x, y) = self.box_mm();
        let around = 1.0 + 0.14;
        ((x.1 - x.0) / width).max((y.1 - y.0) / height).max(1e-9) * around
    }

    /// The height at which a picture of a width, in pixels, leaves no empty room beside or above the part.
    pub(super) fn height(&self, width: f64) -> f64 {
        let (x, y) = self.box_mm();
        let (w, h) = ((x.1 - x.0).max(1e-9), (y.1 - y.0).max(1e-9));
        (width - 60.0 - RIGHT).max(1.0) * (h / w).min(1e3) + BELOW
    }

    /// Draws it into an area, leaving `left` pixels for the vertical axis.
    pub(super) fn draw(&self, area: &Area, left: f64, (x, y): (&Scale, &Scale), per_px: f64) -> Result<(), Failure> {
        let [across, up] = ["X", "Y"].map(|axis| format!("{axis} ({})", self.unit.name()));
        let mut chart = chart(area, left, (x, Some(&across)), (y, &up))?;
        let stands = |p: &Place| if p.error_mm.is_finite() { (p.wall[0], p.wall[1]) } else { (f64::NAN, f64::NAN) };
        if let Some(first) = self.walls.first() {
            let nominal: Vec<(f64, f64)> = self.places(first, per_px).into_iter().map(stands).collect();
            broad(&mut chart, &nominal, NOMINAL)?;
        }
        for wall in self.walls {
            let places = self.places(wall, per_px);
            let milled: Vec<(f64, f64)> = places.iter().map(|p| p.milled(self.magnify)).collect();
            line(&mut chart, &milled, wall.ink, |at| places.get(at).map_or(0.0, |p| p.s_mm / per_px))?;
        }
        self.draw_probed(area, &mut chart)
    }

    /// The probed places, and beside each spot, on the side of the material, the deviation or its range over the height.
    fn draw_probed(&self, area: &Area, chart: &mut Chart) -> Result<(), Failure> {
        for Probed { place, outlying } in &self.probed {
            let (wall, milled) = ((place.wall[0], place.wall[1]), place.milled(self.magnify));
            chart.draw_series([PathElement::new([wall, milled], DARK.stroke_width(thick(0.8)))]).map_err(failed)?;
            chart.draw_series([dot(milled, DARK, !outlying)]).map_err(failed)?;
        }
        let base = area.get_base_pixel();
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let (across, down) = chart.plotting_area().get_pixel_range();
        let of = |v: i32, base: i32| f64::from(v - base) / FINE;
        let frame = [of(across.start, base.0), of(down.start, base.1), of(across.end, base.0), of(down.end, base.1)];
        for spot in
            self.probed.chunk_by(|a, b| (a.place.s_mm - b.place.s_mm).abs() < self.unit.said(SPOT)).take(WRITTEN)
        {
            let Some(place) = spot.first().map(|p| p.place) else { continue };
            let text = deviations(spot.iter().map(|p| p.place.error_mm), self.unit);
            let (x, y) = chart.backend_coord(&(place.wall[0], place.wall[1]));
            let at = [f64::from(x - base.0) / FINE, f64::from(y - base.1) / FINE];
            // On paper Y points down.
            let into = [-place.free[0], place.free[1]];
            let width = letters::width(&text, SMALL - 1.0);
            // The text stands beside the wall as a box does beside a line; where another one stands already, shifted along the
            // wall or farther out.
            let half = into[0].abs() * width / 2.0 + into[1].abs() * HIGH / 2.0;
            let aside = (into[1].abs() * width + into[0].abs() * HIGH) / 2.0;
            let spot = (0..9).find_map(|at_try| {
                let far = 7.0 + half + f64::from(at_try / 3) * (2.0 * half + 3.0);
                let shift = [0.0, aside, -aside][at_try as usize % 3];
                let middle = [at[0] + into[0] * far + into[1] * shift, at[1] + into[1] * far - into[0] * shift];
                let (left, top) = (middle[0] - width / 2.0, middle[1] - HIGH / 2.0);
                let (right, low) = (left + width, top + HIGH);
                let free = !taken.iter().any(|t| right >= t[0] && left <= t[2] && low >= t[1] && top <= t[3]);
                let inside = left >= frame[0] && top >= frame[1] && right <= frame[2] && low <= frame[3];
                (free && inside).then_some(([left, top, right, low], middle))
            });
            let Some((place, middle)) = spot else { continue };
            let left = place[0];
            taken.push(place);
            let style = lettering(SMALL - 1.0, DARK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(text, (units(left), units(middle[1])), style)).map_err(failed)?;
        }
        Ok(())
    }

    /// The axes of an area of so many pixels, and the room left of them, `least` or more.
    pub(super) fn axes(&self, width: f64, height: f64, least: f64) -> (Scale, Scale, f64, f64) {
        let (x, y) = self.box_mm();
        let middle = |range: (f64, f64)| (range.0 + range.1) / 2.0;
        let scale = |range, half: f64, px: f64, each: f64| {
            Scale::new(middle(range) - half, middle(range) + half, (px / each) as usize + 2)
        };
        let mut left = least.max(60.0);
        // The room for the numbers depends on the scale, and a little the other way round.
        for _ in 0..2 {
            let (w, h) = ((width - left - RIGHT).max(1.0), (height - BELOW).max(1.0));
            let per_px = self.per_px(w, h);
            let ys = scale(y, per_px * h / 2.0, h, 45.0);
            let needed = room([&ys]);
            if needed <= left {
                return (scale(x, per_px * w / 2.0, w, 90.0), ys, left, per_px);
            }
            left = needed;
        }
        let (w, h) = ((width - left - RIGHT).max(1.0), (height - BELOW).max(1.0));
        let per_px = self.per_px(w, h);
        (scale(x, per_px * w / 2.0, w, 90.0), scale(y, per_px * h / 2.0, h, 45.0), left, per_px)
    }
}

/// Deviations at one spot as text.
fn deviations(errors: impl Iterator<Item = f64>, unit: Unit) -> String {
    let decimals = if unit == Unit::Inch { 4 } else { 3 };
    let (low, high) = errors.fold((f64::MAX, f64::MIN), |(l, h), e| (l.min(e), h.max(e)));
    let signed = |error: f64| format!("{}{}", if error > 0.0 { "+" } else { "" }, number(error, decimals));
    let (low, high) = (signed(low), signed(high));
    if low == high { low } else { format!("{low} … {high}") }
}

/// Smallest and largest x and y of what is a number; zeros of nothing.
fn bounds(points: impl Iterator<Item = (f64, f64)>) -> ((f64, f64), (f64, f64)) {
    let known = points.filter(|p| p.0.is_finite() && p.1.is_finite());
    let grown = known.fold(None, |found: Option<((f64, f64), (f64, f64))>, (px, py)| {
        let (x, y) = found.unwrap_or(((px, px), (py, py)));
        Some(((x.0.min(px), x.1.max(px)), (y.0.min(py), y.1.max(py))))
    });
    grown.unwrap_or_default()
}
