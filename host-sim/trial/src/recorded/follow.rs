//! Which rows of a stretch at one depth go along a contour from its start to its end.

use truepath_plant::{Path, Point};

/// Largest distance of a row from the contour, mm: a correction, and a blended corner.
const TOLERANCE_MM: f64 = 2.0;
/// The association may run ahead by this much at a row, mm: more than a fast feed makes in a slow period.
const AHEAD_MM: f64 = 4.0;
/// A row is the nearest to the start once the distance has grown by this much again, mm.
const PAST_MM: f64 = 0.5;

/// Rows along the contour.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    /// The first of them.
    pub first: usize,
    /// The nominal sample that each of them is beside; never falls.
    pub nominal: Vec<usize>,
    /// Largest distance from the contour, mm.
    pub farthest_mm: f64,
    /// Its root mean square, mm.
    pub off_rms_mm: f64,
}

/// Every time the rows go along the contour; `first` is the number of the first row.
pub(super) fn passes(path: &Path, rows: &[[f64; 3]], first: usize) -> Vec<Followed> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(start) = next_start(path, rows, at) {
        match follow(path, &rows[start..]) {
            Some(mut followed) => {
                at = start + followed.nominal.len();
                followed.first = first + start;
                found.push(followed);
            }
            None => at = start + 1 + rows[start + 1..].iter().take_while(|r| off(r, path.centre[0]) < PAST_MM).count(),
        }
    }
    found
}

fn off(row: &[f64; 3], to: Point) -> f64 {
    (row[0] - to[0]).hypot(row[1] - to[1])
}

/// The last row nearest to the start of the contour, from `at` on; a cutter that waits there begins when it moves.
fn next_start(path: &Path, rows: &[[f64; 3]], at: usize) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (index, row) in rows.iter().enumerate().skip(at) {
        let distance = off(row, path.centre[0]);
        match best {
            Some((_, least)) if distance > least + PAST_MM => break,
            Some((_, least)) if distance > least => {}
            _ if distance < TOLERANCE_MM => best = Some((index, distance)),
            _ => {}
        }
    }
    best.map(|(index, _)| index)
}

/// Follows the contour with the rows; `None` when they leave it before its end.
fn follow(path: &Path, rows: &[[f64; 3]]) -> Option<Followed> {
    let ahead = (AHEAD_MM / path.step_mm).ceil() as usize;
    let last = path.len() - 1;
    let mut nominal = Vec::new();
    let (mut at, mut farthest, mut squares, mut to_end) = (0, 0.0f64, 0.0, f64::INFINITY);
    for row in rows {
        let near = |k: &usize| off(row, path.centre[*k]);
        let best = (at..=(at + ahead).min(last)).min_by(|a, b| near(a).total_cmp(&near(b)))?;
        let distance = near(&best);
        at = best;
        if at == last {
            // Behind the end the distance grows again: the pass is over.
            if distance > to_end + 1e-6 {
                break;
            }
            to_end = distance;
        }
        if distance > TOLERANCE_MM {
            return None;
        }
        let beside = beside(path, at, row);
        farthest = farthest.max(beside);
        squares += beside * beside;
        nominal.push(at);
    }
    let rms = (squares / nominal.len().max(1) as f64).sqrt();
    (at == last).then_some(Followed { first: 0, nominal, farthest_mm: farthest, off_rms_mm: rms })
}

/// Distance from the polyline of the path near a sample, mm.
fn beside(path: &Path, at: usize, row: &[f64; 3]) -> f64 {
    let to = |k: usize| {
        let (a, b) = (path.centre[k], path.centre[k + 1]);
        let (along, across) = ([b[0] - a[0], b[1] - a[1]], [row[0] - a[0], row[1] - a[1]]);
        let square = along[0] * along[0] + along[1] * along[1];
        let share = ((across[0] * along[0] + across[1] * along[1]) / square.max(1e-18)).clamp(0.0, 1.0);
        (across[0] - share * along[0]).hypot(across[1] - share * along[1])
    };
    let last = path.len() - 1;
    to(at.saturating_sub(1)).min(to(at.min(last - 1)))
}
