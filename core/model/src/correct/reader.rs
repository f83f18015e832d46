//! Who reads the walls of a design: one height after the other, or several at once.
//!
//! A design reads the wall at thirteen heights on every pass of the cutter, and most of its time goes there. The heights do
//! not depend on each other, so whoever has more than one processor may read them at the same time; the core has one.

use super::profile::{Band, Profile, profile};
use crate::cut::{Loop, State};
use truepath_units::geometry::Vector;

/// Reads the profile of the walls off the states of a pass, to the last bit as [`profile`] does.
pub trait WallReader {
    /// As [`profile`].
    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    );
}

/// One height after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct InOrder;

impl<R: WallReader> WallReader for &mut R {
    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    ) {
        (**self).profile(machine, states, band, displacements, profiles);
    }
}

impl WallReader for InOrder {
    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    ) {
        profile(machine, states, band, displacements, profiles);
    }
}
