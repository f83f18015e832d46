//! The wall of a part, place by place, as the tables of the commands describe it.

use truepath_chart::style::{INK_AFTER, INK_BEFORE, Ink};
use truepath_correction::rows::CorrectionRow;
use truepath_ground::length::Unit;
use truepath_plant::{Milled, judged_trim_mm};

use crate::TraceRow;

/// A place of the nominal wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Arc length of the contour, mm.
    pub s_mm: f64,
    /// Nominal wall, mm.
    pub wall: [f64; 2],
    /// Unit vector into the free side; not a number where the table does not tell it.
    pub free: [f64; 2],
    /// Wall error, mm: positive, material left; not a number where no wall stands.
    pub error_mm: f64,
}

impl Place {
    /// `centre` is the cutter's when it forms this place.
    fn new(s_mm: f64, wall: [f64; 2], centre: [f64; 2], error_mm: f64) -> Self {
        let away = [centre[0] - wall[0], centre[1] - wall[1]];
        let length = away[0].hypot(away[1]);
        Self { s_mm, wall, free: [away[0] / length, away[1] / length], error_mm }
    }

    /// The same in a unit.
    pub(super) fn said(&self, unit: Unit) -> Self {
        let Self { s_mm, wall, free, error_mm } = *self;
        Self { s_mm: unit.said(s_mm), wall: wall.map(|mm| unit.said(mm)), free, error_mm: unit.said(error_mm) }
    }

    /// The milled wall with its error drawn so many times larger.
    pub(super) fn milled(&self, magnify: f64) -> (f64, f64) {
        let error = self.error_mm * magnify;
        (self.wall[0] + self.free[0] * error, self.wall[1] + self.free[1] * error)
    }
}

/// A milled wall.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Name in the legend.
    pub name: String,
    /// Colour and dashes.
    pub ink: Ink,
    /// In the order of the contour.
    pub places: Vec<Place>,
}

impl Wall {
    /// What a pass leaves.
    pub fn of_trace(name: impl Into<String>, ink: Ink, trace: &[TraceRow]) -> Self {
        let place = |r: &TraceRow| Place::new(r.s_mm, [r.wall_x_mm, r.wall_y_mm], [r.x_mm, r.y_mm], r.error_mm);
        Self { name: name.into(), ink, places: trace.iter().map(place).collect() }
    }

    /// What the virtual machine milled, where it is judged: not at the ends, where the cutter comes and goes.
    pub fn of_milled(name: impl Into<String>, ink: Ink, milled: &Milled) -> Self {
        let (path, radius) = (&milled.path, milled.cut.radius_mm);
        let trim = judged_trim_mm(radius);
        let judged = |s: f64| s > trim && s < path.length_mm - trim;
        let along = path.s_mm.iter().zip(path.centre.iter().zip(&path.normal)).zip(milled.mean_errors());
        let places = along.map(|((s, (centre, normal)), error)| {
            let wall = [centre[0] + normal[0] * radius, centre[1] + normal[1] * radius];
            Place::new(*s, wall, *centre, if judged(*s) { error } else { f64::NAN })
        });
        Self { name: name.into(), ink, places: places.collect() }
    }

    /// What is predicted without and with a correction.
    pub fn of_correction(rows: &[CorrectionRow]) -> [Self; 2] {
        let wall = |name: &str, ink, error: fn(&CorrectionRow) -> Option<f64>| {
            let place = |r: &CorrectionRow| {
                Place::new(r.s_mm, [r.wall_x_mm, r.wall_y_mm], [r.x_mm, r.y_mm], error(r).unwrap_or(f64::NAN))
            };
            Self { name: name.to_owned(), ink, places: rows.iter().map(place).collect() }
        };
        [
            wall("without correction", INK_BEFORE, |r| r.predicted_error_before_mm),
            wall("with correction", INK_AFTER, |r| r.predicted_error_after_mm),
        ]
    }

    /// The same in a unit.
    pub(super) fn said(&self, unit: Unit) -> Self {
        Self {
            places: self.places.iter().map(|place| place.said(unit)).collect(),
            name: self.name.clone(),
            ink: self.ink,
        }
    }

    /// The error along the contour.
    pub(super) fn errors(&self) -> Vec<(f64, f64)> {
        self.places.iter().map(|p| (p.s_mm, p.error_mm)).collect()
    }
}

/// A probed place of the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probed {
    /// Where, and how far the wall is off.
    pub place: Place,
    /// Whether the fit gave it little weight.
    pub outlying: bool,
}
