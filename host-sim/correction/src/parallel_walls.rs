//! The walls of a pass, half of the heights on a thread of their own.
//!
//! A design reads the walls some thirty times, at thirteen heights that do not depend on each other
//! ([`truepath_core::correct::WallReader`]).

use truepath_core::correct::{Band, HEIGHTS, Profile, WallReader, begin, finish, read_slices};
use truepath_core::cut::{Loop, Path, State};
use truepath_core::geometry::Vector;

/// Memory for the other half of the heights.
#[derive(Clone, Debug)]
pub struct ParallelWalls {
    displacements: Vec<Vector>,
    profiles: Vec<Profile>,
}

impl ParallelWalls {
    /// For a path.
    pub(crate) fn of(path: &Path) -> Self {
        let (count, working) = (path.count(), path.working().len());
        Self { displacements: vec![Vector::ZERO; working], profiles: vec![Profile::default(); count] }
    }
}

impl WallReader for ParallelWalls {
    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    ) {
        let half = HEIGHTS / 2;
        begin(machine, profiles);
        begin(machine, &mut self.profiles);
        rayon::join(
            || read_slices(machine, states, band, 0..half, displacements, profiles),
            || read_slices(machine, states, band, half..HEIGHTS, &mut self.displacements, &mut self.profiles),
        );
        for (own, other) in profiles.iter_mut().zip(&self.profiles) {
            own.join(other);
        }
        finish(machine, states, displacements, profiles);
    }
}
