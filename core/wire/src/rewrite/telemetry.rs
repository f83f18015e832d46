//! What a live trace shows of a state.

use super::{Place, State};
use crate::image::RATIO_ONE;

impl State {
    /// Place on the path, the last one when no correction is on.
    #[inline]
    pub const fn place(&self) -> Place {
        self.place
    }
    /// Live feed per tooth over the nominal one, smoothed, units of 2⁻¹⁶; 1 while no correction is on.
    #[inline]
    pub fn feed_ratio(&self) -> u32 {
        if self.mapping.is_some() { self.ratio.value() } else { RATIO_ONE }
    }
    /// Machine axes of the program's X and Y; 0 and 1 while nothing is armed.
    #[inline]
    pub fn plane(&self) -> [usize; 2] {
        self.mapping.as_ref().map_or([0, 1], |mapping| mapping.plane())
    }
}
