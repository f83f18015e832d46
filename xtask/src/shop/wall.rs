//! A wall as the virtual machine left it, judged where there is one.
//!
//! `judged` of `simulate` leaves out both ends of every contour. Here a closed contour is judged all round, its seam included,
//! and nothing is judged beside a place where the wall ends: at a corner the direction of the error is anybody's choice. A
//! corner in which a contour begins and ends is one like the others.

use std::fs;
use std::path::Path;

/// Left out at the ends of an open contour, mm, or this share of the cutter's diameter if that is more.
const ENDS: (f64, f64) = (6.0, 0.4);
/// Left out beside a corner, mm.
const CORNER_MM: f64 = 1.0;
/// Walls at the two ends of a closed contour that are farther apart belong to two sides of a corner, mm.
const SAME_WALL_MM: f64 = 0.1;
/// A wall that advances by less than this share of the path is a corner that the cutter rolls about.
const ROLLED: f64 = 0.05;

/// A row of `trace.csv` with its row of `wall.csv`.
#[derive(Clone, Copy, Debug)]
struct Row {
    s_mm: f64,
    centre: [f64; 2],
    wall: [f64; 2],
    error_mm: f64,
}

/// The largest wall error in the folder of a simulation, mean over the height, mm; `None` where nothing is wall.
pub fn largest_error_mm(folder: &Path, diameter_mm: f64) -> Option<f64> {
    let trace = numbers(&folder.join("trace.csv"), ["s_mm", "x_mm", "y_mm", "error_mm"])?;
    let wall = numbers(&folder.join("wall.csv"), ["s_mm", "x_mm", "y_mm", "nx"])?;
    let rows: Vec<Row> = trace
        .iter()
        .zip(&wall)
        .map(|(t, w)| Row { s_mm: t[0], centre: [t[1], t[2]], wall: [w[1], w[2]], error_mm: t[3] })
        .collect();
    largest(&rows, diameter_mm)
}

fn largest(rows: &[Row], diameter_mm: f64) -> Option<f64> {
    let (first, last) = (rows.first()?, rows.last()?);
    let is_closed = apart(first.centre, last.centre) < 0.01;
    let ends = ENDS.0.max(ENDS.1 * diameter_mm);
    let mut corners: Vec<f64> = rows.iter().filter(|row| !row.error_mm.is_finite()).map(|row| row.s_mm).collect();
    for pair in rows.windows(2) {
        let (path, wall) = (pair[1].s_mm - pair[0].s_mm, apart(pair[0].wall, pair[1].wall));
        // A wall that jumps belongs to an inside corner, one that stands to an outside one.
        if wall < ROLLED * path || wall > 10.0 * path {
            corners.extend([pair[0].s_mm, pair[1].s_mm]);
        }
    }
    if is_closed && apart(first.wall, last.wall) > SAME_WALL_MM {
        corners.extend([first.s_mm, last.s_mm]);
    }
    // Across the seam of a closed contour as well.
    let length = last.s_mm - first.s_mm;
    if is_closed {
        let beyond: Vec<f64> = corners.iter().flat_map(|s| [s - length, s + length]).collect();
        corners.extend(beyond);
    }
    corners.sort_by(f64::total_cmp);
    let near_corner = |s: f64| {
        let after = corners.partition_point(|c| *c < s);
        let beside = [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|k| corners.get(k));
        beside.into_iter().any(|c| (c - s).abs() < CORNER_MM)
    };
    let counts = |row: &&Row| {
        let within = is_closed || (row.s_mm > first.s_mm + ends && row.s_mm < last.s_mm - ends);
        within && row.error_mm.is_finite() && !near_corner(row.s_mm)
    };
    rows.iter().filter(counts).map(|row| row.error_mm.abs()).reduce(f64::max)
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Columns of a table by name; what is no number is none.
fn numbers(file: &Path, names: [&str; 4]) -> Option<Vec<[f64; 4]>> {
    let text = fs::read_to_string(file).ok()?;
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next()?.split(',').collect();
    let places = names.map(|name| head.iter().position(|h| *h == name));
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        places.map(|p| p.and_then(|p| fields.get(p)?.parse().ok()).unwrap_or(f64::NAN))
    };
    Some(lines.map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 mm along x, a corner rolled by a cutter of 10 mm, 20 mm along −y; wrong by `error(s)`.
    fn rolled(error: impl Fn(f64) -> f64) -> Vec<Row> {
        let row = |k: i32| {
            let s = f64::from(k) * 0.1;
            let turn = ((s - 20.0) / 5.0).clamp(0.0, std::f64::consts::FRAC_PI_2);
            let legs = [s.min(20.0), (s - 20.0 - 5.0 * std::f64::consts::FRAC_PI_2).max(0.0)];
            let wall = [legs[0], -legs[1]];
            let centre = [wall[0] + 5.0 * turn.sin(), wall[1] + 5.0 * turn.cos()];
            Row { s_mm: s, centre, wall, error_mm: error(s) }
        };
        (0..470).map(row).collect()
    }

    #[test]
    fn the_point_of_a_rolled_corner_and_the_ends_are_no_wall() {
        let spoiled = |s: f64| if (19.5..28.5).contains(&s) || !(5.0..=42.0).contains(&s) { 4.0 } else { 0.02 };
        assert_eq!(largest(&rolled(spoiled), 10.0), Some(0.02));
        assert_eq!(largest(&rolled(|s| if s > 30.0 && s < 31.0 { -0.5 } else { 0.0 }), 10.0), Some(0.5));
    }

    #[test]
    fn a_corner_at_the_seam_is_no_wall_but_what_lies_beside_it_is() {
        // Round a pocket of 30 by 20 mm with a cutter of 10 mm, from one of its corners.
        let spoiled_at = |near: f64| {
            let legs = [
                ([0.0, 0.0], [20.0, 0.0]),
                ([20.0, 0.0], [20.0, 10.0]),
                ([20.0, 10.0], [0.0, 10.0]),
                ([0.0, 10.0], [0.0, 0.0]),
            ];
            let mut rows: Vec<Row> = Vec::new();
            for (from, to) in legs {
                let length = apart(from, to);
                let heading = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
                let begin = rows.last().map_or(0.0, |row| row.s_mm);
                for k in usize::from(begin > 0.0)..=(length * 10.0) as usize {
                    let along = k as f64 * 0.1;
                    let centre = [from[0] + heading[0] * along, from[1] + heading[1] * along];
                    let s_mm = begin + along;
                    let error_mm = if s_mm < near || s_mm > 60.0 - near { 0.3 } else { 0.01 };
                    rows.push(Row {
                        s_mm,
                        centre,
                        wall: [centre[0] + 5.0 * heading[1], centre[1] - 5.0 * heading[0]],
                        error_mm,
                    });
                }
            }
            largest(&rows, 10.0)
        };
        assert_eq!(spoiled_at(0.9), Some(0.01));
        assert_eq!(spoiled_at(1.3), Some(0.3));
    }

    #[test]
    fn a_closed_contour_is_judged_at_its_seam() {
        let circle = |k: i32| {
            let turn = f64::from(k) / 300.0 * std::f64::consts::TAU;
            let at = |r: f64| [r * turn.cos(), r * turn.sin()];
            let error_mm = if k == 0 { 0.3 } else { 0.1 };
            Row { s_mm: 20.0 * turn, centre: at(20.0), wall: at(15.0), error_mm }
        };
        assert_eq!(largest(&(0..=300).map(circle).collect::<Vec<_>>(), 10.0), Some(0.3));
    }
}
