//! Maximum, minimum, mean and standard deviation of numbers that pass by once (Welford 1962).

use serde::Serialize;

/// The numbers so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spread {
    count: u64,
    mean: f64,
    /// Sum of the squared distances from the mean.
    squares: f64,
    least: f64,
    greatest: f64,
}

/// What is said of them, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SpreadSummary {
    /// How many.
    pub moves: u64,
    /// The largest.
    pub maximum_mm: f64,
    /// The smallest.
    pub minimum_mm: f64,
    /// The mean.
    pub mean_mm: f64,
    /// The standard deviation, of the numbers themselves (divided by their count).
    pub standard_deviation_mm: f64,
}

impl Spread {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let off = value - self.mean;
        self.mean += off / self.count as f64;
        self.squares += off * (value - self.mean);
        self.least = if self.count == 1 { value } else { self.least.min(value) };
        self.greatest = if self.count == 1 { value } else { self.greatest.max(value) };
    }

    /// What they are; all 0 when there are none.
    pub fn summary(&self) -> SpreadSummary {
        SpreadSummary {
            moves: self.count,
            maximum_mm: self.greatest,
            minimum_mm: self.least,
            mean_mm: self.mean,
            standard_deviation_mm: if self.count == 0 { 0.0 } else { (self.squares / self.count as f64).sqrt() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_that_of_the_definition() {
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let mut spread = Spread::default();
        values.iter().for_each(|v| spread.add(*v));
        let mean = values.iter().sum::<f64>() / 8.0;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / 8.0;
        let summary = spread.summary();
        assert_eq!((summary.maximum_mm, summary.minimum_mm, summary.moves), (9.0, 1.0, 8));
        assert!((summary.mean_mm - mean).abs() < 1e-12);
        assert!((summary.standard_deviation_mm - variance.sqrt()).abs() < 1e-12);
    }
}
