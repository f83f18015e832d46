//! A move to be divided, with its chord: joints at a parameter of the chord, and the proof for a part of it.

use super::super::Machine;
use super::super::chord::{chord_error, within};
use super::super::machine::Joints;
use super::super::vector::{Vector, add_scaled, sub};

/// A move and its chord.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<'m> {
    machine: &'m Machine,
    from: Joints,
    to: Joints,
    start: Vector,
    chord: Vector,
    tolerance_mm: f64,
}

impl<'m> Span<'m> {
    pub(super) fn new(machine: &'m Machine, from: &Joints, to: &Joints, tolerance_mm: f64) -> Self {
        let start = machine.counted(from);
        let chord = sub(machine.counted(to), start);
        Self { machine, from: *from, to: *to, start, chord, tolerance_mm }
    }

    /// The tolerance, mm.
    pub(super) fn tolerance_mm(&self) -> f64 {
        self.tolerance_mm
    }

    /// The joints at the parameter `s`: counted point on the chord, rotary words linear.
    pub(super) fn joints(&self, s: f64) -> Joints {
        if s <= 0.0 {
            return self.from;
        }
        if s >= 1.0 {
            return self.to;
        }
        self.place(s, self.from.towards(&self.to, s).rotary)
    }

    /// The joints that put the counted point on the chord at `s` with other rotary words.
    pub(super) fn place(&self, s: f64, rotary: [f64; 2]) -> Joints {
        self.machine.inverse_counted(add_scaled(self.start, self.chord, s), rotary)
    }

    /// Whether the piece between two parameters is proved to keep within the tolerance.
    pub(super) fn fits(&self, a: f64, b: f64) -> bool {
        within(self.machine, &self.joints(a), &self.joints(b), self.tolerance_mm)
    }

    /// Largest chord error of a piece, certified, mm.
    pub(super) fn error(&self, a: f64, b: f64) -> f64 {
        chord_error(self.machine, &self.joints(a), &self.joints(b)).bound
    }
}
