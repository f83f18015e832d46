//! An axis: its range, round ticks in it, and how their numbers are written.

/// Range and ticks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Round values in the range.
    pub ticks: Vec<f64>,
    decimals: usize,
}

impl Scale {
    /// A scale from `low` to `high` with at most `most` ticks at steps of 1, 2 or 5 times a power of ten. A range of no
    /// width is widened so that it can be drawn.
    pub fn new(low: f64, high: f64, most: usize) -> Self {
        let least = (low.abs().max(high.abs()) * 1e-9).max(1e-9);
        let (low, high) = if high - low > least { (low, high) } else { (low - least, high + least) };
        let step = step(high - low, most);
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let first = (low / step).ceil();
        let ticks = (0..=most).map(|k| (first + k as f64) * step).filter(|t| *t <= high + 1e-9 * step).collect();
        Self { low, high, ticks, decimals }
    }

    /// Its share of a value: 0 at the low end, 1 at the high one.
    pub fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// A tick as text, all of an axis with the same decimals.
    pub fn label(&self, value: f64) -> String {
        number(value, self.decimals)
    }
}

/// The smallest of 1, 2, 5, 10, … that goes into `span` no more than `most` − 1 times.
fn step(span: f64, most: usize) -> f64 {
    let least = span / (most.max(2) - 1) as f64;
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * decade).find(|s| *s >= least).unwrap_or(10.0 * decade)
}

/// The largest of 1, 2, 5, 10, … that is not above a positive number.
pub fn round_below(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * decade).find(|s| *s <= value * (1.0 + 1e-9)).unwrap_or(decade)
}

/// A number with a minus that is as wide as a plus, and zero without a sign.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    if value < 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) { format!("−{text}") } else { text }
}

/// As many decimals as the number has, up to six.
pub fn plain(value: f64) -> String {
    let text = number(value, 6);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_in_the_range_and_written_alike() {
        let scale = Scale::new(-0.13, 0.31, 6);
        assert_eq!(
            scale.ticks.iter().map(|t| scale.label(*t)).collect::<Vec<_>>(),
            ["−0.1", "0.0", "0.1", "0.2", "0.3"]
        );
        let scale = Scale::new(0.0, 72.4, 9);
        assert_eq!(scale.ticks, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0]);
        assert_eq!(scale.label(-0.0), "0");
        assert!((scale.share(36.2) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn any_range_gives_a_bounded_number_of_finite_ticks() {
        for (low, high) in [(0.0, 0.0), (1e9, 1e9), (-1e9, 1e9), (1e9 - 1e-6, 1e9), (5.0, 5.0 + 1e-12), (-1e-9, 0.0)] {
            let scale = Scale::new(low, high, 6);
            assert!(scale.high > scale.low && scale.ticks.len() <= 7, "{scale:?}");
            assert!(scale.ticks.iter().all(|t| t.is_finite() && !scale.label(*t).is_empty()), "{scale:?}");
        }
    }

    #[test]
    fn numbers_are_rounded_down_to_one_two_or_five() {
        for (value, round) in [(99.0, 50.0), (100.0, 100.0), (0.3, 0.2), (1.0, 1.0), (4.99, 2.0)] {
            assert!((round_below(value) - round).abs() < 1e-9 * round, "{value}: {}", round_below(value));
        }
        assert_eq!((plain(0.5), plain(100.0), plain(-0.25)), ("0.5".to_owned(), "100".to_owned(), "−0.25".to_owned()));
    }
}
