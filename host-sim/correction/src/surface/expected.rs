//! What is expected of a whole wall, at every height: how large its error is, how sure that is, and what makes it. Every command that
//! predicts a wall, of one pass or of several, says it with these figures.

use truepath_ground::length::Unit;
use truepath_ground::rows;

use super::causes::Causes;
use super::draws::{Draws, Predicted, Uncertain};

/// The predicted error of a whole wall, at every height, mm. Values are means over the machines that the points allow.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Surface {
    /// The largest error anywhere, the sign aside: the profile error.
    #[serde(flatten)]
    pub profile: Predicted,
    /// 95 of 100 places are nearer to the nominal wall than this.
    pub p95_mm: f64,
    /// Its standard deviation.
    pub p95_sigma_mm: f64,
    /// The largest mean over the height.
    pub mean_mm: f64,
    /// Its standard deviation.
    pub mean_sigma_mm: f64,
    /// Where the identified machine has its largest error, along the contour.
    pub s_mm: f64,
    /// Its height above the tip.
    pub height_mm: f64,
    /// What makes the error there.
    pub causes: Causes,
}

/// The wall of a pass without and with a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Surfaces {
    /// Without it.
    pub before: Surface,
    /// With it.
    pub after: Surface,
}

impl Surfaces {
    /// Of several contours: each wall is the worst of all.
    pub fn worst(all: impl Iterator<Item = Self> + Clone) -> Self {
        let worst = |of: fn(&Self) -> Surface| {
            let walls = all.clone().map(|both| of(&both));
            walls.max_by(|a, b| a.profile.profile_mm.total_cmp(&b.profile.profile_mm)).unwrap_or_default()
        };
        Self { before: worst(|both| both.before), after: worst(|both| both.after) }
    }

    /// Both in a sentence.
    pub fn words(&self, unit: Unit) -> String {
        let (before, after, name) = (&self.before, &self.after, unit.name());
        format!(
            "mean over the height {:.3} -> {:.3} {name}; worst at any height {:.3} -> {:.3} ± {:.3} {name}",
            unit.of(before.mean_mm),
            unit.of(after.mean_mm),
            unit.of(before.profile.profile_mm),
            unit.of(after.profile.profile_mm),
            unit.of(2.0 * after.profile.sigma_mm)
        )
    }
}

impl Surface {
    /// Of a predicted wall with what is not known of it, and the draws of its profile error. `worst` is which of its errors is the
    /// largest, `place` where that is: arc length and height above the tip, mm.
    pub fn of(uncertain: &Uncertain, worst: usize, place: (f64, f64)) -> (Self, Draws) {
        let mut magnitudes = Vec::new();
        let [profile, p95, mean] = uncertain.draws(|wall| {
            rows::magnitudes(wall, &mut magnitudes);
            let [p95, largest] = rows::p95_and_largest(&mut magnitudes);
            [largest, p95, rows::largest_mean(wall, uncertain.heights)]
        });
        let (within, over_height) = (p95.predicted(), mean.predicted());
        let surface = Self {
            profile: profile.predicted(),
            p95_mm: within.profile_mm,
            p95_sigma_mm: within.sigma_mm,
            mean_mm: over_height.profile_mm,
            mean_sigma_mm: over_height.sigma_mm,
            s_mm: place.0,
            height_mm: place.1,
            causes: uncertain.causes_at(worst),
        };
        (surface, profile)
    }

    /// Where the largest error is and what makes it, in a line.
    pub fn worst_words(&self, unit: Unit) -> String {
        format!("{}: {}", place_words(unit, self.s_mm, self.height_mm), self.causes.words(unit))
    }
}

/// A place of the wall in words.
pub(super) fn place_words(unit: Unit, s_mm: f64, height_mm: f64) -> String {
    format!("at s = {:.1} {name}, {:.1} {name} above the tip", unit.of(s_mm), unit.of(height_mm), name = unit.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_of_a_wall_are_drawn_together_and_its_mean_counts_all_heights_of_a_place() {
        // Two places of two heights: +10 and −30 um, +8 and +8 um; the points leave 2 um of level open.
        let wall = Uncertain {
            heights: 2,
            base: vec![0.010, -0.030, 0.008, 0.008],
            noise: vec![vec![0.002; 4]],
            ..Uncertain::default()
        };
        let (surface, draws) = Surface::of(&wall, 1, (12.0, 3.0));
        let near = |value: f64, wanted: f64, by: f64| assert!((value - wanted).abs() < by, "{value}: {surface:?}");
        near(surface.profile.profile_mm, 0.030, 0.0005);
        near(surface.profile.sigma_mm, 0.002, 0.0003);
        near(surface.p95_mm, 0.030, 0.0005);
        near(surface.mean_mm, 0.0108, 0.0005);
        near(surface.causes.error_mm(), -0.030, 1e-12);
        near(surface.causes.mean_mm, -0.010, 1e-12);
        assert_eq!((surface.s_mm, surface.height_mm), (12.0, 3.0));
        assert!((draws.within(0.030) - 0.5).abs() < 0.08);
        assert!(
            surface
                .worst_words(Unit::Millimetre)
                .starts_with("at s = 12.0 mm, 3.0 mm above the tip: -0.0300 mm = mean -0.0100")
        );
    }
}
