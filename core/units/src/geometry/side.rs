//! The side of travel on which something lies.

use super::Direction;

/// On which side of travel the finished wall lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// On the left of travel.
    Left,
    /// On the right of travel.
    Right,
}

impl Side {
    /// The other side.
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
    /// The normal towards the wall for a direction of travel.
    pub fn normal(self, heading: Direction) -> Direction {
        match self {
            Self::Left => heading.left(),
            Self::Right => heading.right(),
        }
    }
    /// The direction of travel for a normal towards the wall.
    pub fn heading(self, normal: Direction) -> Direction {
        match self {
            Self::Left => normal.right(),
            Self::Right => normal.left(),
        }
    }
}
