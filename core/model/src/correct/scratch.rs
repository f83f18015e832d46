//! A slot beside each sample of the contour for what is needed there only for a while.
//!
//! A design keeps its best correction there. Between two designs that is of no use, and the slots hold what is computed
//! about the wall, one thing at a time: one slot for all keeps the memory of a device small.

use super::node::Node;
use truepath_units::Offset;
use truepath_units::geometry::Vector;

/// The slot: four lengths, which are one of the things below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scratch([Offset; 4]);

/// Standard deviations of a wall.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Deviation {
    /// Of the error that the target aims at.
    pub aimed: Offset,
    /// Of the deepest height.
    pub deepest: Offset,
    /// Whether they are computed here, and not interpolated.
    pub is_asked: bool,
}

/// What the largest error must outweigh for a whole correction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    /// So many standard deviations, here or a little less from a neighbour.
    pub outweighed: Offset,
    /// The standard deviation of the wall here.
    pub sigma: Offset,
}

impl From<Node> for Scratch {
    fn from(best: Node) -> Self {
        Self([best.chip.x, best.chip.y, best.edge.x, best.edge.y])
    }
}

impl From<Scratch> for Node {
    fn from(Scratch([x, y, edge_x, edge_y]): Scratch) -> Self {
        Self { chip: Vector { x, y }, edge: Vector { x: edge_x, y: edge_y } }
    }
}

impl From<Deviation> for Scratch {
    fn from(wall: Deviation) -> Self {
        Self([wall.aimed, wall.deepest, Offset::from_nm(wall.is_asked.into()), Offset::ZERO])
    }
}

impl From<Doubt> for Scratch {
    fn from(doubt: Doubt) -> Self {
        Self([doubt.outweighed, doubt.sigma, Offset::ZERO, Offset::ZERO])
    }
}

impl Scratch {
    /// A slot that holds a [`Deviation`].
    pub(super) fn deviation(self) -> Deviation {
        let Self([aimed, deepest, asked, _]) = self;
        Deviation { aimed, deepest, is_asked: asked.nm() != 0 }
    }

    /// A slot that holds a [`Doubt`].
    pub(super) const fn doubt(self) -> Doubt {
        let Self([outweighed, sigma, ..]) = self;
        Doubt { outweighed, sigma }
    }

    /// A slot that holds one length.
    pub(super) const fn length(&mut self) -> &mut Offset {
        let Self([length, ..]) = self;
        length
    }

    /// Raises the length of every slot, from one end to the other and back, so that it falls by no more than `slope` from
    /// one to the next; where they close on themselves, twice.
    pub(super) fn envelope(slots: &mut [Self], slope: Offset, closed: bool) {
        let carry = |carried: Offset, slot: &mut Self| {
            let length = slot.length();
            *length = (*length).max(carried - slope);
            *length
        };
        let (mut ahead, mut back) = (Offset::ZERO, Offset::ZERO);
        for _ in 0..=usize::from(closed) {
            ahead = slots.iter_mut().fold(ahead, carry);
            back = slots.iter_mut().rev().fold(back, carry);
        }
    }
}
