//! Round trips as four numbers.

use serde::Serialize;

/// Minimum, median, 99th percentile and maximum of measured times, µs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoundTrip {
    /// Times measured.
    pub count: usize,
    /// Shortest.
    pub min_us: f64,
    /// Half are shorter.
    pub median_us: f64,
    /// One in a hundred is longer.
    pub p99_us: f64,
    /// Longest.
    pub max_us: f64,
}

impl RoundTrip {
    /// Of times in ns; `None` without any.
    pub fn of(mut times_ns: Vec<u64>) -> Option<Self> {
        times_ns.sort_unstable();
        let last = times_ns.len().checked_sub(1)?;
        // Nearest rank.
        let at = |share: f64| times_ns[((last as f64 * share).ceil() as usize).min(last)] as f64 / 1000.0;
        Some(Self { count: last + 1, min_us: at(0.0), median_us: at(0.5), p99_us: at(0.99), max_us: at(1.0) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_numbers_are_those_of_the_sorted_times() {
        let times = (1..=101).rev().map(|k| k * 1000).collect();
        let trip = RoundTrip::of(times).expect("times");
        assert_eq!((trip.count, trip.min_us, trip.median_us, trip.p99_us, trip.max_us), (101, 1.0, 51.0, 100.0, 101.0));
        assert_eq!(RoundTrip::of(vec![]), None);
    }
}
