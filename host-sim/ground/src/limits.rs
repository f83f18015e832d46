//! Ranges of quantities, as a job states them and as an error names them.

use super::decimal::Decimal;

/// A closed or half-open range of a quantity. The bounds are decimal text, so that they mean what they say.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    low: &'static str,
    high: &'static str,
    above: bool,
    unit: &'static str,
}

impl Limits {
    /// `low ≤ value ≤ high`.
    pub const fn within(low: &'static str, high: &'static str, unit: &'static str) -> Self {
        Self { low, high, above: false, unit }
    }
    /// `low < value ≤ high`.
    pub const fn above(low: &'static str, high: &'static str, unit: &'static str) -> Self {
        Self { low, high, above: true, unit }
    }
    /// Whether a value lies in the range.
    pub fn admits(self, value: Decimal) -> bool {
        // Bounds are literals of this crate; one that is no number admits nothing and fails every test.
        let bound = |text| Decimal::parse(text);
        let (Some(low), Some(high)) = (bound(self.low), bound(self.high)) else {
            return false;
        };
        value <= high && if self.above { value > low } else { value >= low }
    }
    /// "0.1 to 100 mm", "above 0, up to 100 mm".
    pub fn phrase(self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        if self.above {
            format!("above {}, up to {}{unit}", self.low, self.high)
        } else {
            format!("{} to {}{unit}", self.low, self.high)
        }
    }
}
