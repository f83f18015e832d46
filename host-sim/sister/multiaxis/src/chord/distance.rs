//! Distance of the moving point from its chord, with the bounds a proof needs.

use super::super::kinematics::{Course, Jet};
use super::super::vector::{Vector, add_scaled, dot, norm, sub, unit};
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

    fn across(&self, v: Vector) -> Vector {
        add_scaled(v, self.along, -dot(v, self.along))
    }

    /// Whether the foot of the point stays on the chord over a piece.
    fn keeps_beside(&self, piece: &Sample<'_>, along_second: f64, slip: f64) -> bool {
        let (a, b) = (dot(sub(piece.from, self.start), self.along), dot(sub(piece.to, self.start), self.along));
        let rounding = self.course.rounding();
        let inside = |lowest: f64, highest: f64| lowest >= -rounding && highest <= self.length + rounding;
        let slowest = dot(piece.middle.first, self.along) - piece.half * (along_second + slip / 2.0);
        let sag = piece.half * piece.half / 2.0 * (along_second + slip);
        (slowest > 0.0 && inside(a, b)) || inside(a.min(b) - sag, a.max(b) + sag)
    }

    /// Largest length of the second Taylor polynomial across the chord: exact in the direction of its middle, bounded
    /// perpendicular to it.
    fn parabola(&self, piece: &Sample<'_>) -> f64 {
        let middle = self.across(sub(piece.middle.place, self.start));
        let Some(out) = unit(middle) else { return f64::INFINITY };
        let (first, second) = (self.across(piece.middle.first), self.across(piece.middle.second));
        let half = piece.half;
        let (level, slope, curve) = (norm(middle), dot(first, out), dot(second, out) / 2.0);
        let end = level + half * half * curve;
        let mut highest = (end + half * slope).abs().max((end - half * slope).abs());
        if slope.abs() < 2.0 * half * curve.abs() {
            highest = highest.max((level - slope * slope / (4.0 * curve)).abs());
        }
        let aside = |v: Vector| norm(add_scaled(v, out, -dot(v, out)));
        highest.hypot(half * aside(first) + half * half / 2.0 * aside(second))
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

    /// Where the point cannot be beyond an end of the chord, only its way across the chord counts: the lesser of the
    /// bound by its acceleration and of its parabola with the remainder of Taylor's theorem.
    fn ceiling(&self, piece: &Sample<'_>, ends: f64) -> f64 {
        let bounds = self.course.bounds();
        let (half, slip) = (piece.half, piece.half * bounds.third);
        let (along_second, across_second) = self.split(piece.middle.second);
        let by = |second: f64| ends + half * half / 2.0 * second;
        let whole = by((norm(piece.middle.second) + slip).min(bounds.second));
        if self.keeps_beside(piece, along_second.abs(), slip) {
            by(across_second + slip).min(self.parabola(piece) + half * half * slip / 6.0).min(whole)
        } else {
            whole
        }
    }

    fn steepest_bend(&self) -> f64 {
        self.course.bounds().second
    }

    fn rounding(&self) -> f64 {
        self.course.rounding()
    }
}
