//! Who runs the cutter and reads the walls of a design: one sample and one height after the other, or several at once.
//!
//! A design reads the wall at thirteen heights on every pass of the cutter, and most of its time goes there. The heights do
//! not depend on each other, so whoever has more than one processor may read them at the same time; the core has one.

use super::profile::{Band, Profile, profile};
use super::scratch::Scratch;
use crate::cut::{Loop, Passage, State};
use truepath_units::geometry::Vector;

/// What is known before a pass of the cutter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Again {
    /// Nothing: buffers hold what is left of something else.
    Afresh,
    /// States and walls of the pass before, by the same machine for the same design: what a command does not change is kept.
    AsBefore,
}

/// Runs the cutter to the last bit as [`Loop::run`] does, and reads the profile of the walls off its states as [`profile`] does.
pub trait WallReader {
    /// As [`Loop::run_on`] from rest; `seen` is told the samples in their order, and whether their state may have changed.
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        again: Again,
        commanded: impl Fn(usize) -> Vector + Sync,
        seen: &mut dyn FnMut(usize, bool),
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

impl Again {
    /// What was so in the pass before, if that is known.
    pub fn knows<T>(self, before: T) -> Option<T> {
        (self == Self::AsBefore).then_some(before)
    }
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
        again: Again,
        commanded: impl Fn(usize) -> Vector + Sync,
        seen: &mut dyn FnMut(usize, bool),
    ) -> Passage {
        (**self).run(machine, from, states, again, commanded, seen)
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
        again: Again,
        commanded: impl Fn(usize) -> Vector + Sync,
        seen: &mut dyn FnMut(usize, bool),
    ) -> Passage {
        let before = again.knows(Vector::ZERO);
        let mut guess = Vector::ZERO;
        machine.run_on(from, (&mut guess, before), states, commanded, seen)
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
