//! What is uneven about the stock: what roughing leaves, and the level of this part.

use serde::{Deserialize, Serialize};

use super::error::{PlantError, require};

/// What is uneven about the stock, in shares of the allowance. `[stock]` of a `PLANT.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UnevenStock {
    /// Seed of the waves: that of the roughing program, alike for all parts that it has cut.
    pub seed: u64,
    /// Largest deviation of the waves on this contour, 0…1.
    pub waves: f64,
    /// Shortest wavelength of the waves, at least 1 mm.
    pub wavelength_mm: f64,
    /// More stock (or less) from `step_from_mm` on, −1…2.
    pub step: f64,
    /// Where the step is, mm along the contour.
    pub step_from_mm: f64,
    /// More stock in inside corners, −1…2: all of it where the path turns away from the wall by a radian or more within a cutter
    /// radius of way, less in proportion.
    pub corner: f64,
    /// More stock (or less) everywhere on this part, −1…2.
    pub level: f64,
}

impl Default for UnevenStock {
    fn default() -> Self {
        Self { seed: 0, waves: 0.0, wavelength_mm: 40.0, step: 0.0, step_from_mm: 0.0, corner: 0.0, level: 0.0 }
    }
}

impl UnevenStock {
    pub(super) fn is_even(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), PlantError> {
        require((0.0..=1.0).contains(&self.waves), "stock.waves", self.waves, "0 to 1")?;
        let wave = self.wavelength_mm;
        require(wave >= 1.0 && wave.is_finite(), "stock.wavelength_mm", wave, "at least 1 mm")?;
        for (key, value) in [("stock.step", self.step), ("stock.corner", self.corner), ("stock.level", self.level)] {
            require((-1.0..=2.0).contains(&value), key, value, "-1 to 2")?;
        }
        let from = self.step_from_mm;
        require(from >= 0.0 && from.is_finite(), "stock.step_from_mm", from, "a place along the contour")?;
        let least = [self.step, self.corner, self.level].map(|share| share.min(0.0)).iter().sum::<f64>() - self.waves;
        require(least > -1.0, "stock", least, "waves, step, corner and level that together leave some stock")
    }
}
