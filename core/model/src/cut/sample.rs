//! One sample of the path, with the stock beside it.

use truepath_units::geometry::{Direction, Point};
use truepath_units::{Offset, Real};

/// One sample of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Arc length from the start of the contour; negative before it.
    pub s: Offset,
    /// Nominal cutter centre.
    pub point: Point,
    /// Normal towards the wall.
    pub normal: Direction,
    /// Raw stock surface beside it.
    pub stock: Point,
    /// Programmed feed, mm/min.
    pub feed: Real,
    /// Index of the block.
    pub block: u32,
    /// Whether `stock` is part of the surface; at a sharp outside corner the parallel curve crosses itself.
    pub on_surface: bool,
    /// Whether a wall stands beside it; at a sharp outside corner the rest of the path cuts it away.
    pub on_wall: bool,
    /// Whether it only leads round an outside corner and makes no wall: the correction turns there from that of one leg to
    /// that of the other. Never where a wall stands.
    pub rounds_corner: bool,
    /// Whether it lies so near to a sharp inside corner that the load changes faster than a machine can follow.
    pub near_corner: bool,
}

impl Sample {
    /// What a lent buffer is filled with before a path is sampled into it.
    pub const BLANK: Self = Self {
        s: Offset::ZERO,
        point: Point::from_nm(0, 0),
        normal: Direction::X,
        stock: Point::from_nm(0, 0),
        feed: Real::ZERO,
        block: 0,
        on_surface: true,
        on_wall: true,
        rounds_corner: false,
        near_corner: false,
    };

    /// Whether it is on an ordinary wall: one that stands, away from sharp inside corners.
    pub(super) const fn is_plain(&self) -> bool {
        self.on_wall && !self.near_corner
    }
}
