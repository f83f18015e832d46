//! Distance of a tool axis from the great circle between the ends of its move.

use super::super::chord::{Curve, Sample};
use super::super::kinematics::{Course, Jet};
use super::super::vector::{Vector, add_scaled, angle, cross, dot, norm, unit};

/// A tool axis on its way, and the flat cone spanned by its ends.
pub(super) struct FromArc<'c> {
    course: &'c Course,
    ends: [Vector; 2],
    /// Normal of the plane of both ends; `None` when they are one.
    normal: Option<Vector>,
}

impl<'c> FromArc<'c> {
    pub(super) fn new(course: &'c Course) -> Self {
        let ends = [course.place(0.0), course.place(1.0)];
        let opposite = dot(ends[0], ends[1]) < 0.0;
        // Opposite ends span no plane: then the great circle is the one through the middle of the move.
        let normal = match unit(cross(ends[0], ends[1])) {
            Some(_) if norm(cross(ends[0], ends[1])) < 1e-9 => {
                opposite.then(|| unit(cross(ends[0], course.place(0.5)))).flatten()
            }
            None if opposite => unit(cross(ends[0], course.place(0.5))),
            normal => normal,
        };
        Self { course, ends, normal }
    }

    /// Angle between a direction and the arc.
    pub(super) fn angle(&self, v: Vector) -> f64 {
        match self.normal {
            Some(normal) if self.over(normal, v) => dot(v, normal).abs().min(1.0).asin(),
            _ => angle(v, self.ends[0]).min(angle(v, self.ends[1])),
        }
    }

    /// Whether the foot of `v` on the plane lies between both ends.
    fn over(&self, normal: Vector, v: Vector) -> bool {
        dot(cross(self.ends[0], v), normal) >= 0.0 && dot(cross(v, self.ends[1]), normal) >= 0.0
    }
}

impl Curve for FromArc<'_> {
    fn distance(&self, v: Vector) -> f64 {
        match self.normal {
            Some(normal) if self.over(normal, v) => dot(v, normal).abs(),
            _ => self.ends.iter().map(|&end| from_ray(end, v)).fold(f64::INFINITY, f64::min),
        }
    }

    fn jet(&self, t: f64) -> Jet {
        self.course.jet(t)
    }

    fn ceiling(&self, piece: &Sample<'_>, ends: f64) -> f64 {
        let bounds = self.course.bounds();
        let bend = (norm(piece.middle.second) + piece.half * bounds.third).min(bounds.second);
        ends + piece.half * piece.half / 2.0 * bend
    }

    fn steepest_bend(&self) -> f64 {
        self.course.bounds().second
    }

    fn rounding(&self) -> f64 {
        self.course.rounding()
    }
}

/// Distance of a point from the ray through a unit vector.
fn from_ray(ray: Vector, v: Vector) -> f64 {
    let along = dot(v, ray);
    norm(if along > 0.0 { add_scaled(v, ray, -along) } else { v })
}
