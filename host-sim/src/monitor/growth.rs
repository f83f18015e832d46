//! Counters with what they grow by, so that one that begins to grow stands out.

use std::collections::VecDeque;
use std::time::Duration;

/// Rates are means over so long.
const WINDOW: Duration = Duration::from_secs(2);
/// A counter that grew within so long is marked.
const RECENT: Duration = Duration::from_secs(10);
/// Looks that are kept: of more than 50 a second the older ones go.
const MOST: usize = 100;

/// A counter now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// The count.
    pub value: u64,
    /// Growth per second.
    pub per_s: f64,
    /// Whether it grew of late.
    pub grew: bool,
}

/// N counters over time.
#[derive(Clone, Debug)]
pub struct Growth<const N: usize> {
    looks: VecDeque<(Duration, [u64; N])>,
    grew_at: [Option<Duration>; N],
}

impl<const N: usize> Default for Growth<N> {
    fn default() -> Self {
        Self { looks: VecDeque::new(), grew_at: [None; N] }
    }
}

impl<const N: usize> Growth<N> {
    /// Takes the counters of a moment. When one has become smaller, the device was reset or its counters were cleared:
    /// the past is forgotten.
    pub fn take(&mut self, at: Duration, counts: [u64; N]) {
        if let Some((_, last)) = self.looks.back() {
            if counts.iter().zip(last).any(|(now, then)| now < then) {
                *self = Self::default();
            } else {
                for ((now, then), grew) in counts.iter().zip(last).zip(&mut self.grew_at) {
                    if now > then {
                        *grew = Some(at);
                    }
                }
            }
        }
        self.looks.push_back((at, counts));
        // The newest look that is older than the window stays: rates are counted from it.
        let old = |looks: &VecDeque<(Duration, [u64; N])>| looks.get(1).is_some_and(|(t, _)| *t + WINDOW <= at);
        while self.looks.len() > MOST || old(&self.looks) {
            self.looks.pop_front();
        }
    }
    /// Forgets what grew.
    pub fn clear(&mut self) {
        self.grew_at = [None; N];
    }
    /// The counters now.
    pub fn counts(&self, now: Duration) -> [Count; N] {
        let (Some((from, first)), Some((to, last))) = (self.looks.front(), self.looks.back()) else {
            return [Count::default(); N];
        };
        let seconds = to.saturating_sub(*from).as_secs_f64();
        std::array::from_fn(|k| Count {
            value: last[k],
            per_s: if seconds > 0.0 { (last[k] - first[k]) as f64 / seconds } else { 0.0 },
            grew: self.grew_at[k].is_some_and(|at| now.saturating_sub(at) < RECENT),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_the_mean_of_the_last_two_seconds_and_growth_is_marked_for_ten() {
        let mut growth = Growth::<2>::default();
        let at = |tenths: u64| Duration::from_millis(100 * tenths);
        for k in 0..=50 {
            growth.take(at(k), [k * 100, u64::from(k > 48)]);
        }
        let [fast, slow] = growth.counts(at(50));
        assert!((fast.per_s - 1000.0).abs() < 1e-6 && fast.grew, "{fast:?}");
        assert!((slow.per_s - 0.5).abs() < 1e-6 && slow.grew && slow.value == 1, "{slow:?}");
        assert!(growth.counts(at(148))[1].grew && !growth.counts(at(150))[1].grew);
        growth.clear();
        assert!(!growth.counts(at(50))[1].grew);
    }

    #[test]
    fn counters_that_were_set_to_zero_have_no_rate_and_did_not_grow() {
        let mut growth = Growth::<1>::default();
        growth.take(Duration::ZERO, [4_000_000_000]);
        growth.take(Duration::from_secs(1), [10]);
        assert_eq!(growth.counts(Duration::from_secs(1)), [Count { value: 10, per_s: 0.0, grew: false }]);
    }
}
