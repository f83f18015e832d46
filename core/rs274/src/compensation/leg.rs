//! One programmed move in the plane, seen from the side on which the cutter runs.

use super::CompensationError;
use super::unit::{Fine, Unit, fine, length};
use truepath_units::Offset;
use truepath_units::geometry::{Point, Side, Vector};

/// Lines and arcs, before and after compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A straight line.
    Line,
    /// An arc.
    Arc {
        /// Its centre.
        centre: Point,
        /// Counter-clockwise in the plane.
        counter_clockwise: bool,
        /// Full turns beyond the arc between its ends; equal ends without extra turns are one full circle.
        turns: u32,
    },
}

/// A piece of path in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// What lies between.
    pub shape: Shape,
}

/// The cutter beside its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cutter {
    /// The side of travel on which the cutter runs: left for G41.
    pub side: Side,
    /// Its radius, above 0 and at most 100 m.
    pub radius: Offset,
}

impl Cutter {
    /// The cutter's distance along the left of the path: positive for G41.
    pub(super) fn leftwards(self) -> Fine {
        match self.side {
            Side::Left => fine(self.radius),
            Side::Right => fine(-self.radius),
        }
    }
}

/// A full circle about a centre, in coordinates relative to a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Circle {
    /// From the corner to the centre.
    pub(super) centre: Vector,
    /// Its radius.
    pub(super) radius: Fine,
}

impl Piece {
    /// The direction of travel at its start; `None` when it has no length or no radius.
    pub(super) fn start_heading(&self) -> Option<Unit> {
        self.heading(self.from)
    }

    /// The direction of travel at its end.
    pub(super) fn end_heading(&self) -> Option<Unit> {
        self.heading(self.to)
    }

    fn heading(&self, place: Point) -> Option<Unit> {
        match self.shape {
            Shape::Line => Unit::of(self.to.from(self.from)),
            Shape::Arc { centre, counter_clockwise, .. } => {
                let left = Unit::of(place.from(centre))?.left();
                Some(if counter_clockwise { left } else { left.reversed() })
            }
        }
    }

    /// The circle on which the cutter's centre runs, seen from `corner`, one of the ends; `None` for a line.
    ///
    /// # Errors
    /// The cutter does not fit into the arc.
    pub(super) fn circle(&self, corner: Point, cutter: Cutter) -> Result<Option<Circle>, CompensationError> {
        let Shape::Arc { centre, counter_clockwise, .. } = self.shape else {
            return Ok(None);
        };
        // Left of a counter-clockwise arc lies its centre.
        let inwards = if counter_clockwise { cutter.leftwards() } else { cutter.leftwards().saturating_neg() };
        let programmed = length(corner.from(centre));
        let radius = programmed.saturating_sub(inwards);
        if radius <= 0 {
            let arc = corner.distance(centre);
            return Err(CompensationError::ArcTooSmall { arc, radius: cutter.radius });
        }
        Ok(Some(Circle { centre: centre.from(corner), radius }))
    }

    /// Whether the centre of an arc lies on the other side than the cutter; `None` for a line.
    pub(super) fn bends_away(&self, cutter: Cutter) -> Option<bool> {
        match self.shape {
            Shape::Line => None,
            Shape::Arc { counter_clockwise, .. } => Some(counter_clockwise != (cutter.side == Side::Left)),
        }
    }

    /// Where the cutter's centre is beside the end.
    pub(super) fn beside_end(&self, cutter: Cutter) -> Option<Point> {
        Some(self.end_heading()?.step(self.to, 0, cutter.leftwards()))
    }

    /// Where the cutter's centre is beside the start.
    pub(super) fn beside_start(&self, cutter: Cutter) -> Option<Point> {
        Some(self.start_heading()?.step(self.from, 0, cutter.leftwards()))
    }
}
