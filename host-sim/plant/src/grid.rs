//! Points sorted into square cells, so that "everything near here" costs the same on a short and on a long contour.

use std::collections::HashMap;

use super::vector::{Point, squared_distance};

/// Numbered points in square cells.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    cell: f64,
    cells: HashMap<(i64, i64), Vec<u32>>,
    points: Vec<Point>,
}

impl Grid {
    /// Empty grid; `cell` is best the usual search radius, mm.
    pub(super) fn new(cell: f64) -> Self {
        Self { cell, cells: HashMap::new(), points: Vec::new() }
    }

    pub(super) fn of(cell: f64, points: impl IntoIterator<Item = Point>) -> Self {
        let mut grid = Self::new(cell);
        for p in points {
            grid.push(p);
        }
        grid
    }

    /// Adds a point; its number is the count of points before it.
    pub(super) fn push(&mut self, p: Point) {
        let key = self.key(p);
        self.cells.entry(key).or_default().push(self.points.len() as u32);
        self.points.push(p);
    }

    /// Numbers of the points within `radius` of `p`, ascending, into `found`.
    pub(super) fn near(&self, p: Point, radius: f64, found: &mut Vec<u32>) {
        found.clear();
        let (lo, hi) = (self.key([p[0] - radius, p[1] - radius]), self.key([p[0] + radius, p[1] + radius]));
        for ix in lo.0..=hi.0 {
            for iy in lo.1..=hi.1 {
                if let Some(cell) = self.cells.get(&(ix, iy)) {
                    let within = |&&k: &&u32| squared_distance(self.points[k as usize], p) <= radius * radius;
                    found.extend(cell.iter().filter(within));
                }
            }
        }
        found.sort_unstable();
    }

    fn key(&self, p: Point) -> (i64, i64) {
        ((p[0] / self.cell).floor() as i64, (p[1] / self.cell).floor() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_exactly_the_points_within_the_radius() {
        let points: Vec<Point> = (0..400).map(|k| [f64::from(k % 20) - 9.7, f64::from(k / 20) - 9.3]).collect();
        let grid = Grid::of(3.0, points.iter().copied());
        let mut found = Vec::new();
        grid.near([-1.2, 0.4], 4.5, &mut found);
        let brute: Vec<u32> =
            (0..400).filter(|&k| squared_distance(points[k as usize], [-1.2, 0.4]) <= 4.5 * 4.5).collect();
        assert!(!brute.is_empty());
        assert_eq!(found, brute);
    }
}
