//! Forward and inverse kinematics of a [`Machine`], and the way of the tool during one linear move of the joints.
//!
//! The equations are in the description of [`super::machine`]. `inverse` needs no iteration: with the rotary words
//! given, the table turns the tip into the machine's frame and the head's own displacement is taken off.

mod bounds;
mod chain;
mod course;
mod orientation;

use chain::Chain;

use super::machine::{Joints, Machine};
use super::vector::{Vector, add, sub};

pub use bounds::Bounds;
pub use chain::Jet;
pub use course::Course;
pub use orientation::Branch;

/// Where the tool is in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Its tip, mm.
    pub tip: Vector,
    /// Unit vector of its axis, from the tip towards the spindle.
    pub axis: Vector,
}

/// A tool that stands upright.
const UPRIGHT: Vector = [0.0, 0.0, 1.0];

impl Machine {
    /// Where the tool is.
    pub fn forward(&self, joints: &Joints) -> Pose {
        Pose { tip: self.place(joints, 0.0), axis: self.axis(joints.rotary) }
    }

    /// The point of the tool that counts: its tip, or the centre of its ball.
    pub fn counted(&self, joints: &Joints) -> Vector {
        self.place(joints, self.counted_height_mm())
    }

    /// The tool axis at the given rotary words: unit vector from the tip towards the spindle, in the part's frame.
    pub fn axis(&self, rotary: [f64; 2]) -> Vector {
        self.chain().links.iter().fold(UPRIGHT, |v, link| link.turned(v, rotary))
    }

    /// The joints that put the tip there with these rotary words.
    pub fn inverse(&self, tip: Vector, rotary: [f64; 2]) -> Joints {
        self.inverse_at(tip, rotary, 0.0)
    }

    /// The joints that put the counted point there with these rotary words.
    pub fn inverse_counted(&self, point: Vector, rotary: [f64; 2]) -> Joints {
        self.inverse_at(point, rotary, self.counted_height_mm())
    }

    fn inverse_at(&self, point: Vector, rotary: [f64; 2], height: f64) -> Joints {
        let chain = self.chain();
        let hang = chain.head().iter().fold([0.0, 0.0, height], |p, link| link.moved(p, rotary));
        let seated = chain.table().iter().rev().fold(point, |p, link| link.undone(p, rotary));
        Joints { xyz: sub(seated, hang), rotary }
    }

    fn place(&self, joints: &Joints, height: f64) -> Vector {
        let (chain, rotary) = (self.chain(), joints.rotary);
        let hang = chain.head().iter().fold([0.0, 0.0, height], |p, link| link.moved(p, rotary));
        chain.table().iter().fold(add(joints.xyz, hang), |p, link| link.moved(p, rotary))
    }

    /// The turns from the tool to the part.
    pub(super) fn chain(&self) -> Chain {
        Chain::of(self)
    }
}
