//! Where the axes stand, as far as the program has said it.

use truepath_units::Position;
use truepath_units::geometry::Point;

/// Positions of the axes in program coordinates; `None` where the program has not said it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axes {
    /// X.
    pub x: Option<Position>,
    /// Y.
    pub y: Option<Position>,
    /// Z.
    pub z: Option<Position>,
}

impl Axes {
    /// All at the origin.
    pub const ORIGIN: Self = Self { x: Some(Position::ZERO), y: Some(Position::ZERO), z: Some(Position::ZERO) };
    /// None known.
    pub const UNKNOWN: Self = Self { x: None, y: None, z: None };

    /// The place in the plane, when both coordinates are known.
    pub fn point(self) -> Option<Point> {
        Some(Point { x: self.x?, y: self.y? })
    }

    /// An axis by number: X 0, Y 1, Z 2.
    pub const fn get(self, axis: usize) -> Option<Position> {
        match axis {
            0 => self.x,
            1 => self.y,
            2 => self.z,
            _ => None,
        }
    }

    /// Sets an axis by number; one that does not exist is left out.
    pub const fn set(&mut self, axis: usize, to: Option<Position>) {
        match axis {
            0 => self.x = to,
            1 => self.y = to,
            2 => self.z = to,
            _ => {}
        }
    }
}
