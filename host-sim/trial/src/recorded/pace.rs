//! The feed along a recorded pass, as the teeth see it.
//!
//! A tooth takes the way of the cutter since the tooth before it, so the feed per tooth at a row is the way over one tooth
//! period about that row. The plant wants a feed in mm/min at one spindle speed: the feed per tooth times that speed. It
//! is kept in steps of a quarter of a percent, because the plant prepares a force table for each. Where the cutter stands
//! the chip would vanish; the least feed is 1 % of the program's.

use truepath_core::units::Real;
use truepath_ground::diagnostics::InputError;
use truepath_ground::units::float;
use truepath_plant as plant;
use truepath_plant::{FeedChange, Path};

use super::follow::Followed;
use crate::codes::S007;
use crate::setpoints::Setpoints;

/// Steps of the feed, as a share of the program's.
const STEP: f64 = 0.0025;
/// The least feed, likewise.
const LEAST: f64 = 0.01;
/// The greatest feed, likewise: a rapid along the contour.
const MOST: f64 = 20.0;

/// Feeds along the contour.
pub(super) struct Pace {
    pub first_mm_per_min: f64,
    pub changes: Vec<FeedChange>,
    pub least: f64,
    pub greatest: f64,
}

/// The feeds of a pass.
pub(super) fn pace(
    setpoints: &Setpoints,
    rows: &[[f64; 3]],
    pass: &Followed,
    path: &Path,
    cut: &plant::Cut,
) -> Result<Pace, InputError> {
    let period_s = setpoints.period_ns as f64 / 1e9;
    let mut way_mm = Vec::with_capacity(pass.nominal.len());
    let own = &rows[pass.first..pass.first + pass.nominal.len()];
    let mut sum = 0.0;
    way_mm.push(0.0);
    for pair in own.windows(2) {
        sum += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        way_mm.push(sum);
    }
    // The slowest row beside each nominal sample: a stop at a place is over before the next one.
    let mut slowest = vec![f64::INFINITY; path.len()];
    for (k, &nominal) in pass.nominal.iter().enumerate() {
        let rpm = setpoints.rows[pass.first + k].spindle_rpm.map_or(cut.spindle_rpm, |rpm: Real| float(rpm).abs());
        if rpm < 1.0 {
            let time = (setpoints.start_ns as f64 + setpoints.period_ns as f64 * (pass.first + k) as f64) / 1e9;
            let found = format!("the spindle stands still in the pass, at {time:.3} s");
            return Err(S007.error(found, "a pass that cuts"));
        }
        let half = (30.0 / (rpm * cut.teeth as f64) / period_s).max(0.5);
        let (from, to) = (k as f64 - half, k as f64 + half);
        let (from, to) = (from.max(0.0), to.min((own.len() - 1) as f64));
        let speed = (at(&way_mm, to) - at(&way_mm, from)) / ((to - from).max(1e-9) * period_s);
        let share = speed * 60.0 * (cut.spindle_rpm / rpm) / cut.feed_at(path.s_mm[nominal]);
        slowest[nominal] = slowest[nominal].min(share);
    }
    Ok(steps(&slowest, path, cut))
}

/// Linear between the rows.
fn at(way: &[f64], place: f64) -> f64 {
    let last = way.len() - 1;
    let low = (place as usize).min(last);
    let high = (low + 1).min(last);
    way[low] + (way[high] - way[low]) * (place - low as f64)
}

/// Shares of the program's feed as changes along the path. A sample without rows has the feed of the one before.
fn steps(shares: &[f64], path: &Path, cut: &plant::Cut) -> Pace {
    let mut pace = Pace { first_mm_per_min: cut.feed_mm_per_min, changes: Vec::new(), least: 1.0, greatest: 1.0 };
    let mut share = shares.iter().copied().find(|s| s.is_finite()).unwrap_or(1.0);
    // At the ends the cutter starts, plunges and lifts.
    let trim = plant::judged_trim_mm(cut.radius_mm);
    let judged = |s: f64| s > trim && s < path.length_mm - trim;
    (pace.least, pace.greatest) = (f64::INFINITY, 0.0);
    let mut feed = f64::NAN;
    for (k, &here) in shares.iter().enumerate() {
        if here.is_finite() {
            share = here;
        }
        if judged(path.s_mm[k]) {
            pace.least = pace.least.min(share);
            pace.greatest = pace.greatest.max(share);
        }
        let next = cut.feed_at(path.s_mm[k]) * ((share / STEP).round() * STEP).clamp(LEAST, MOST);
        if k == 0 {
            pace.first_mm_per_min = next;
        } else if next != feed {
            pace.changes.push(FeedChange { from_s_mm: path.s_mm[k], feed_mm_per_min: next });
        }
        feed = next;
    }
    pace.least = pace.least.min(pace.greatest);
    pace
}
