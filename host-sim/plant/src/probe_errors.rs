//! What a probe reads wrong besides noise: its lobes, and touches that are plainly wrong.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use serde::{Deserialize, Serialize};

use super::error::{PlantError, require};
use super::vector::Point;

/// Lobes and wild touches of a probe. `[probe]` of a `PLANT.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProbeErrors {
    /// How much later than on the mean the probe trips in the direction of a lobe, and earlier between two of the three, mm, 0…1.
    pub lobing_mm: f64,
    /// Direction of approach of a lobe, degrees from +X.
    pub lobing_deg: f64,
    /// How much earlier a wild touch stops, −10…10 mm: a chip under the ball where it is positive.
    pub wild_mm: f64,
    /// One touch in so many is wild, by chance which, at least 1.
    pub wild_one_in: u64,
}

impl Default for ProbeErrors {
    fn default() -> Self {
        Self { lobing_mm: 0.0, lobing_deg: 0.0, wild_mm: 0.0, wild_one_in: 24 }
    }
}

impl ProbeErrors {
    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), PlantError> {
        require((0.0..=1.0).contains(&self.lobing_mm), "probe.lobing_mm", self.lobing_mm, "0 to 1 mm")?;
        require(self.lobing_deg.is_finite(), "probe.lobing_deg", self.lobing_deg, "an angle")?;
        require((-10.0..=10.0).contains(&self.wild_mm), "probe.wild_mm", self.wild_mm, "-10 to 10 mm")?;
        require(self.wild_one_in >= 1, "probe.wild_one_in", self.wild_one_in as f64, "at least 1")
    }

    /// How much farther than the wall the touch with this number reads along the direction of its approach, mm.
    pub(super) fn beyond(&self, number: u64, approach: Point, seed: u64) -> f64 {
        let lobe = 3.0 * (approach[1].atan2(approach[0]) - self.lobing_deg.to_radians());
        let wild = if self.is_wild(number, seed) { self.wild_mm } else { 0.0 };
        self.lobing_mm * lobe.cos() - wild
    }

    fn is_wild(&self, number: u64, seed: u64) -> bool {
        if self.wild_mm == 0.0 {
            return false;
        }
        let (group, place) = (number / self.wild_one_in, number % self.wild_one_in);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(4);
        rng.set_word_pos(2 * u128::from(group));
        rng.next_u64() % self.wild_one_in == place
    }
}
