//! Where a cutter has been, and which part of its present circle that leaves in the material.
//!
//! In a slot the material is everywhere but where the cutter was. The front half of the circle, immersion 0…π, cuts;
//! an earlier circle at distance d covers the arc acos(d/2r) to either side of the direction towards it. What is left is
//! engaged: 180° in a straight slot and in arcs wider than the cutter, 90° just behind a square corner, in between on
//! tighter arcs, nothing where the path crosses a slot already cut.

use std::collections::HashMap;
use std::f64::consts::PI;

use fnv::FnvBuildHasher;

/// Nearer than this an earlier circle is the present one, mm.
const SAME_MM: f64 = 1e-6;

/// Points in square cells.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    size: f64,
    cells: HashMap<(i64, i64), Vec<u32>, FnvBuildHasher>,
    points: Vec<[f64; 2]>,
}

impl Cells {
    /// For searches up to `reach` mm.
    pub(super) fn new(reach: f64) -> Self {
        Self { size: reach, cells: HashMap::default(), points: Vec::new() }
    }
    fn cell(&self, p: [f64; 2]) -> (i64, i64) {
        ((p[0] / self.size).floor() as i64, (p[1] / self.size).floor() as i64)
    }
    pub(super) fn push(&mut self, p: [f64; 2]) {
        let cell = self.cell(p);
        self.cells.entry(cell).or_default().push(self.points.len() as u32);
        self.points.push(p);
    }
    /// The points in the cells within reach of a place, and perhaps some farther ones.
    pub(super) fn near(&self, p: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        let (cx, cy) = self.cell(p);
        let around = (-1..=1).flat_map(move |i| (-1..=1).map(move |j| (cx + i, cy + j)));
        around.filter_map(|cell| self.cells.get(&cell)).flatten().map(|k| self.points[*k as usize])
    }
}

/// The frame of a circle: centre, normal towards the near wall, travel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) centre: [f64; 2],
    pub(super) normal: [f64; 2],
    pub(super) heading: [f64; 2],
    pub(super) radius: f64,
}

/// What is left of the front half circle, as immersion angles from the near wall towards the travel, in order.
pub(super) fn engaged(frame: &Frame, earlier: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    // Covered arcs, clipped to the front.
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for other in earlier {
        let v = [other[0] - frame.centre[0], other[1] - frame.centre[1]];
        let distance = v[0].hypot(v[1]);
        if distance < SAME_MM || distance >= 2.0 * frame.radius {
            continue;
        }
        let along = |axis: [f64; 2]| v[0] * axis[0] + v[1] * axis[1];
        let middle = along(frame.heading).atan2(along(frame.normal));
        let half = (0.5 * distance / frame.radius).acos();
        for turn in [-2.0 * PI, 0.0, 2.0 * PI] {
            let (low, high) = ((middle - half + turn).max(0.0), (middle + half + turn).min(PI));
            if high > low {
                covered.push([low, high]);
            }
        }
    }
    covered.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut left = Vec::new();
    let mut at = 0.0;
    for [low, high] in covered {
        if low > at {
            left.push([at, low]);
        }
        at = at.max(high);
    }
    if at < PI {
        left.push([at, PI]);
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: f64 = 6.0;

    fn frame(centre: [f64; 2], heading: [f64; 2]) -> Frame {
        // Near wall on the right of travel.
        Frame { centre, normal: [heading[1], -heading[0]], heading, radius: RADIUS }
    }

    fn degrees(arcs: &[[f64; 2]]) -> f64 {
        arcs.iter().map(|[a, b]| b - a).sum::<f64>().to_degrees()
    }

    fn leg(length: f64) -> impl Iterator<Item = [f64; 2]> {
        (0..=(length * 20.0) as i32).map(move |k| [f64::from(k) / 20.0 - length, 0.0])
    }

    #[test]
    fn a_straight_slot_engages_the_whole_front() {
        let arcs = engaged(&frame([0.0, 0.0], [1.0, 0.0]), leg(30.0));
        assert!((degrees(&arcs) - 180.0).abs() < 1e-9, "{arcs:?}");
    }

    #[test]
    fn behind_a_square_corner_it_grows_from_90_to_180_degrees_by_the_geometry_of_the_first_leg() {
        // Turn to the left into +y: at a distance d the first leg's strip |y| < r covers the rear quarter of the front up to
        // sin a = 1 − d/r above the horizontal.
        for d in [0.05, 1.0, 3.0, 5.0] {
            let arcs = engaged(&frame([0.0, d], [0.0, 1.0]), leg(30.0));
            let expected = 180.0 - (1.0 - d / RADIUS).asin().to_degrees();
            assert!((degrees(&arcs) - expected).abs() < 0.5, "{d}: {arcs:?} {expected}");
        }
    }

    #[test]
    fn a_wide_arc_engages_the_whole_front_and_a_tight_one_less() {
        let arc = |rho: f64| {
            let step = 0.05 / rho;
            let earlier = (1..200).map(move |k| {
                let a = -f64::from(k) * step;
                [rho * a.sin(), rho - rho * a.cos()]
            });
            degrees(&engaged(&frame([0.0, 0.0], [1.0, 0.0]), earlier))
        };
        assert!((arc(8.0) - 180.0).abs() < 1e-6, "{}", arc(8.0));
        assert!(arc(3.0) < 179.0, "{}", arc(3.0));
    }

    #[test]
    fn crossing_a_slot_already_cut_engages_nothing() {
        let cut = (-200..=200).map(|k| [0.05 * f64::from(k), 0.0]);
        // Just below its middle: on it the cutter stands where it was before.
        assert!(engaged(&frame([0.0, -0.01], [0.0, 1.0]), cut).is_empty());
    }
}
