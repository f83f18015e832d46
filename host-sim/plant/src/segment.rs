//! One line or arc of a centre path: length, place and heading along it.

use std::f64::consts::TAU;

use super::error::PlantError;
use super::vector::{Point, cross, distance, dot, left_of, mix, norm, scaled, sub, unit};

/// Ends of an arc may differ this much in radius, mm (LinuxCNC's bound for rounded coordinates); the arc is then a spiral.
const SPIRAL_MM: f64 = 0.0283;

/// One piece of the path of the cutter's centre, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Straight move.
    Line {
        /// Start.
        from: Point,
        /// End.
        to: Point,
    },
    /// Circular move; equal ends are a full circle.
    Arc {
        /// Start.
        from: Point,
        /// End.
        to: Point,
        /// Centre, absolute.
        centre: Point,
        /// Counter-clockwise seen from +Z (G3).
        ccw: bool,
    },
}

impl Segment {
    /// Start.
    pub fn from(&self) -> Point {
        match *self {
            Self::Line { from, .. } | Self::Arc { from, .. } => from,
        }
    }

    /// End.
    pub fn to(&self) -> Point {
        match *self {
            Self::Line { to, .. } | Self::Arc { to, .. } => to,
        }
    }

    /// Length, mm.
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { from, to } => distance(from, to),
            Self::Arc { from, centre, .. } => self.sweep().abs() * distance(from, centre),
        }
    }

    /// Signed angle swept, rad; 0 for a line.
    fn sweep(&self) -> f64 {
        let Self::Arc { from, to, centre, ccw } = *self else {
            return 0.0;
        };
        let (a, b) = (sub(from, centre), sub(to, centre));
        let sign = if ccw { 1.0 } else { -1.0 };
        // Measured in the sense of travel, so that a mirrored arc has exactly the mirrored sweep.
        let angle = (sign * cross(a, b)).atan2(dot(a, b));
        let angle = if angle < 1e-9 { angle + TAU } else { angle };
        sign * angle.min(TAU)
    }

    /// Place and unit direction of travel at the fraction `u` (0…1) of the length.
    pub(super) fn at(&self, u: f64) -> (Point, Point) {
        match *self {
            Self::Line { from, to } => (mix(from, to, u), unit(sub(to, from))),
            Self::Arc { from, to, centre, .. } => {
                let sweep = self.sweep();
                let start = sub(from, centre);
                let (r0, r1) = (norm(start), distance(to, centre));
                let ray = unit(super::vector::turned(start, sweep * u));
                let place = super::vector::along(centre, ray, r0 + (r1 - r0) * u);
                (place, scaled(left_of(ray), sweep.signum()))
            }
        }
    }

    pub(super) fn check(&self, index: usize) -> Result<(), PlantError> {
        if let Self::Arc { from, to, centre, .. } = *self {
            let (start_mm, end_mm) = (distance(from, centre), distance(to, centre));
            let off = (start_mm - end_mm).abs();
            if start_mm < 1e-9 || off.is_nan() || off > SPIRAL_MM.max(0.001 * start_mm) {
                return Err(PlantError::ArcRadii { segment: index, start_mm, end_mm });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_arc_ends_where_it_says_and_heads_along_its_tangent() {
        let arc = Segment::Arc { from: [34.0, 35.0], to: [39.0, 30.0], centre: [39.0, 35.0], ccw: true };
        assert!((arc.length() - 2.5 * std::f64::consts::PI).abs() < 1e-12);
        let (p, t) = arc.at(1.0);
        assert!(distance(p, [39.0, 30.0]) < 1e-12);
        assert!(distance(t, [1.0, 0.0]) < 1e-12);
        let (_, t) = arc.at(0.0);
        assert!(distance(t, [0.0, -1.0]) < 1e-12);
    }

    #[test]
    fn equal_ends_are_a_full_circle() {
        let circle = Segment::Arc { from: [5.0, 0.0], to: [5.0, 0.0], centre: [0.0, 0.0], ccw: false };
        assert!((circle.length() - 5.0 * TAU).abs() < 1e-9);
        assert!(distance(circle.at(0.25).0, [0.0, -5.0]) < 1e-9);
    }

    #[test]
    fn the_long_way_round_is_taken_when_the_sense_asks_for_it() {
        let arc = Segment::Arc { from: [1.0, 0.0], to: [0.0, 1.0], centre: [0.0, 0.0], ccw: false };
        assert!((arc.length() - 0.75 * TAU).abs() < 1e-12);
    }
}
