//! The drives of the machine: their lag and the play of their screws.

use serde::{Deserialize, Serialize};

use super::error::{PlantError, require};

/// What the drives do with the command. `[drives]` of a `PLANT.toml`.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Drives {
    /// Time constant of the first-order lag of both axes, 0…1 s.
    pub time_constant_s: f64,
    /// Play of the x and of the y axis, 0…1 mm.
    pub backlash_mm: [f64; 2],
}

impl Drives {
    pub(super) fn is_exact(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn check(&self) -> Result<(), PlantError> {
        let lag = self.time_constant_s;
        require((0.0..=1.0).contains(&lag), "drives.time_constant_s", lag, "0 to 1 s")?;
        for play in self.backlash_mm {
            require((0.0..=1.0).contains(&play), "drives.backlash_mm", play, "0 to 1 mm")?;
        }
        Ok(())
    }
}
