//! Bounds on the derivatives of the tool's way over a whole move, from lengths and rates alone.
//!
//! If `|p⁽ᵏ⁾| ≤ Bₖ` and the arm `p − c` stands off the axis by at most `d`, one turn at the rate Ω gives
//! `B₁ + Ωd`, `B₂ + 2ΩB₁ + Ω²d`, `B₃ + 3ΩB₂ + 3Ω²B₁ + Ω³d` (Leibniz, and |e×v| ≤ |v|). They hold for every parameter
//! of the move, so what is built on them is a proof and not a sample.

use super::super::machine::Letter;
use super::super::vector::{Vector, add, norm, sub};
use super::chain::Link;

/// Largest lengths of the first, second and third derivative by the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Of the first, mm.
    pub first: f64,
    /// Of the second, mm.
    pub second: f64,
    /// Of the third, mm.
    pub third: f64,
}

/// Where a point can be: on a segment, or within `radius` of it; and how fast it can move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) ends: [Vector; 2],
    pub(super) radius: f64,
    pub(super) bounds: Bounds,
}

impl Region {
    /// A point that stands.
    pub(super) fn point(p: Vector) -> Self {
        Self { ends: [p, p], radius: 0.0, bounds: Bounds::default() }
    }
    /// The sum with a point that runs along a segment.
    pub(super) fn carried(self, from: Vector, to: Vector) -> Self {
        let first = self.bounds.first + norm(sub(to, from));
        Self { ends: [add(self.ends[0], from), add(self.ends[1], to)], bounds: Bounds { first, ..self.bounds }, ..self }
    }
    /// After a turn about a line at a rate.
    pub(super) fn turned(self, link: &Link, rates: [f64; 2]) -> Self {
        let rate = rates[link.axis].abs();
        let arms = self.ends.map(|end| sub(end, link.point));
        let longest = |f: &dyn Fn(Vector) -> f64| f(arms[0]).max(f(arms[1])) + self.radius;
        let off_axis = longest(&|arm| off(link.letter, arm));
        let Bounds { first, second, third } = self.bounds;
        let bounds = Bounds {
            first: first + rate * off_axis,
            second: second + rate * (2.0 * first + rate * off_axis),
            third: third + rate * (3.0 * second + rate * (3.0 * first + rate * off_axis)),
        };
        Self { ends: [link.point; 2], radius: longest(&norm), bounds }
    }
}

/// Distance of the end of an arm from the axis it starts on. The arm is not changed in place: optimised by rustc 1.95 that
/// reached the caller's own arms through the closure above, and every bound came out too small.
fn off(letter: Letter, arm: Vector) -> f64 {
    norm(std::array::from_fn(|i| if i == letter.index() { 0.0 } else { arm[i] }))
}
