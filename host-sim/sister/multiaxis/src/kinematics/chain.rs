//! One link of the chain from tool to part: a turn about a line, applied to points and to their derivatives.
//!
//! With `q = c + R(φ)(p − c)`, `φ` linear in the parameter, `Ω = φ′` and `e` the axis, the derivatives are those of a
//! vector seen from a turning frame:
//! `q′ = R(p′ + Ω e×(p−c))`, `q″ = R(p″ + 2Ω e×p′ + Ω² e×(e×(p−c)))`.

use super::super::machine::{Letter, Machine, Side};
use super::super::vector::{Vector, add, add_scaled, cross, sub};

/// A point and its first two derivatives by the parameter of the move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Place, mm.
    pub place: Vector,
    /// First derivative, mm.
    pub first: Vector,
    /// Second derivative, mm.
    pub second: Vector,
}

/// A turn about a line: by `sign · rotary[axis]` about the direction of `letter` through `point`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) axis: usize,
    pub(super) letter: Letter,
    pub(super) point: Vector,
    pub(super) sign: f64,
}

/// The two links in the order in which they act on a point of the tool: the head's from the tool outwards, then, after
/// the linear axes, the table's from the bed to the part, where the turn is undone.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Chain {
    pub(super) links: [Link; 2],
    pub(super) heads: usize,
}

impl Chain {
    pub(super) fn of(machine: &Machine) -> Self {
        let length = machine.tool().length_mm;
        let link = |i: usize| {
            let axis = machine.rotary()[i];
            match axis.side {
                Side::Head => Link::new(i, axis.letter, add(axis.point_mm, [0.0, 0.0, length]), axis.sense.sign()),
                Side::Table => Link::new(i, axis.letter, axis.point_mm, -axis.sense.sign()),
            }
        };
        let heads = machine.rotary().iter().filter(|axis| axis.side == Side::Head).count();
        // The carried axis of a head is nearer to the tool, that of a table nearer to the part.
        let links = if heads == 0 { [link(0), link(1)] } else { [link(1), link(0)] };
        Self { links, heads }
    }
    pub(super) fn head(&self) -> &[Link] {
        &self.links[..self.heads]
    }
    pub(super) fn table(&self) -> &[Link] {
        &self.links[self.heads..]
    }
}

impl Link {
    pub(super) const fn new(axis: usize, letter: Letter, point: Vector, sign: f64) -> Self {
        Self { axis, letter, point, sign }
    }

    /// A direction, turned.
    pub(super) fn turned(&self, v: Vector, rotary: [f64; 2]) -> Vector {
        turn(self.letter, v, (self.sign * rotary[self.axis]).sin_cos())
    }
    /// A point, turned about the line.
    pub(super) fn moved(&self, p: Vector, rotary: [f64; 2]) -> Vector {
        add(self.point, self.turned(sub(p, self.point), rotary))
    }
    /// A point, turned back about the line.
    pub(super) fn undone(&self, p: Vector, rotary: [f64; 2]) -> Vector {
        self.moved(p, rotary.map(|angle| -angle))
    }
    /// A moving point, turned about the line while the rotary words change at `rates` per unit of the parameter.
    pub(super) fn moved_jet(&self, jet: &Jet, sin_cos: [(f64, f64); 2], rates: [f64; 2]) -> Jet {
        let (sin, cos) = sin_cos[self.axis];
        let sin_cos = (self.sign * sin, cos);
        let rate = self.sign * rates[self.axis];
        let e = self.letter.direction();
        let arm = sub(jet.place, self.point);
        let swept = cross(e, arm);
        let first = add_scaled(jet.first, swept, rate);
        let second = add_scaled(jet.second, cross(e, jet.first), 2.0 * rate);
        let second = add_scaled(second, cross(e, swept), rate * rate);
        Jet {
            place: add(self.point, turn(self.letter, arm, sin_cos)),
            first: turn(self.letter, first, sin_cos),
            second: turn(self.letter, second, sin_cos),
        }
    }
}

/// A vector turned right-handedly about an axis of coordinates.
fn turn(letter: Letter, v: Vector, (sin, cos): (f64, f64)) -> Vector {
    let [x, y, z] = v;
    match letter {
        Letter::A => [x, cos * y - sin * z, sin * y + cos * z],
        Letter::B => [cos * x + sin * z, y, cos * z - sin * x],
        Letter::C => [cos * x - sin * y, sin * x + cos * y, z],
    }
}
