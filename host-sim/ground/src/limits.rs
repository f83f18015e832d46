//! Ranges of quantities, as a job states them and as an error names them.

use super::decimal::Decimal;
use crate::length::{Unit, within};

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
        self.worded(self.low, self.high, self.unit)
    }
    /// The same in a unit, where it is a length or a speed: "0.00394 to 3.93 in".
    pub fn phrase_in(self, unit: Unit) -> String {
        let behind = self.unit.strip_prefix("mm").filter(|behind| matches!(*behind, "" | "/min"));
        let ends = || Some([self.low.parse().ok()?, self.high.parse().ok()?]);
        match (behind.filter(|_| unit == Unit::Inch), ends()) {
            (Some(behind), Some(ends)) => {
                let [low, high] = within(ends);
                self.worded(&low, &high, &format!("{}{behind}", unit.name()))
            }
            _ => self.phrase(),
        }
    }
    /// The same in both units, for a length on a command line.
    pub fn phrase_in_both(self) -> String {
        format!("{} ({})", self.phrase(), self.phrase_in(Unit::Inch))
    }
    fn worded(self, low: &str, high: &str, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        if self.above { format!("above {low}, up to {high}{unit}") } else { format!("{low} to {high}{unit}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_in_inches_takes_its_own_ends() {
        let all = [
            (Limits::within("0.1", "100", "mm"), "0.00394 to 3.93 in"),
            (Limits::above("0", "200", "mm"), "above 0, up to 7.87 in"),
            (Limits::within("-10", "10", "mm"), "-0.393 to 0.393 in"),
            (Limits::within("0.1", "100000", "mm/min"), "0.00394 to 3937 in/min"),
            (Limits::within("50", "800", "kN/mm²"), "50 to 800 kN/mm²"),
            (Limits::within("1", "12", ""), "1 to 12"),
        ];
        for (limits, words) in all {
            assert_eq!(limits.phrase_in(Unit::Inch), words);
            assert_eq!(limits.phrase_in(Unit::Millimetre), limits.phrase());
            let ends = words.split(' ').filter_map(|word| Decimal::parse(word.trim_end_matches(',')));
            assert!(ends.filter(|end| !words.contains("in") || limits.admits(end.of_inches())).count() >= 1, "{words}");
        }
        assert_eq!(Limits::within("0.0001", "10", "mm").phrase_in_both(), "0.0001 to 10 mm (0.000004 to 0.393 in)");
    }
}
