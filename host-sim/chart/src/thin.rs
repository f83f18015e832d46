//! Long series made short without changing their picture.
//!
//! A series is cut into columns no wider than what an eye resolves, and of each column the first, the smallest, the largest
//! and the last value stay, in their order: every peak is drawn at its place and with its height, whatever the number of
//! rows (the M4 aggregation of Jugel et al., 2014). A gap stays a gap. A column keeps at most nine places, so the size of a
//! picture has a bound.

/// Places to be drawn, as indices in their order, of those with `s` within `from..=to`. `s` never falls; a value that is
/// not a number is a gap, and one of each gap is kept.
pub fn kept(s: &[f64], values: &[f64], (from, to): (f64, f64), columns: usize) -> Vec<usize> {
    let mut out = Vec::new();
    let mut column = Column::default();
    let mut number = 0;
    let wide = (to - from).max(f64::MIN_POSITIVE) / columns.max(1) as f64;
    for (at, (place, value)) in s.iter().zip(values).enumerate() {
        if !(*place >= from && *place <= to) {
            continue;
        }
        let here = ((place - from) / wide) as usize;
        if here != number {
            column.empty_into(&mut out, values);
            number = here;
        }
        column.add(at, *value);
    }
    column.empty_into(&mut out, values);
    out
}

/// The values of one column: a run, and when a gap lies in it, what follows it.
#[derive(Default)]
struct Column {
    run: Option<Run>,
    gap: Option<usize>,
    rest: Option<Run>,
}

/// Indices and values of the first, smallest, largest and last of a run.
#[derive(Clone, Copy)]
struct Run {
    first: usize,
    low: (usize, f64),
    high: (usize, f64),
    last: usize,
}

impl Column {
    fn add(&mut self, at: usize, value: f64) {
        if !value.is_finite() {
            self.gap.get_or_insert(at);
            return;
        }
        let run = if self.gap.is_none() { &mut self.run } else { &mut self.rest };
        let run = run.get_or_insert(Run { first: at, low: (at, value), high: (at, value), last: at });
        if value < run.low.1 {
            run.low = (at, value);
        }
        if value > run.high.1 {
            run.high = (at, value);
        }
        run.last = at;
    }

    fn empty_into(&mut self, out: &mut Vec<usize>, values: &[f64]) {
        let mut runs = [self.run.take(), self.rest.take()].map(|run| {
            let mut places = run.map_or_else(Vec::new, |r| vec![r.first, r.low.0, r.high.0, r.last]);
            places.sort_unstable();
            places.dedup();
            places
        });
        out.append(&mut runs[0]);
        if let Some(gap) = self.gap.take() {
            // One mark a gap, however many columns it spans.
            if out.last().is_none_or(|last| values.get(*last).is_some_and(|v| v.is_finite())) {
                out.push(gap);
            }
        }
        out.append(&mut runs[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_ends_and_gaps_stay_and_the_number_of_places_has_a_bound() {
        let count = 200_000;
        let s: Vec<f64> = (0..count).map(|i| f64::from(i) * 0.01).collect();
        let mut values: Vec<f64> = (0..count).map(|i| (f64::from(i) * 0.37).sin() * 0.1).collect();
        (values[12_345], values[77_777]) = (9.0, -7.0);
        values[100_000..100_050].fill(f64::NAN);
        let places = kept(&s, &values, (0.0, 2000.0), 800);
        assert!(places.len() <= 9 * 801, "{}", places.len());
        assert!(places.is_sorted());
        for at in [0, 12_345, 77_777, 199_999] {
            assert!(places.contains(&at), "{at} is lost");
        }
        assert_eq!(places.iter().filter(|at| values[**at].is_nan()).count(), 1);
    }

    #[test]
    fn a_short_series_stays_as_it_is_and_a_window_cuts_it() {
        let s = [0.0, 1.0, 1.0, 2.0, 3.0];
        let values = [1.0, f64::NAN, f64::NAN, 2.0, 5.0];
        assert_eq!(kept(&s, &values, (0.0, 3.0), 100), [0, 1, 3, 4]);
        assert_eq!(kept(&s, &values, (0.5, 2.0), 100), [1, 3]);
    }
}
