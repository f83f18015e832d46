//! The wall's height in even slices.

use crate::cut::CutSetup;
use truepath_units::Real;

/// The most slices of a wall.
pub const MAX_SLICES: usize = 48;
/// A tooth turns by no more than this over a slice, if so many slices suffice, rad.
const LAG: Real = Real::ratio(4, 100);
/// The fewest slices of a wall.
const FEWEST: usize = 12;

/// Even slices of the engaged depth, from the tip upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slices {
    count: usize,
}

impl Slices {
    /// A number of slices, limited to 1…[`MAX_SLICES`].
    pub fn new(count: usize) -> Self {
        Self { count: count.clamp(1, MAX_SLICES) }
    }
    /// As many as the helix needs: a tooth turns by 0.04 rad over each, or as little as the most slices allow; a whole
    /// multiple of `parts`, so that so many even levels end on borders.
    pub fn of(setup: &CutSetup, parts: usize) -> Self {
        let lag = setup.helix().lag_per_mm * setup.axial_depth;
        let wanted = usize::try_from((lag / LAG).floor().saturating_add(1)).unwrap_or(FEWEST);
        let parts = parts.clamp(1, MAX_SLICES);
        let most = MAX_SLICES.checked_div(parts).unwrap_or(1).max(1);
        let each = wanted.clamp(FEWEST, MAX_SLICES).div_ceil(parts).min(most);
        Self { count: each.saturating_mul(parts) }
    }
    /// How many there are.
    pub const fn count(self) -> usize {
        self.count
    }
    /// Height of one, mm, in a wall of the given height, mm.
    pub fn thickness(self, height: Real) -> Real {
        height / Real::from_int(self.count as i32)
    }
    /// Middle of slice `k` above that of the tip at the lower border of `first`, as a fraction of the wall's height.
    pub fn fraction(self, k: usize, first: usize) -> Real {
        let twice = k.saturating_sub(first).saturating_mul(2).saturating_add(1) as i64;
        Real::ratio(twice, (self.count as i64).saturating_mul(2))
    }
}
