//! The decision about one deviation (ISO 14253-1).
//!
//! With expanded uncertainty U (k = 2) a deviation is proven within the limits when the whole interval ±U around it is,
//! proven outside when the whole interval is, and undecided otherwise. A guard band of U is a little stricter than the
//! 95 % conformance probability of the edition of 2017 (0.83 U for a normal distribution). Without an uncertainty the
//! deviation is taken as exact: simple acceptance.

use truepath_core::units::Offset;
use truepath_ground::length::Unit;
use truepath_ground::units::mm;
use truepath_job::job::Tolerance;

/// What is known of one point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PointVerdict {
    /// Within the limits.
    Pass,
    /// Outside.
    Fail,
    /// The uncertainty reaches across a limit.
    Open,
}

/// Limits and uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule {
    /// The limits.
    pub tolerance: Tolerance,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: Option<Offset>,
}

impl Rule {
    /// Judges a deviation.
    pub fn point(&self, deviation: Offset) -> PointVerdict {
        let guard = self.uncertainty.unwrap_or_default();
        let Tolerance { lower, upper, .. } = self.tolerance;
        if deviation > upper + guard || deviation < lower - guard {
            PointVerdict::Fail
        } else if deviation <= upper - guard && deviation >= lower + guard {
            PointVerdict::Pass
        } else {
            PointVerdict::Open
        }
    }

    /// Decimals of a millimetre, as [`Unit::of`] takes them, that tell each deviation in a unit without contradicting its verdict: 4, or
    /// 6 (whole nanometres) where a value rounded to 4 would lie on the other side of a limit; of an inch 7 where it takes that.
    pub fn decimals(&self, deviations: &[Offset], unit: Unit) -> usize {
        let rounded = |d: &Offset, decimals: usize| {
            let told: f64 = format!("{:.decimals$}", unit.of(mm(*d))).parse().unwrap_or_default();
            Offset::from_nm((unit.in_mm(told) * 1e6).round() as i64)
        };
        let holds = |decimals: usize| deviations.iter().all(|d| self.point(rounded(d, decimals)) == self.point(*d));
        let (few, most): (&[usize], _) = match unit {
            Unit::Millimetre => (&[4], 6),
            Unit::Inch => (&[4, 5, 6], 7),
        };
        few.iter().copied().find(|decimals| holds(*decimals)).unwrap_or(most)
    }

    /// Whether the uncertainty leaves no deviation that could be proven within the limits.
    pub fn proves_nothing(&self) -> bool {
        let guard = self.uncertainty.unwrap_or_default();
        self.tolerance.upper - guard < self.tolerance.lower + guard
    }

    /// The rule in words, for the report.
    pub fn words(&self, unit: Unit) -> String {
        match self.uncertainty {
            Some(uncertainty) => format!(
                "Decision rule after ISO 14253-1, guard band U = {} {} (expanded uncertainty of a probed deviation, k = 2) on \
                 both sides of each limit: a point passes where its deviation is within the limits by at least U, fails where \
                 it is beyond a limit by more than U, and is undecided between. The part fails with the first point that \
                 fails, passes when all points pass, and is open otherwise.",
                unit.of(mm(uncertainty)),
                unit.name()
            ),
            None => "Simple acceptance: no measuring uncertainty is given and none is taken into account; a point passes \
                     where its deviation is within the limits, the limits included, and fails otherwise. The part fails with \
                     the first point that fails and passes when all points pass."
                .to_owned(),
        }
    }
}

/// `±0.02 mm`, or `-0.01 … +0.02 mm`.
pub(super) fn limits_text(tolerance: Tolerance, unit: Unit) -> String {
    let Tolerance { lower, upper, .. } = tolerance;
    let (least, most, name) = (unit.of(mm(lower)), unit.of(mm(upper)), unit.name());
    if lower == -upper { format!("±{most} {name}") } else { format!("{least:+} to {most:+} {name}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(lower: i64, upper: i64, uncertainty: Option<i64>) -> Rule {
        let tolerance =
            Tolerance { lower: Offset::from_nm(lower), upper: Offset::from_nm(upper), from_command_line: false };
        Rule { tolerance, uncertainty: uncertainty.map(Offset::from_nm) }
    }

    #[test]
    fn the_guard_band_lies_on_both_sides_of_each_limit_and_its_ends_belong_to_it_where_they_prove_nothing() {
        let rule = rule(-20_000, 20_000, Some(5_000));
        for (nm, verdict) in [
            (0, PointVerdict::Pass),
            (15_000, PointVerdict::Pass),
            (15_001, PointVerdict::Open),
            (20_000, PointVerdict::Open),
            (25_000, PointVerdict::Open),
            (25_001, PointVerdict::Fail),
        ] {
            assert_eq!(rule.point(Offset::from_nm(nm)), verdict, "{nm}");
            assert_eq!(rule.point(Offset::from_nm(-nm)), verdict, "-{nm}");
        }
    }

    #[test]
    fn without_uncertainty_a_point_passes_up_to_the_limit_itself_and_is_never_open() {
        let rule = rule(0, 20_000, None);
        for (nm, verdict) in [
            (-1, PointVerdict::Fail),
            (0, PointVerdict::Pass),
            (20_000, PointVerdict::Pass),
            (20_001, PointVerdict::Fail),
        ] {
            assert_eq!(rule.point(Offset::from_nm(nm)), verdict, "{nm}");
        }
    }

    #[test]
    fn a_deviation_is_never_rounded_to_the_other_side_of_its_limit() {
        let decimals = |rule: Rule, nm: i64| rule.decimals(&[Offset::from_nm(nm)], Unit::Millimetre);
        let exact = rule(0, 20_000, None);
        for (nm, expected) in [(20_000, 4), (19_951, 4), (20_049, 6), (20_051, 4), (-49, 6), (-51, 4), (12_345, 4)] {
            assert_eq!(decimals(exact, nm), expected, "{nm}");
        }
        // A limit between two tenths of a micrometre.
        assert_eq!(decimals(rule(0, 20_040, None), 20_030), 4);
        assert_eq!(decimals(rule(0, 20_080, None), 20_070), 6);
        assert_eq!(decimals(rule(0, 20_000, Some(5_000)), 15_010), 6);
        // In inches, of a limit of a thousandth and one that is round in millimetres, with as many digits as that takes.
        let inches = |upper: i64, nm: i64| {
            let rule = rule(-upper, upper, None);
            let decimals = rule.decimals(&[Offset::from_nm(nm)], Unit::Inch);
            format!("{:.decimals$} of {}", Unit::Inch.of(nm as f64 / 1e6), limits_text(rule.tolerance, Unit::Inch))
        };
        assert_eq!(inches(25_400, 25_300), "0.00100 of ±0.001 in");
        assert_eq!(inches(25_400, 25_450), "0.001002 of ±0.001 in");
        assert_eq!(inches(25_400, 25_401), "0.00100004 of ±0.001 in");
        assert_eq!(inches(20_000, 20_010), "0.00079 of ±0.0007874 in");
        assert_eq!(inches(20_000, 19_990), "0.000787 of ±0.0007874 in");
    }

    #[test]
    fn an_uncertainty_of_more_than_half_the_width_proves_no_point_within() {
        assert!(!rule(0, 20_000, Some(10_000)).proves_nothing());
        let wide = rule(0, 20_000, Some(10_001));
        assert!(wide.proves_nothing());
        assert!((-40_000..40_000).all(|nm| wide.point(Offset::from_nm(nm)) != PointVerdict::Pass));
    }
}
