//! Who runs the cutter and reads the walls of a design: one sample and one height after the other, or several at once.
//!
//! A design reads the wall at thirteen heights on every pass of the cutter, and most of its time goes there. The heights do
//! not depend on each other, so whoever has more than one processor may read them at the same time; the core has one.

use super::profile::{Band, Profile, profile};
use super::scratch::Scratch;
use crate::cut::{Loop, Passage, State};
use truepath_units::geometry::Vector;

/// Runs the cutter to the last bit as [`Loop::run`] does, and reads the profile of the walls off its states as [`profile`] does.
pub trait WallReader {
    /// As [`Loop::run`]; `observe` is told samples that it comes to, in their order.
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        commanded: impl Fn(usize) -> Vector + Sync,
        observe: &mut dyn FnMut(usize),
    ) -> Passage;

    /// As [`profile`].
    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    );

    /// Hands out slots in pieces of a length, each with the index of its first slot: no piece depends on another.
    fn each(&mut self, slots: &mut [Scratch], length: usize, work: impl Fn(usize, &mut [Scratch]) + Sync);
}

/// One height after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct InOrder;

impl<R: WallReader> WallReader for &mut R {
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        commanded: impl Fn(usize) -> Vector + Sync,
        observe: &mut dyn FnMut(usize),
    ) -> Passage {
        (**self).run(machine, from, states, commanded, observe)
    }

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

    fn each(&mut self, slots: &mut [Scratch], length: usize, work: impl Fn(usize, &mut [Scratch]) + Sync) {
        (**self).each(slots, length, work);
    }
}

impl WallReader for InOrder {
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        commanded: impl Fn(usize) -> Vector + Sync,
        observe: &mut dyn FnMut(usize),
    ) -> Passage {
        machine.run(from, states, |index| {
            observe(index);
            commanded(index)
        })
    }

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

    fn each(&mut self, slots: &mut [Scratch], length: usize, work: impl Fn(usize, &mut [Scratch]) + Sync) {
        let length = length.max(1);
        for (k, piece) in slots.chunks_mut(length).enumerate() {
            work(k.saturating_mul(length), piece);
        }
    }
}
