//! The wall left by a pass: the envelope of the cutter's circles, measured along the nominal normal.
//!
//! Where the deflection changes along the path the envelope cuts deeper than the centre on the normal would say (by about
//! r·g²/2, g the slope of the deflection), so it is taken from all circles that reach near the nominal wall point.

use super::grid::Grid;
use super::mill::{Milled, Track};
use super::vector::{Point, along, dot, squared_distance, sub};

/// Circles that end farther from the nominal wall than this do not make it, mm.
pub(super) const REACH_MM: f64 = 2.0;
/// A nominal wall point that the nominal path itself cuts away by more than this is not on the part, mm.
const UNDERCUT_MM: f64 = 0.02;

impl Milled {
    /// Wall error at each nominal sample for each height (0 tip … 1 top), mm: positive = material left, NaN where no wall is
    /// defined (never reached, cut away at an outside corner, or the edge of one that the cutter rolls about).
    pub fn wall_errors(&self, levels: &[f64]) -> Vec<Vec<f64>> {
        let path = &self.path;
        let radius = self.cut.radius_mm;
        let tracks: Vec<Vec<Track>> = levels.iter().map(|&l| self.tracks(l)).collect();
        let commanded = Grid::of(radius + REACH_MM, self.samples.iter().map(|s| s.commanded));
        let nominal = Grid::of(radius + REACH_MM, path.centre.iter().copied());
        let mut errors = vec![vec![f64::NAN; path.len()]; levels.len()];
        let mut near = Vec::new();
        for (i, &normal) in path.normal.iter().enumerate() {
            let wall = path.wall(i, radius);
            nominal.near(wall, radius - UNDERCUT_MM, &mut near);
            if !near.is_empty() || path.rolls(i, radius) {
                continue;
            }
            commanded.near(wall, radius + REACH_MM, &mut near);
            for (level, tracks) in tracks.iter().enumerate() {
                let depth = tracks.iter().map(|t| deepest(t, wall, normal, &near)).fold(f64::NEG_INFINITY, f64::max);
                if depth > f64::NEG_INFINITY {
                    errors[level][i] = -depth;
                }
            }
        }
        errors
    }

    /// The wall as cut at each of `levels`, in the sense of travel, mm. Undefined places are left out.
    pub fn walls(&self, levels: &[f64]) -> Vec<Vec<Point>> {
        let place = |(i, e): (usize, &f64)| {
            e.is_finite().then(|| along(self.path.wall(i, self.cut.radius_mm), self.path.normal[i], -e))
        };
        self.wall_errors(levels).iter().map(|row| row.iter().enumerate().filter_map(place).collect()).collect()
    }

    /// The wall as cut, averaged over `levels`, in the sense of travel, mm: the stock of a next pass. Undefined places are left out.
    pub fn surface(&self, levels: &[f64]) -> Vec<Point> {
        let errors = self.wall_errors(levels);
        let n = levels.len() as f64;
        (0..self.path.len())
            .filter_map(|i| {
                let e = errors.iter().map(|row| row[i]).sum::<f64>() / n;
                e.is_finite().then(|| along(self.path.wall(i, self.cut.radius_mm), self.path.normal[i], -e))
            })
            .collect()
    }
}

/// How far the circles go beyond the wall point along its normal, mm; −∞ if none crosses the normal within reach.
fn deepest(track: &Track, wall: Point, normal: Point, near: &[u32]) -> f64 {
    let rr = track.radius_mm * track.radius_mm;
    let mut depth = f64::NEG_INFINITY;
    for &k in near {
        let centre = track.centre[k as usize];
        let along = dot(sub(centre, wall), normal);
        let room = rr - (squared_distance(centre, wall) - along * along);
        if room > 0.0 {
            let end = along + room.sqrt();
            // At the end of a wall the flank of a circle may cross the normal far out in the stock; that makes no wall.
            if end > -REACH_MM {
                depth = depth.max(end);
            }
        }
    }
    depth
}
