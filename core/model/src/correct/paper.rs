//! The law of P23 as printed, kept to compare with.
//!
//! Eqs. (8)–(9): `MS = δ/(x_c − δ)` at the probed place, with x_c the *absolute* coordinate of the trajectory;
//! eqs. (10)–(11): scaled along the path by the ratio of chip areas; eq. (12): `x_cc = (MS·k + 1)·x_c`. The result
//! depends on where the origin of the program is, and the direction of the force is not turned through the corner.

use super::node::Node;
use crate::cut::{Loop, State};
use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, Real, sin_cos};

/// MS of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaperRatio {
    /// δ/(x_c − δ) at the probed place.
    pub ms: Real,
    /// 1 − cos φ₁ at the probed place, the chip area up to a factor.
    pub area: Real,
}

/// The transfer function of both axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaperTransfer {
    /// Along x.
    pub x: PaperRatio,
    /// Along y.
    pub y: PaperRatio,
}

impl PaperRatio {
    /// From the commanded coordinate, the wall's displacement along this axis (actual − nominal) and the
    /// engagement at the probed place.
    pub fn new(commanded: Offset, displacement: Offset, engaged: Real) -> Self {
        let delta = -displacement;
        Self { ms: delta.over(commanded - delta), area: area(engaged) }
    }

    fn shift(&self, coordinate: Offset, engaged: Real) -> Offset {
        if self.area == Real::ZERO {
            return Offset::ZERO;
        }
        coordinate.scaled(self.ms * (area(engaged) / self.area))
    }
}

impl PaperTransfer {
    /// Fills the nodes of the contour by eq. (12), with the chip area of the simulated pass.
    pub fn fill(&self, machine: &Loop, uncorrected: &[State], nodes: &mut [Node]) {
        let path = machine.path;
        let skipped = path.first().saturating_sub(path.working().start);
        let samples = path.samples().iter().skip(path.first());
        for ((node, state), sample) in nodes.iter_mut().zip(uncorrected.iter().skip(skipped)).zip(samples) {
            let absolute = sample.point.from(Point::from_nm(0, 0));
            node.chip =
                Vector { x: self.x.shift(absolute.x, state.engaged), y: self.y.shift(absolute.y, state.engaged) };
            node.edge = Vector::ZERO;
        }
    }
}

fn area(engaged: Real) -> Real {
    let (_, cosine) = sin_cos(engaged);
    Real::ONE - cosine
}
