//! Distance of the moving point from its chord, with the bounds a proof needs.

use super::super::kinematics::vector::{Vector, add_scaled, dot, norm, sub, unit};
use super::super::kinematics::{Course, Jet};
use super::certified::{Curve, Sample};

/// The distance of a course from the segment between its ends.
pub(super) struct FromChord<'c> {
    course: &'c Course,
    start: Vector,
    /// Unit vector of the chord; zero when it has no length.
    along: Vector,
    length: f64,
}

impl<'c> FromChord<'c> {
    pub(super) fn new(course: &'c Course) -> Self {
        let start = course.place(0.0);
        let chord = sub(course.place(1.0), start);
        let length = norm(chord);
        let along = unit(chord).unwrap_or([0.0; 3]);
        Self { course, start, along, length }
    }

    fn split(&self, v: Vector) -> (f64, f64) {
        let along = dot(v, self.along);
        (along, norm(add_scaled(v, self.along, -along)))
    }
}

impl Curve for FromChord<'_> {
    fn distance(&self, place: Vector) -> f64 {
        let (along, across) = self.split(sub(place, self.start));
        let beyond = (along - self.length).max(-along).max(0.0);
        across.hypot(beyond)
    }

    fn jet(&self, t: f64) -> Jet {
        self.course.jet(t)
    }

    /// Where the point cannot be beyond an end of the chord, only its acceleration across the chord counts.
    fn bend(&self, piece: &Sample<'_>) -> f64 {
        let bounds = self.course.bounds();
        let half = piece.half;
        let (along_second, across_second) = self.split(piece.middle.second);
        let slip = half * bounds.third;
        let whole = (norm(piece.middle.second) + slip).min(bounds.second);
        let (a, b) = (dot(sub(piece.from, self.start), self.along), dot(sub(piece.to, self.start), self.along));
        let sag = half * half / 2.0 * (along_second.abs() + slip).min(bounds.second);
        let slowest = dot(piece.middle.first, self.along) - half * (along_second.abs() + slip / 2.0);
        let rounding = self.rounding();
        let inside = |lowest: f64, highest: f64| lowest >= -rounding && highest <= self.length + rounding;
        let monotone = slowest > 0.0 && inside(a, b);
        if monotone || inside(a.min(b) - sag, a.max(b) + sag) { (across_second + slip).min(whole) } else { whole }
    }

    fn steepest_bend(&self) -> f64 {
        self.course.bounds().second
    }

    fn rounding(&self) -> f64 {
        self.course.rounding()
    }
}
