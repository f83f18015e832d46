//! The tolerance of the job held against what the model foretells of the corrected part.
//!
//! A prediction proves nothing about a part that is not milled yet: it can say that the tolerance will be missed, and
//! otherwise that it is expected to be kept, which stays open until the part has been touched (`truepath inspect`).
//! Everywhere along the contour and at every height of the band the interval of two standard deviations around the
//! predicted error counts.

use truepath_core::units::Offset;
use truepath_correction::correction::Correction;
use truepath_ground::length::{Said, Unit};
use truepath_ground::units::mm;
use truepath_job::job::Tolerance;

use crate::page::{Limits, Page, State, Verdict};

/// Puts tolerance and verdict on the page, where the job gives limits.
pub(super) fn judge(page: &mut Page, tolerance: Option<Tolerance>, correction: &Correction) {
    let Some(limits) = tolerance else { return };
    let (lower_mm, upper_mm) = (mm(limits.lower), mm(limits.upper));
    if limits.upper == -limits.lower {
        page.tolerance_mm = Some(upper_mm);
    } else {
        page.limits = Some(Limits { lower_mm, upper_mm, uncertainty_mm: None, from: None });
    }
    page.verdict = Some(verdict(&limits, correction));
}

fn verdict(limits: &Tolerance, correction: &Correction) -> Verdict {
    let (mut inside, mut outside) = (true, false);
    let mut worst = Offset::ZERO;
    for (predicted, sigma) in correction.predicted.iter().zip(&correction.sigma) {
        let (wall, spread) = (&predicted.after, *sigma + *sigma);
        if !wall.on_wall {
            continue;
        }
        let beyond = |spread: Offset| (wall.highest + spread - limits.upper).max(limits.lower - (wall.lowest - spread));
        inside &= beyond(spread) <= Offset::ZERO;
        outside |= beyond(-spread) > Offset::ZERO;
        worst = worst.max(beyond(Offset::ZERO));
    }
    let text = |unit: Unit| {
        let name = unit.name();
        let within = format!("{:+} to {:+} {name}", unit.of(mm(limits.lower)), unit.of(mm(limits.upper)));
        if outside {
            let by = unit.of(mm(worst));
            format!(
                "predicted: somewhere the corrected wall is outside {within}, by up to {by:.3} {name} at some height"
            )
        } else if inside {
            format!(
                "predicted: within {within} everywhere, at every height, with two standard deviations; the corrected part, measured, decides"
            )
        } else {
            let why = "within two standard deviations of a limit";
            format!("predicted: somewhere {why} of {within}; more points tell (truepath probe --next)")
        }
    };
    Verdict { state: if outside { State::Fail } else { State::Open }, text: Said::of(text) }
}

#[cfg(test)]
mod tests {
    use truepath_core::correct::{Band, Design, Law, Predicted, Profile, Target};
    use truepath_core::cut::Passage;

    use super::*;

    /// Walls from lowest to highest, µm, all with one standard deviation of 1 µm.
    fn correction(walls: &[(i64, i64)]) -> Correction {
        let um = Offset::from_um;
        let wall = |(lowest, highest): &(i64, i64)| {
            let mut after = Profile::default();
            (after.lowest, after.highest, after.on_wall) = (um(*lowest), um(*highest), true);
            Predicted { before: after, after }
        };
        let wanted = Design { law: Law::Model, target: Target::Mean, band: Band::WHOLE, max_gouge: None };
        Correction {
            turning: vec![false; walls.len()],
            nodes: Vec::new(),
            unguarded: Vec::new(),
            predicted: walls.iter().map(wall).collect(),
            sigma: vec![um(1); walls.len()],
            sigma_by_points: vec![um(1); walls.len()],
            damped: None,
            used_again: false,
            wanted,
            passage: Passage::default(),
        }
    }

    fn limits(lower_um: i64, upper_um: i64) -> Tolerance {
        Tolerance { lower: Offset::from_um(lower_um), upper: Offset::from_um(upper_um), from_command_line: false }
    }

    fn verdict_of(walls: &[(i64, i64)]) -> Verdict {
        verdict(&limits(-10, 20), &correction(walls))
    }

    #[test]
    fn even_limits_are_a_tolerance_and_uneven_ones_are_limits() {
        let judged = |limits| {
            let mut page = Page::new(crate::page::Kind::Correct, "part");
            judge(&mut page, limits, &correction(&[(0, 0)]));
            (page.tolerance_mm, page.limits.map(|l| (l.lower_mm, l.upper_mm)), page.verdict.is_some())
        };
        assert_eq!(judged(Some(limits(-20, 20))), (Some(0.02), None, true));
        assert_eq!(judged(Some(limits(0, 20))), (None, Some((0.0, 0.02)), true));
        assert_eq!(judged(None), (None, None, false));
    }

    #[test]
    fn a_prediction_within_the_limits_stays_open_until_the_part_is_measured() {
        let verdict = verdict_of(&[(-8, 18), (0, 0)]);
        assert_eq!(verdict.state, State::Open);
        assert!(verdict.text.in_unit(Unit::Millimetre).contains("within -0.01 to +0.02 mm everywhere"), "{verdict:?}");
    }

    #[test]
    fn a_wall_that_may_or_may_not_be_outside_is_open() {
        for wall in [(-9, 0), (0, 19), (0, 21), (-11, 0)] {
            let verdict = verdict_of(&[wall]);
            assert_eq!(verdict.state, State::Open);
            assert!(verdict.text.in_unit(Unit::Millimetre).contains("more points tell"), "{verdict:?}");
        }
    }

    #[test]
    fn a_wall_that_is_outside_with_two_standard_deviations_fails() {
        let verdict = verdict_of(&[(0, 0), (0, 23)]);
        assert_eq!(verdict.state, State::Fail);
        assert!(verdict.text.in_unit(Unit::Millimetre).contains("by up to 0.003 mm"), "{verdict:?}");
        assert_eq!(verdict_of(&[(-13, 0)]).state, State::Fail);
    }
}
