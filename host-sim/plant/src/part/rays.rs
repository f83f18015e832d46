//! Rays across the wall: normals of the nominal path, on which the stock is measured.
//!
//! There is a ray at every sample of the path, and more where the wall is longer than the path: in a tight inside arc, and as
//! a fan in an inside corner. An open path goes on straight at both ends, with the stock of its end; a closed one goes round.
//!
//! Where the nominal path itself cuts a ray's wall away, beside an outside corner without an arc, there is no part. Stock is
//! there as long as no other leg of the contour is nearer than the raw surface.

use crate::grid::Grid;
use crate::path::{FACET_RAD, Path, Side};
use crate::vector::{Point, along, distance, mix, scaled, turn, turned};

/// A nominal wall point that the nominal path itself cuts away by more than this is not on the part, mm.
pub(super) const UNDERCUT_MM: f64 = 0.02;

/// A normal of the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    /// Where it begins: the nominal centre.
    pub(super) foot: Point,
    /// Towards the wall.
    pub(super) normal: Point,
    /// Its row in the field; rays beyond the ends share those of the contour.
    pub(super) row: usize,
}

/// A ray of the contour and where it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) ray: Ray,
    /// Along the path, mm.
    pub(super) s_mm: f64,
    /// Along the nominal wall, mm.
    pub(super) wall_mm: f64,
    /// Whether a wall of the part is there.
    pub(super) on_part: bool,
}

/// All rays.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    /// Those of the contour, in order.
    pub(super) rows: Vec<Row>,
    /// The same with what goes on beyond both ends.
    all: Vec<Ray>,
    /// Of every sample of the path, in `all`.
    of_sample: Vec<usize>,
    /// Nominal wall points of the rows.
    walls: Grid,
}

impl Rays {
    pub(super) fn new(path: &Path, radius: f64) -> Self {
        let mut rows: Vec<Row> = Vec::with_capacity(path.len() * 2);
        let mut row_of = Vec::with_capacity(path.len());
        let centres = Grid::of(radius, path.centre.iter().copied());
        let mut near = Vec::new();
        let mut push = |foot: Point, normal: Point, s_mm: f64, rolls: bool, rows: &mut Vec<Row>| {
            let wall = along(foot, normal, radius);
            let before = rows.last().map(|last| (last.wall_mm, along(last.ray.foot, last.ray.normal, radius)));
            let wall_mm = before.map_or(0.0, |(at, last)| at + distance(last, wall));
            centres.near(wall, radius - UNDERCUT_MM, &mut near);
            let ray = Ray { foot, normal, row: rows.len() };
            rows.push(Row { ray, s_mm, wall_mm, on_part: near.is_empty() && !rolls });
        };
        let last = path.len() - 1;
        for i in 0..path.len() {
            // The last sample of a closed path is its first.
            let meets = path.closed && i == last && turn(path.normal[last], path.normal[0]).abs() < FACET_RAD;
            if i > 0 {
                let (a, b) = (path.normal[i - 1], if meets { path.normal[0] } else { path.normal[i] });
                between(path, i, (a, b), radius, &mut |foot, normal, s| push(foot, normal, s, false, &mut rows));
            }
            if meets {
                row_of.push(0);
                continue;
            }
            row_of.push(rows.len());
            push(path.centre[i], path.normal[i], path.s_mm[i], path.rolls(i, radius), &mut rows);
        }
        let beyond = 2.0 * radius + 3.0;
        let (mut all, tail) = (ends(path, &rows, beyond, false), ends(path, &rows, beyond, true));
        let shift = all.len();
        all.extend(rows.iter().map(|row| row.ray));
        all.extend(tail);
        let walls = Grid::of(radius.max(2.0), rows.iter().map(|row| along(row.ray.foot, row.ray.normal, radius)));
        let of_sample = row_of.into_iter().map(|row| row + shift).collect();
        Self { rows, all, of_sample, walls }
    }

    /// Number of the ray of a sample of the path, for [`Rays::ray`].
    pub(super) fn of_sample(&self, sample: usize) -> usize {
        self.of_sample[sample.min(self.of_sample.len() - 1)]
    }

    pub(super) fn ray(&self, number: usize) -> Option<&Ray> {
        self.all.get(number)
    }

    /// Rows whose nominal wall point is within `radius` of a point.
    pub(super) fn near(&self, point: Point, radius: f64, found: &mut Vec<u32>) {
        self.walls.near(point, radius, found);
    }
}

/// Rays between two samples where the wall is longer than the path.
fn between(path: &Path, i: usize, normals: (Point, Point), radius: f64, push: &mut dyn FnMut(Point, Point, f64)) {
    let angle = turn(normals.0, normals.1);
    let spreads = (angle > 0.0) == (path.side == Side::Right);
    let long = distance(along(path.centre[i - 1], normals.0, radius), along(path.centre[i], normals.1, radius));
    if !spreads || long <= 1.01 * path.step_mm {
        return;
    }
    // The wall of a turn on the spot is an arc, not its chord.
    let corner = angle.abs() >= FACET_RAD;
    let length = if corner { radius * angle.abs() } else { long };
    let pieces = (length / path.step_mm).ceil();
    for k in usize::from(!corner)..pieces as usize {
        let u = k as f64 / pieces;
        let (foot, s) = if corner {
            (path.centre[i], path.s_mm[i])
        } else {
            let s = path.s_mm[i - 1] + (path.s_mm[i] - path.s_mm[i - 1]) * u;
            (mix(path.centre[i - 1], path.centre[i], u), s)
        };
        push(foot, turned(normals.0, angle * u), s);
    }
}

/// What goes on beyond an end, in the order of the path.
fn ends(path: &Path, rows: &[Row], beyond: f64, after: bool) -> Vec<Ray> {
    let Some(end) = (if after { rows.last() } else { rows.first() }) else { return Vec::new() };
    if path.closed {
        // As much as there is of the other end, once.
        let s = |row: &&Row| if after { row.s_mm <= beyond } else { row.s_mm >= path.length_mm - beyond };
        return rows.iter().filter(s).map(|row| row.ray).collect();
    }
    let count = (beyond / path.step_mm).ceil() as usize;
    let sample = if after { path.len() - 1 } else { 0 };
    let onward = scaled(path.tangent[sample], if after { 1.0 } else { -1.0 });
    let ray = |k: usize| Ray { foot: along(end.ray.foot, onward, k as f64 * path.step_mm), ..end.ray };
    let mut rays: Vec<Ray> = (1..=count).map(ray).collect();
    if !after {
        rays.reverse();
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::Segment;

    #[test]
    fn the_rays_of_an_inside_corner_are_a_fan_as_fine_as_the_path() {
        let legs =
            [Segment::Line { from: [0.0, 30.0], to: [0.0, 0.0] }, Segment::Line { from: [0.0, 0.0], to: [30.0, 0.0] }];
        let path = Path::new(&legs, Side::Right, 0.1).expect("a path");
        let rays = Rays::new(&path, 10.0);
        assert!(rays.rows.windows(2).all(|w| w[1].wall_mm - w[0].wall_mm < 0.11));
        let length = rays.rows[rays.rows.len() - 1].wall_mm;
        assert!((length - 60.0 - 5.0 * std::f64::consts::PI).abs() < 0.01, "{length}");
        assert!(rays.rows.iter().all(|row| row.on_part));
        // Every sample has its own ray.
        for i in 0..path.len() {
            let ray = rays.ray(rays.of_sample(i)).expect("a ray");
            assert!(distance(ray.foot, path.centre[i]) < 1e-12 && ray.normal == path.normal[i]);
        }
    }

    #[test]
    fn beside_an_outside_corner_no_wall_stands() {
        let legs = [
            Segment::Line { from: [-30.0, 0.0], to: [0.0, 0.0] },
            Segment::Line { from: [0.0, 0.0], to: [0.0, -30.0] },
        ];
        let path = Path::new(&legs, Side::Right, 0.1).expect("a path");
        let rays = Rays::new(&path, 10.0);
        for row in &rays.rows {
            assert_eq!(row.on_part, (row.s_mm - 30.0).abs() > 9.9, "{}", row.s_mm);
        }
    }

    #[test]
    fn a_closed_path_goes_round() {
        let at = |a: f64| [20.0 * a.cos(), 20.0 * a.sin()];
        let pi = std::f64::consts::PI;
        let arc = |from: f64, to: f64| Segment::Arc { from: at(from), to: at(to), centre: [0.0, 0.0], ccw: true };
        let path = Path::new(&[arc(0.0, pi), arc(pi, 2.0 * pi)], Side::Right, 0.1).expect("a path");
        let rays = Rays::new(&path, 10.0);
        assert!(path.closed);
        for number in 1..rays.all.len() {
            let (a, b) = (rays.all[number - 1], rays.all[number]);
            assert!(distance(a.foot, b.foot) < 0.11, "ray {number}");
        }
    }
}
