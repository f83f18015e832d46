//! The samples of the last seconds, in the order of their time.

use std::collections::VecDeque;
use std::time::Duration;

use truepath_core::link::TraceSample;

/// What is kept: so long, and no more than so many (2,500 samples/s are the most a device takes at 20 kHz).
pub const SPAN: Duration = Duration::from_secs(20);
const MOST: usize = 60_000;

/// A sample with the time it was taken at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Since the start of the view, s.
    pub t_s: f64,
    /// Corrections of the machine axes of X and Y, nm.
    pub nm: [i32; 2],
}

/// Samples of the last [`SPAN`].
#[derive(Clone, Debug, Default)]
pub struct History {
    points: VecDeque<Point>,
}

impl History {
    /// Takes what was fetched at `at`, with the time of the fetch before. The device takes samples at a steady rate: those
    /// that arrived and those that were dropped before them share the time between the fetches.
    pub fn take(&mut self, before: Duration, at: Duration, dropped: u32, samples: &[TraceSample]) {
        let count = samples.len() as f64 + f64::from(dropped);
        let step = at.saturating_sub(before).as_secs_f64() / count.max(1.0);
        for (back, sample) in (0..samples.len()).rev().zip(samples) {
            let t_s = at.as_secs_f64() - back as f64 * step;
            self.points.push_back(Point { t_s, nm: sample.correction_nm });
        }
        let oldest = at.saturating_sub(SPAN).as_secs_f64();
        while self.points.len() > MOST || self.points.front().is_some_and(|p| p.t_s < oldest) {
            self.points.pop_front();
        }
    }
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.points.clear();
    }
    /// The samples, oldest first.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.points.iter().copied()
    }
    /// The largest correction of an axis, nm.
    pub fn largest(&self) -> u32 {
        self.points.iter().flat_map(|p| p.nm).map(i32::unsigned_abs).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(count: usize) -> Vec<TraceSample> {
        (0..count).map(|k| TraceSample { correction_nm: [k as i32, 0], ..TraceSample::default() }).collect()
    }

    #[test]
    fn samples_share_the_time_between_two_fetches_with_those_that_were_dropped() {
        let mut history = History::default();
        let [one, two] = [1, 2].map(Duration::from_secs);
        history.take(one, two, 6, &samples(4));
        let times: Vec<f64> = history.points().map(|p| p.t_s).collect();
        assert!(times.iter().zip([1.7, 1.8, 1.9, 2.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{times:?}");
        assert_eq!(history.largest(), 3);
    }

    #[test]
    fn what_is_older_than_the_span_is_forgotten_and_the_number_is_bounded() {
        let mut history = History::default();
        history.take(Duration::ZERO, Duration::from_secs(1), 0, &samples(10));
        history.take(Duration::from_secs(1), Duration::from_secs(20), 0, &samples(1));
        assert_eq!(history.points().count(), 11);
        history.take(Duration::from_secs(21), Duration::from_secs(22), 0, &samples(1));
        assert_eq!(history.points().count(), 2);
        history.take(Duration::from_secs(22), Duration::from_secs(23), 0, &samples(MOST + 5));
        assert_eq!(history.points().count(), MOST);
    }
}
