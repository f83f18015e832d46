//! The grid of numbers a program can be written on: decimals of a millimetre or an inch.
//!
//! Four decimals of a millimetre (100 nm) and six of an inch (25.4 nm) keep the rounding of a coordinate at or below
//! 50 nm. Counts of grid steps are exact integers, so a point shared by two blocks is written with the same digits.

use truepath_core::gcode::Units;
use truepath_core::units::div_rounded;

/// A unit of length with a number of decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    unit_nm: i64,
    decimals: u32,
}

impl Grid {
    /// The grid a program in these units is written on.
    pub const fn of(units: Units) -> Self {
        let decimals = match units {
            Units::Millimetres => 4,
            Units::Inches => 6,
        };
        Self { unit_nm: units.nanometres(), decimals }
    }

    /// Grid steps nearest to a length in nanometres.
    pub fn steps(self, nm: i64) -> i64 {
        div_rounded(i128::from(nm) * self.power(), self.unit_nm.into()) as i64
    }
    /// Grid steps nearest to a length in nanometres with a fraction.
    pub fn steps_of(self, nm: f64) -> i64 {
        (nm / self.step_nm()).round() as i64
    }
    /// The length of a number of steps, nanometres.
    pub fn nm(self, steps: i64) -> f64 {
        (i128::from(steps) * i128::from(self.unit_nm)) as f64 / self.power() as f64
    }
    /// One step, nanometres.
    pub fn step_nm(self) -> f64 {
        self.unit_nm as f64 / self.power() as f64
    }
    const fn power(self) -> i128 {
        10i128.pow(self.decimals)
    }

    /// The decimal text of a number of steps: always with a point, without idle zeros behind it.
    pub fn text(self, steps: i64) -> String {
        let power = self.power() as u64;
        let (whole, fraction) = (steps.unsigned_abs() / power, steps.unsigned_abs() % power);
        let digits = format!("{fraction:0width$}", width = self.decimals as usize);
        let sign = if steps < 0 { "-" } else { "" };
        format!("{sign}{whole}.{}", digits.trim_end_matches('0'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_exact_and_rounds_to_nearest_on_both_sides() {
        let mm = Grid::of(Units::Millimetres);
        for (nm, text) in
            [(0, "0."), (34_000_000, "34."), (-34_091_449, "-34.0914"), (50, "0.0001"), (-50, "-0.0001"), (49, "0.")]
        {
            assert_eq!(mm.text(mm.steps(nm)), text);
        }
        let inch = Grid::of(Units::Inches);
        assert_eq!(inch.text(inch.steps(2_540)), "0.0001");
        assert_eq!(inch.text(inch.steps(-25_400_000)), "-1.");
    }
}
