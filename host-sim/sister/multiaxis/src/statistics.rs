//! Maximum, minimum and standard deviation of a stream of deviations, as the paper's Table 1 gives them.
//!
//! One pass and constant memory: mean and sum of squares after Welford (Technometrics 4, 1962), which keeps its digits
//! where the naive difference of sums loses them. The standard deviation is that of a sample (divisor n − 1).

use serde::Serialize;

/// Statistics of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviations {
    count: u64,
    mean: f64,
    squares: f64,
    minimum: f64,
    maximum: f64,
}

/// The figures of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Number of deviations.
    pub count: u64,
    /// The largest, mm; 0 for none.
    pub maximum_mm: f64,
    /// The smallest, mm; 0 for none.
    pub minimum_mm: f64,
    /// Their mean, mm.
    pub mean_mm: f64,
    /// Their standard deviation, mm; 0 for fewer than two.
    pub standard_deviation_mm: f64,
}

impl Deviations {
    /// Takes in one deviation, mm. What is not finite is left out.
    pub fn push(&mut self, deviation: f64) {
        if !deviation.is_finite() {
            return;
        }
        (self.minimum, self.maximum) = match self.count {
            0 => (deviation, deviation),
            _ => (self.minimum.min(deviation), self.maximum.max(deviation)),
        };
        self.count += 1;
        let off = deviation - self.mean;
        self.mean += off / self.count as f64;
        self.squares += off * (deviation - self.mean);
    }

    /// The figures so far.
    pub fn figures(&self) -> Figures {
        let standard_deviation_mm =
            if self.count < 2 { 0.0 } else { (self.squares / (self.count - 1) as f64).max(0.0).sqrt() };
        Figures {
            count: self.count,
            maximum_mm: self.maximum,
            minimum_mm: self.minimum,
            mean_mm: self.mean,
            standard_deviation_mm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(values: &[f64]) -> Figures {
        let mut deviations = Deviations::default();
        values.iter().for_each(|&v| deviations.push(v));
        deviations.figures()
    }

    #[test]
    fn the_figures_are_those_of_the_textbook_sample() {
        let f = figures(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
        assert_eq!((f.count, f.minimum_mm, f.maximum_mm, f.mean_mm), (8, 2.0, 9.0, 5.0));
        assert!((f.standard_deviation_mm - (32.0f64 / 7.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_small_spread_about_a_large_mean_keeps_its_digits() {
        let f = figures(&[1e9 + 4.0, 1e9 + 7.0, 1e9 + 13.0, 1e9 + 16.0]);
        assert!((f.standard_deviation_mm - 30f64.sqrt()).abs() < 1e-9, "{f:?}");
    }

    #[test]
    fn nothing_and_one_value_have_no_spread() {
        assert_eq!(figures(&[]), Figures::default());
        assert_eq!(figures(&[0.5, f64::NAN]).standard_deviation_mm, 0.0);
        assert_eq!(figures(&[-0.5]).maximum_mm, -0.5);
    }
}
