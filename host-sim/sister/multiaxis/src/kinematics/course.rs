//! The way of one point of the tool, in the part's frame, while all five joints move linearly (T eqs 1–2).

use super::super::machine::{Joints, Machine};
use super::super::vector::{Vector, add, add_scaled, norm, sub};
use super::UPRIGHT;
use super::bounds::{Bounds, Region};
use super::chain::{Chain, Jet, Link};

/// A point of the tool, or its axis, over a linear move of the joints; the parameter runs from 0 to 1.
#[derive(Clone, Debug)]
pub struct Course {
    links: [Link; 2],
    /// How many of the links are on the head; they act before the linear axes.
    heads: usize,
    start: Vector,
    from: Joints,
    linear: Vector,
    rates: [f64; 2],
    bounds: Bounds,
    size: f64,
}

impl Course {
    /// The way of the point that counts.
    pub fn of_point(machine: &Machine, from: &Joints, to: &Joints) -> Self {
        Self::at_height(machine, from, to, machine.counted_height_mm())
    }

    /// The way of the point `height_mm` above the tip on the tool axis.
    pub fn at_height(machine: &Machine, from: &Joints, to: &Joints, height_mm: f64) -> Self {
        Self::build(machine.chain(), [0.0, 0.0, height_mm], *from, to)
    }

    /// The way of the tool axis' unit vector: the same turns about the origin, without the linear axes.
    pub fn of_axis(machine: &Machine, from: &Joints, to: &Joints) -> Self {
        let chain = machine.chain();
        let chain = Chain { links: chain.links.map(|link| Link { point: [0.0; 3], ..link }), ..chain };
        let (from, to) = (Joints { xyz: [0.0; 3], ..*from }, Joints { xyz: [0.0; 3], ..*to });
        Self::build(chain, UPRIGHT, from, &to)
    }

    fn build(chain: Chain, start: Vector, from: Joints, to: &Joints) -> Self {
        let rates = [to.rotary[0] - from.rotary[0], to.rotary[1] - from.rotary[1]];
        let Chain { links, heads } = chain;
        let mut region = Region::point(start);
        for (i, link) in links.iter().enumerate() {
            if i == heads {
                region = region.carried(from.xyz, to.xyz);
            }
            region = region.turned(link, rates);
        }
        if heads == links.len() {
            region = region.carried(from.xyz, to.xyz);
        }
        let size = region.ends.iter().map(|end| norm(*end)).fold(region.radius, f64::max);
        Self { links, heads, start, from, linear: sub(to.xyz, from.xyz), rates, bounds: region.bounds, size }
    }

    /// Place and derivatives at the parameter `t`.
    pub fn jet(&self, t: f64) -> Jet {
        let sin_cos = [0, 1].map(|i| (self.from.rotary[i] + self.rates[i] * t).sin_cos());
        let mut jet = Jet { place: self.start, first: [0.0; 3], second: [0.0; 3] };
        for (i, link) in self.links.iter().enumerate() {
            if i == self.heads {
                jet = self.carried(&jet, t);
            }
            jet = link.moved_jet(&jet, sin_cos, self.rates);
        }
        if self.heads == self.links.len() { self.carried(&jet, t) } else { jet }
    }

    /// Place at the parameter `t`.
    pub fn place(&self, t: f64) -> Vector {
        self.jet(t).place
    }

    /// Bounds on the derivatives, for every parameter of the move.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Rounding error of a place in `f64`, mm: some tens of operations on numbers of the size of the machine.
    pub fn rounding(&self) -> f64 {
        64.0 * f64::EPSILON * (self.size + norm(self.from.xyz) + self.bounds.first)
    }

    fn carried(&self, jet: &Jet, t: f64) -> Jet {
        let travel = add_scaled(self.from.xyz, self.linear, t);
        Jet { place: add(jet.place, travel), first: add(jet.first, self.linear), second: jet.second }
    }
}
