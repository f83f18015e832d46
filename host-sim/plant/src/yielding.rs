//! A stretch of the wall that yields: the wall itself moves away from the cutter under the normal force, and comes back after it.
//!
//! What counts is where the cutter is against the wall, so a wall that moves by c·F leaves as much material as a cutter that is pushed
//! away by c·F along the normal. The stretch yields over the height as the cutter bends there.

use serde::{Deserialize, Serialize};

use super::error::{PlantError, require};

/// Where the wall yields, and how much. `[yielding]` of a `PLANT.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct YieldingWall {
    /// Where the stretch begins along the contour, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
    /// Way over which it comes to yield in full from its beginning, and no longer does at its end, mm; more than 0.
    pub rise_mm: f64,
    /// How far the wall yields along its normal per normal force, mm/N, 0…0.1.
    pub compliance_mm_per_n: f64,
}

impl Default for YieldingWall {
    fn default() -> Self {
        Self { from_mm: 0.0, to_mm: 0.0, rise_mm: 5.0, compliance_mm_per_n: 0.0 }
    }
}

impl YieldingWall {
    pub(super) fn is_rigid(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), PlantError> {
        let (from, to, rise, c) = (self.from_mm, self.to_mm, self.rise_mm, self.compliance_mm_per_n);
        require(from >= 0.0 && from.is_finite(), "yielding.from_mm", from, "a place along the contour")?;
        require(to >= from && to.is_finite(), "yielding.to_mm", to, "no less than from_mm")?;
        require(rise > 0.0 && rise.is_finite(), "yielding.rise_mm", rise, "more than 0 mm")?;
        require((0.0..=0.1).contains(&c), "yielding.compliance_mm_per_n", c, "0 to 0.1 mm/N")
    }

    /// Compliance at a place along the contour, mm/N.
    pub(super) fn at(&self, s_mm: f64) -> f64 {
        let risen = |x: f64| {
            let u = (x / self.rise_mm).clamp(0.0, 1.0);
            u * u * (3.0 - 2.0 * u)
        };
        self.compliance_mm_per_n * risen(s_mm - self.from_mm) * risen(self.to_mm - s_mm)
    }
}
