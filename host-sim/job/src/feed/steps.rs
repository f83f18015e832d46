//! From the feed allowed beside every sample to a few steps.
//!
//! The contour is divided into even cells of at least a millimetre, which is what F words need from each other. A
//! cell has the smallest feed allowed in it and half a millimetre to both sides, so the feed falls before the load rises.
//! Towards lower cells the feed falls and from them it rises by no more than a step at a time: a ramp of some
//! millimetres in place of one blow. Steps are of a geometric grid below the programmed feed, and a rise that lasts
//! only a millimetre is left out.

use truepath_core::units::Offset;

/// From a place on, another feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// Arc length of the contour.
    pub from: Offset,
    /// Percent of the programmed feed from there on.
    pub percent: u16,
}

/// Least length of a cell, nm.
const CELL_NM: i64 = 1_000_000;
/// How far beyond its ends a cell looks, nm.
const LOOK_NM: i64 = 500_000;
/// Feed of a cell over that of its lower neighbour at most.
const RISE: f64 = 1.15;
/// Ratio of neighbouring steps of the grid.
const GRID: f64 = 0.95;
/// A rise between lower neighbours lasts at least this many cells.
const LASTING: usize = 2;

/// Changes for the allowed percentages, given in ascending order of arc length, within a range. Without any place there
/// is no change.
pub(super) fn steps(allowed: &[(Offset, u16)], [lowest, highest]: [u16; 2], closed: bool) -> Vec<Change> {
    let (Some(first), Some(last)) = (allowed.first(), allowed.last()) else { return Vec::new() };
    let length = (last.0 - first.0).nm();
    let count = (length / CELL_NM).max(1);
    let start = |cell: i64| first.0.nm() + length * cell / count;
    let smallest = |cell: i64| {
        let (from, to) = (start(cell) - LOOK_NM, start(cell + 1) + LOOK_NM);
        let begin = allowed.partition_point(|a| a.0.nm() < from);
        let inside = allowed[begin..].iter().take_while(|a| a.0.nm() <= to);
        f64::from(inside.map(|a| a.1).min().unwrap_or(lowest))
    };
    let mut cells: Vec<f64> = (0..count).map(smallest).collect();
    ramp(&mut cells, closed);
    let mut levels: Vec<u16> = cells.iter().map(|&percent| level(percent, lowest, highest)).collect();
    settle(&mut levels);
    let mut changes: Vec<Change> = Vec::new();
    for (cell, &percent) in (0i64..).zip(&levels) {
        if changes.last().is_none_or(|change| change.percent != percent) {
            // At a sample, where the path has a point of its own.
            let at = allowed.partition_point(|a| a.0.nm() < start(cell));
            let from = allowed.get(at).map_or(first.0, |a| a.0);
            changes.push(Change { from, percent });
        }
    }
    changes
}

/// Limits the rise from every cell to its neighbours, across the seam of a closed contour too.
fn ramp(cells: &mut [f64], closed: bool) {
    let count = cells.len();
    let rounds = if closed { 2 * count } else { count };
    for k in 1..rounds {
        let (before, at) = ((k - 1) % count, k % count);
        cells[at] = cells[at].min(cells[before] * RISE);
    }
    for k in (1..rounds).rev() {
        let (before, at) = ((k - 1) % count, k % count);
        cells[before] = cells[before].min(cells[at] * RISE);
    }
}

/// The step of the grid at or below a percentage.
fn level(percent: f64, lowest: u16, highest: u16) -> u16 {
    // The grid goes through 100 % and through the highest feed.
    let anchor = if percent >= 100.0 { f64::from(highest) } else { 100.0 };
    let mut step = anchor;
    while step > percent + 1e-9 {
        step *= GRID;
    }
    (step.floor() as u16).clamp(lowest, highest)
}

/// Leaves out rises between lower neighbours that do not last.
fn settle(levels: &mut [u16]) {
    let mut at = 0;
    while at < levels.len() {
        let run = levels[at..].iter().take_while(|&&level| level == levels[at]).count();
        let sides = (at.checked_sub(1).map(|k| levels[k]), levels.get(at + run).copied());
        if let (Some(before), Some(behind)) = sides
            && run < LASTING
            && before < levels[at]
            && behind < levels[at]
        {
            levels[at..at + run].fill(before.max(behind));
        }
        at += run;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Allowed percentages every 0.1 mm.
    fn allowed(percent: impl Fn(f64) -> u16) -> Vec<(Offset, u16)> {
        (0..=600).map(|k| (Offset::from_um(100 * k), percent(f64::from(k as i32) / 10.0))).collect()
    }

    fn at(changes: &[Change], s_mm: f64) -> u16 {
        let behind = changes.partition_point(|c| c.from.nm() as f64 / 1e6 <= s_mm);
        changes[behind - 1].percent
    }

    #[test]
    fn the_feed_falls_before_the_load_rises_and_by_small_steps() {
        let wish = |s: f64| if (30.0..40.0).contains(&s) { 50 } else { 100 };
        let changes = steps(&allowed(wish), [40, 100], false);
        for k in 0..=600 {
            let s = f64::from(k) / 10.0;
            assert!(at(&changes, s) <= wish(s), "{s}: {changes:?}");
        }
        assert!(at(&changes, 29.0) <= 50 && at(&changes, 41.0) > 50 && at(&changes, 20.0) == 100);
        for pair in changes.windows(2) {
            assert!((pair[1].from - pair[0].from).nm() >= 900_000);
            let ratio =
                f64::from(pair[0].percent.max(pair[1].percent)) / f64::from(pair[0].percent.min(pair[1].percent));
            assert!(ratio < RISE / GRID + 0.05, "{changes:?}");
        }
    }

    #[test]
    fn what_every_feed_allows_is_one_step_and_the_range_is_kept() {
        assert_eq!(steps(&allowed(|_| 100), [50, 100], false), [Change { from: Offset::ZERO, percent: 100 }]);
        let range = steps(&allowed(|s| if s < 30.0 { 120 } else { 60 }), [60, 120], false);
        assert!(range.iter().all(|c| (60..=120).contains(&c.percent)));
        assert_eq!((range[0].percent, range.last().map(|c| c.percent)), (120, Some(60)));
    }

    #[test]
    fn a_closed_contour_has_no_blow_at_its_seam() {
        let changes = steps(&allowed(|s| if s < 5.0 { 50 } else { 100 }), [50, 100], true);
        let (first, last) = (changes[0].percent, changes.last().map_or(0, |c| c.percent));
        assert!(f64::from(last) <= f64::from(first) * RISE / GRID, "{changes:?}");
    }

    #[test]
    fn a_rise_of_a_millimetre_is_left_out() {
        let changes =
            steps(&allowed(|s| if (20.5..23.0).contains(&s) || s < 10.0 { 100 } else { 90 }), [50, 100], false);
        let behind: Vec<_> = changes.iter().filter(|c| c.from > Offset::from_um(11_000)).collect();
        assert!(behind.is_empty(), "{changes:?}");
    }
}
