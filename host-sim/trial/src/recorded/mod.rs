//! A recorded tool path as the plant cuts along it: where the controller really went, and how fast.
//!
//! A controller does not follow a program exactly: it blends corners, slows down in them, accelerates and stops, and a
//! compensator adds to what it commands. A recording of its setpoints holds all of that. [`cut_path`] takes the rows of
//! one pass out of it: at the depth of the pass, along its contour from start to end (`follow`), with the feed per
//! tooth at each place (`pace`) from the times of the rows and the recorded spindle speed.
//!
//! Limits: the cutter is where the rows say; a drive that lags is seen only in a recording of measured positions. The
//! plant is quasi-static: a standstill leaves the mark of the smallest chip, not that of the time it lasts.
//!
//! | code | meaning |
//! |---|---|
//! | S006 | no rows along the contour at its depth |
//! | S007 | the spindle stands still in the pass |

mod follow;
mod pace;

use follow::Followed;
use serde::Serialize;
use truepath_core::rewrite::TURN_ONE;
use truepath_ground::diagnostics::InputError;
use truepath_plant as plant;
use truepath_plant::{FeedChange, Path, Point};

use crate::codes::S006;
use crate::replay::Placement;
use crate::setpoints::Setpoints;

/// Rows this near to the depth of the pass are of it, mm.
const DEPTH_MM: f64 = 0.05;

/// A pass of a recording.
#[derive(Clone, Debug)]
pub struct CutPath {
    /// Centres, program coordinates, mm.
    pub centre: Vec<Point>,
    /// Feed at the start of the contour, mm/min at the speed of the spindle that the cut has.
    pub feed_mm_per_min: f64,
    /// Where it changes.
    pub feed_changes: Vec<FeedChange>,
    /// What it is.
    pub facts: Facts,
}

/// What was found in a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Time of the first row of the pass, s.
    pub from_s: f64,
    /// Time of its last row, s.
    pub to_s: f64,
    /// Rows of the pass.
    pub rows: usize,
    /// Passes along the contour in the recording, this one included.
    pub passes: usize,
    /// Largest distance of a row from the nominal path, mm.
    pub farthest_mm: f64,
    /// Its root mean square, mm.
    pub off_rms_mm: f64,
    /// Least feed away from the ends, as a share of that of the program.
    pub least_feed: f64,
    /// Greatest feed, likewise.
    pub greatest_feed: f64,
}

/// Takes the pass along `path` at the height `z_mm` out of a recording.
///
/// Of several the one nearest to the path is taken: roughing at the same depth is farther off.
///
/// # Errors
/// `S006`, `S007`.
pub fn cut_path(
    setpoints: &Setpoints,
    placement: &Placement,
    path: &Path,
    cut: &plant::Cut,
    z_mm: f64,
) -> Result<CutPath, InputError> {
    let rows: Vec<[f64; 3]> = setpoints.rows.iter().map(|row| program_mm(row.position_nm, placement)).collect();
    let mut found: Vec<Followed> = Vec::new();
    let mut at = 0;
    while at < rows.len() {
        let deep = |row: &[f64; 3]| (row[2] - z_mm).abs() <= DEPTH_MM;
        let end = at + rows[at..].iter().take_while(|r| deep(r)).count();
        found.extend(follow::passes(path, &rows[at..end], at));
        at = end.max(at + 1);
    }
    let passes = found.len();
    let Some(best) = found.into_iter().min_by(|a, b| a.off_rms_mm.total_cmp(&b.off_rms_mm)) else {
        return Err(nothing(&rows, path, z_mm));
    };
    let pace = pace::pace(setpoints, &rows, &best, path, cut)?;
    let time = |row: usize| (setpoints.start_ns + setpoints.period_ns * row as i64) as f64 / 1e9;
    let facts = Facts {
        from_s: time(best.first),
        to_s: time(best.first + best.nominal.len() - 1),
        rows: best.nominal.len(),
        passes,
        farthest_mm: best.farthest_mm,
        off_rms_mm: best.off_rms_mm,
        least_feed: pace.least,
        greatest_feed: pace.greatest,
    };
    let centre = rows[best.first..best.first + best.nominal.len()].iter().map(|r| [r[0], r[1]]).collect();
    Ok(CutPath { centre, feed_mm_per_min: pace.first_mm_per_min, feed_changes: pace.changes, facts })
}

/// Machine coordinates, nm, in those of the program, mm.
fn program_mm(nm: [i64; 3], placement: &Placement) -> [f64; 3] {
    let [x, y, z] = std::array::from_fn(|k| (nm[k] - placement.origin_nm[k]) as f64 / 1e6);
    let (c, s) = (f64::from(placement.cosine), f64::from(placement.sine));
    let one = f64::from(TURN_ONE);
    [(c * x + s * y) / one, (c * y - s * x) / one, z]
}

fn nothing(rows: &[[f64; 3]], path: &Path, z_mm: f64) -> InputError {
    let start = path.centre[0];
    let nearest = rows.iter().map(|r| (r[0] - start[0]).hypot(r[1] - start[1])).fold(f64::INFINITY, f64::min);
    let (low, high) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r[2]), h.max(r[2])));
    S006.error(format!(
            "no rows follow the contour at its depth: they come within {nearest:.3} mm of its start, with Z {low:.3} to {high:.3} mm"
        ), format!("rows from the start of the contour ({:.3}, {:.3}) to its end at Z {z_mm:.3} mm", start[0], start[1]))
}
