//! A commanded path beside the nominal one: even sampling, and the nominal sample each commanded point belongs to.
//!
//! Points are associated by progress, never by nearness alone, so that closed and self-crossing contours are followed in order.
//! Tolerant to 3 mm, so lead-ins and lead-outs farther away are left out. The cut begins where the command first comes nearest
//! to the start of the contour.

use super::error::PlantError;
use super::path::Path;
use super::vector::{Point, distance, mix, squared_distance};

/// Largest distance of a commanded point from the contour, mm.
const TOLERANCE_MM: f64 = 3.0;
/// The association may run ahead by this much at a point, mm.
const AHEAD_MM: f64 = 8.0;
/// A place is the nearest one once the distance has grown by this much again, mm.
const PAST_MM: f64 = 0.5;
/// Part of the contour that must be covered.
const COVERED: f64 = 0.98;

/// Commanded centres and the nominal samples they belong to.
#[derive(Debug, Clone)]
pub(super) struct Commanded {
    pub(super) centre: Vec<Point>,
    pub(super) nominal: Vec<usize>,
}

impl Commanded {
    /// The nominal path as its own command.
    pub(super) fn nominal(path: &Path) -> Self {
        Self { centre: path.centre.clone(), nominal: (0..path.len()).collect() }
    }

    /// Samples `polyline` as finely as the path and follows the contour with it.
    pub(super) fn following(path: &Path, polyline: &[Point]) -> Result<Self, PlantError> {
        let points = evenly(polyline, path.step_mm);
        let mut out = Self { centre: Vec::with_capacity(points.len()), nominal: Vec::with_capacity(points.len()) };
        let ahead = (AHEAD_MM / path.step_mm).ceil() as usize;
        let last = path.len() - 1;
        let (mut j, mut to_end) = (0, f64::INFINITY);
        for &p in &points[begin(path, &points)..] {
            let mut best = f64::INFINITY;
            let mut nearest = j;
            for k in j..=(j + ahead).min(last) {
                let d = squared_distance(path.centre[k], p);
                if d < best {
                    (best, nearest) = (d, k);
                }
            }
            if best > TOLERANCE_MM * TOLERANCE_MM {
                continue;
            }
            j = nearest;
            if j == last {
                if best > to_end {
                    break;
                }
                to_end = best;
            }
            out.centre.push(p);
            out.nominal.push(j);
        }
        let covered_mm = out.nominal.last().map_or(0.0, |&k| path.s_mm[k]);
        if covered_mm < COVERED * path.length_mm - 2.0 * path.step_mm {
            return Err(PlantError::NotCovered { covered_mm, length_mm: path.length_mm });
        }
        Ok(out)
    }
}

/// First point at which the command is nearest to the start of the contour.
fn begin(path: &Path, points: &[Point]) -> usize {
    let mut best = f64::INFINITY;
    let mut index = 0;
    for (k, &p) in points.iter().enumerate() {
        let d = distance(p, path.centre[0]);
        if d < best {
            (best, index) = (d, k);
        } else if best < TOLERANCE_MM && d > best + PAST_MM {
            break;
        }
    }
    if best < TOLERANCE_MM { index } else { 0 }
}

/// Points of the polyline every `step` mm of its length, the end included.
fn evenly(polyline: &[Point], step: f64) -> Vec<Point> {
    let mut out = Vec::new();
    let Some(&first) = polyline.first() else {
        return out;
    };
    out.push(first);
    let mut due = step;
    for w in polyline.windows(2) {
        let length = distance(w[0], w[1]);
        while due <= length {
            out.push(mix(w[0], w[1], due / length));
            due += step;
        }
        due -= length;
    }
    if let (Some(&end), Some(&last)) = (polyline.last(), out.last())
        && distance(end, last) > 1e-9
    {
        out.push(end);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::path::Side;
    use super::super::segment::Segment;
    use super::*;

    fn line() -> Path {
        let line = Segment::Line { from: [0.0, 0.0], to: [50.0, 0.0] };
        Path::new(&[line], Side::Right, 0.1).expect("valid")
    }

    #[test]
    fn leads_outside_the_tolerance_are_left_out() {
        let command = [[-5.0, 20.0], [0.0, 20.0], [0.0, 0.1], [50.0, 0.1], [50.0, 20.0]];
        let c = Commanded::following(&line(), &command).expect("covers");
        assert!(distance(c.centre[0], [0.0, 0.1]) < 0.11);
        assert!(distance(c.centre[c.centre.len() - 1], [50.0, 0.1]) < 0.11);
        assert!(c.centre.windows(2).all(|w| distance(w[0], w[1]) <= 0.1 + 1e-9));
    }

    #[test]
    fn a_command_that_stops_half_way_is_refused() {
        let error = Commanded::following(&line(), &[[0.0, 0.0], [25.0, 0.0]]).expect_err("half");
        assert!(matches!(error, PlantError::NotCovered { covered_mm, .. } if (covered_mm - 25.0).abs() < 0.2));
    }

    #[test]
    fn a_command_shifted_along_the_path_keeps_its_order() {
        let c = Commanded::following(&line(), &[[-1.0, 0.3], [51.0, 0.3]]).expect("covers");
        assert!(c.nominal.windows(2).all(|w| w[1] >= w[0]));
        assert_eq!(c.nominal[0], 0);
    }
}
