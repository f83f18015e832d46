//! What of a run goes along the contour.
//!
//! A run is a stretch of cutting moves at any distance beside the wall, in either direction. Its places are taken at the step of
//! the path; each belongs to the nearest sample of the nominal path whose heading is within 60° of that of the run, or
//! of its opposite. What lies farther off than the stock and 3 mm, or crosses the contour, is a lead: it cuts nothing. A lap ends
//! where the run leaves the contour or turns back.

use crate::error::{PlantError, require};
use crate::path::{FACET_RAD, Path};
use crate::vector::{Point, distance, dot, mix, squared_distance, sub, turn, unit};

/// A run farther from the nominal path than the stock by this is not along it, mm.
const BESIDE_MM: f64 = 3.0;
/// Cosine of the largest angle between a run and the contour.
const ALONG: f64 = 0.5;
/// The place is looked for this far from the last one, mm.
const WINDOW_MM: f64 = 8.0;
/// A lap is longer than this, mm.
const SHORTEST_MM: f64 = 0.5;

/// A stretch of cutting moves. Index the three vectors together.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Centre of the cutter, mm: the corners of a polyline, leads included.
    pub centre: Vec<Point>,
    /// Z of the cutter's tip there, mm.
    pub tip_z_mm: Vec<f64>,
    /// Feed on the way to there, mm/min.
    pub feed_mm_per_min: Vec<f64>,
    /// Spindle speed, rev/min.
    pub spindle_rpm: f64,
}

impl Run {
    /// A run at one height, feed and speed.
    pub fn even(centre: Vec<Point>, tip_z_mm: f64, feed_mm_per_min: f64, spindle_rpm: f64) -> Self {
        let count = centre.len();
        Self { centre, tip_z_mm: vec![tip_z_mm; count], feed_mm_per_min: vec![feed_mm_per_min; count], spindle_rpm }
    }

    pub(super) fn check(&self) -> Result<(), PlantError> {
        let count = self.centre.len();
        let alike = self.tip_z_mm.len() == count && self.feed_mm_per_min.len() == count;
        require(alike, "centre", count as f64, "as many heights and feeds as places")?;
        for &feed in &self.feed_mm_per_min {
            require(feed > 0.0 && feed <= 1e6, "feed_mm_per_min", feed, "more than 0, up to 1e6 mm/min")?;
        }
        let n = self.spindle_rpm;
        require(n > 0.0 && n <= 1e6, "spindle_rpm", n, "more than 0, up to 1e6 rev/min")
    }
}

/// A place of a lap.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) commanded: Point,
    /// Sample of the nominal path that it is beside.
    pub(super) nominal: usize,
    pub(super) tip_z_mm: f64,
    pub(super) feed_mm_per_min: f64,
    /// Way from the step before, mm.
    pub(super) way_mm: f64,
}

/// A stretch along the contour in one direction.
#[derive(Debug, Clone)]
pub(super) struct Lap {
    pub(super) steps: Vec<Step>,
    /// Against the sense of the nominal path.
    pub(super) reversed: bool,
}

/// A place of a run with its heading.
struct Dense {
    centre: Point,
    heading: Point,
    tip_z_mm: f64,
    feed_mm_per_min: f64,
}

/// The laps of a run; `stock_mm` is the most that is left on the wall.
pub(super) fn laps(path: &Path, run: &Run, stock_mm: f64) -> Vec<Lap> {
    let reach = stock_mm.max(0.0) + BESIDE_MM;
    let mut laps = Vec::new();
    let mut lap = Lap { steps: Vec::new(), reversed: false };
    let mut last: Option<Point> = None;
    for place in dense(run, path.step_mm) {
        let before = lap.steps.last().map(|step: &Step| step.nominal);
        let found = nearest(path, &place, before, reach);
        let Some(nominal) = found else {
            finish(&mut lap, &mut laps);
            last = None;
            continue;
        };
        let reversed = dot(place.heading, path.tangent[nominal]) < 0.0;
        if reversed != lap.reversed {
            finish(&mut lap, &mut laps);
            lap.reversed = reversed;
        }
        let way_mm = last.map_or(0.0, |last| distance(last, place.centre));
        last = Some(place.centre);
        lap.steps.push(Step {
            commanded: place.centre,
            nominal,
            tip_z_mm: place.tip_z_mm,
            feed_mm_per_min: place.feed_mm_per_min,
            way_mm,
        });
    }
    finish(&mut lap, &mut laps);
    laps
}

/// How many laps of a run go along the contour, with at most `stock_mm` on the wall.
pub fn laps_along(path: &Path, run: &Run, stock_mm: f64) -> usize {
    laps(path, run, stock_mm).len()
}

fn finish(lap: &mut Lap, laps: &mut Vec<Lap>) {
    let steps = std::mem::take(&mut lap.steps);
    if steps.iter().map(|s| s.way_mm).sum::<f64>() > SHORTEST_MM {
        laps.push(Lap { steps, reversed: lap.reversed });
    }
}

/// Places of a run at most `step` apart; a corner is one, in either heading.
fn dense(run: &Run, step: f64) -> Vec<Dense> {
    let mut out = Vec::new();
    let mut due = 0.0;
    let mut before: Option<Point> = None;
    let last = run.centre.len().saturating_sub(2);
    for k in 0..run.centre.len().saturating_sub(1) {
        let (a, b) = (run.centre[k], run.centre[k + 1]);
        let length = distance(a, b);
        if length < 1e-9 {
            continue;
        }
        let heading = unit(sub(b, a));
        let at = |x: f64| Dense {
            centre: mix(a, b, x / length),
            heading,
            tip_z_mm: run.tip_z_mm[k] + (run.tip_z_mm[k + 1] - run.tip_z_mm[k]) * x / length,
            feed_mm_per_min: run.feed_mm_per_min[k + 1],
        };
        if let Some(before) = before.filter(|before| turn(*before, heading).abs() >= FACET_RAD) {
            out.push(Dense { heading: before, ..at(0.0) });
            due = 0.0;
        }
        while due <= length {
            out.push(at(due));
            due += step;
        }
        due -= length;
        if k == last && step - due > 1e-9 {
            out.push(at(length));
        }
        before = Some(heading);
    }
    out
}

/// The sample that a place is beside, near the last one if there is one.
fn nearest(path: &Path, place: &Dense, before: Option<usize>, reach: f64) -> Option<usize> {
    let along = |k: &usize| dot(place.heading, path.tangent[*k]).abs() >= ALONG;
    let off = |k: &usize| squared_distance(path.centre[*k], place.centre);
    let within = |k: &usize| off(k) <= reach * reach;
    let best = |range: &mut dyn Iterator<Item = usize>| {
        range.filter(along).min_by(|a, b| off(a).total_cmp(&off(b))).filter(within)
    };
    let count = path.len();
    if let Some(at) = before {
        let window = ((WINDOW_MM / path.step_mm).ceil() as usize).min(count / 2);
        let round = |k: usize| (at + count + k - window) % count;
        let found = if path.closed {
            best(&mut (0..=2 * window).map(round))
        } else {
            best(&mut (at.saturating_sub(window)..=(at + window).min(count - 1)))
        };
        if found.is_some() {
            return found;
        }
    }
    best(&mut (0..count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Side;
    use crate::segment::Segment;

    fn line() -> Path {
        let line = Segment::Line { from: [0.0, 0.0], to: [50.0, 0.0] };
        Path::new(&[line], Side::Right, 0.1).expect("a path")
    }

    #[test]
    fn leads_are_left_out_and_a_run_to_the_side_is_of_the_same_wall() {
        let run = Run::even(vec![[0.0, 9.0], [0.0, 0.6], [50.0, 0.6], [50.0, 9.0]], -5.0, 400.0, 1500.0);
        let found = laps(&line(), &run, 1.0);
        assert_eq!(found.len(), 1);
        let steps = &found[0].steps;
        assert!(!found[0].reversed);
        assert!(steps.iter().all(|s| (s.commanded[1] - 0.6).abs() < 1e-9 && s.way_mm < 0.11));
        let (first, last) = (steps[0].nominal, steps[steps.len() - 1].nominal);
        assert_eq!((first, last), (0, line().len() - 1));
    }

    #[test]
    fn a_run_there_and_back_is_two_laps() {
        let run = Run::even(vec![[0.0, 0.0], [50.0, 0.0], [0.0, 0.0]], -5.0, 400.0, 1500.0);
        let found: Vec<bool> = laps(&line(), &run, 1.0).iter().map(|lap| lap.reversed).collect();
        assert_eq!(found, [false, true]);
    }

    #[test]
    fn a_run_elsewhere_is_no_lap() {
        let run = Run::even(vec![[0.0, 7.0], [50.0, 7.0]], -5.0, 400.0, 1500.0);
        assert!(laps(&line(), &run, 1.0).is_empty());
    }
}
