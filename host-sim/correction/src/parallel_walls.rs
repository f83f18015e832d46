//! The walls of a pass, read by all processors.
//!
//! A design reads the walls some thirty times, at thirteen heights that do not depend on each other
//! ([`truepath_core::correct::WallReader`]). The cutter's positions at all heights of a sample are found together, since they share
//! most of the force, and those of one stretch beside those of another; then half of the heights are read on a thread of their own.

use rayon::join;
use truepath_core::correct::{Band, HEIGHTS, Profile, WallReader, begin, finish, read_slice};
use truepath_core::cut::{Envelope, Loop, Path, State};
use truepath_core::geometry::Vector;
use truepath_core::units::Real;

/// Slices of the band.
const SLICES: usize = HEIGHTS as usize;
/// Samples of a stretch that is not divided among threads.
const STRETCH: usize = 512;

/// Memory for the heights.
#[derive(Clone, Debug)]
pub struct ParallelWalls {
    rows: [Vec<Vector>; SLICES + 1],
    profiles: Vec<Profile>,
}

impl ParallelWalls {
    /// For a path.
    pub(crate) fn of(path: &Path) -> Self {
        let row = || vec![Vector::ZERO; path.working().len()];
        Self { rows: std::array::from_fn(|_| row()), profiles: vec![Profile::default(); path.count()] }
    }
}

impl WallReader for ParallelWalls {
    fn profile(&mut self, machine: &Loop, states: &[State], band: Band, _: &mut [Vector], profiles: &mut [Profile]) {
        let Self { rows, profiles: others } = self;
        let tip = SLICES;
        let height = |k: usize| if k == tip { Real::ZERO } else { band.at(k as i64) };
        displace(machine, states, std::array::from_fn(height), rows.each_mut().map(Vec::as_mut_slice));
        begin(machine, profiles);
        begin(machine, others);
        let slices: Vec<(i64, &Vec<Vector>)> = (0..HEIGHTS).zip(&*rows).collect();
        let (lower, upper) = slices.split_at(SLICES / 2);
        let read = |slices: &[(i64, &Vec<Vector>)], profiles: &mut [Profile]| {
            slices.iter().for_each(|(slice, row)| read_slice(machine, *slice, row, profiles));
        };
        join(|| read(lower, profiles), || read(upper, others));
        for (own, other) in profiles.iter_mut().zip(&*others) {
            own.join(other);
        }
        finish(machine, &rows[tip], profiles);
    }
}

/// The cutter's displacements at heights of the engaged depth, one row each, of several stretches at a time.
pub(crate) fn displace<const N: usize>(machine: &Loop, states: &[State], heights: [Real; N], rows: [&mut [Vector]; N]) {
    if states.len() <= STRETCH {
        return Envelope::displace_all(machine, states, heights, rows);
    }
    let (near, far) = states.split_at(states.len() / 2);
    let mut halves = rows.map(|row| row.split_at_mut(near.len()));
    let near_rows = halves.each_mut().map(|(near, _)| std::mem::take(near));
    let far_rows = halves.map(|(_, far)| far);
    join(|| displace(machine, near, heights, near_rows), || displace(machine, far, heights, far_rows));
}
