//! What is left of a move between the places where the cutter's path begins and ends it.

use super::CompensationError;
use super::leg::{Cutter, Piece, Shape};
use super::unit::{Unit, fine};
use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, Real};

/// How much farther round the cutter's path beside an arc may go than the arc itself, where it joins a neighbour that
/// is not quite tangent: 0.0254 rad, as observed of LinuxCNC 2.9.
const LONGER_SWEEP: Real = Real::ratio(254, 10_000);

/// What counts as nothing: two roundings.
const NOTHING: Offset = Offset::from_nm(2);

/// The shape of the cutter's path beside `programmed` from `from` to `to`.
///
/// # Errors
/// It would run backwards, or be distorted.
pub(super) fn remaining(
    programmed: &Piece,
    from: Point,
    to: Point,
    cutter: Cutter,
) -> Result<Shape, CompensationError> {
    match programmed.shape {
        Shape::Line => {
            let way = programmed.to.from(programmed.from);
            let left = Unit::of(way).map_or(0, |d| d.along(to.from(from)));
            if left < fine(-NOTHING) {
                return Err(CompensationError::MoveUnreachable { length: way.length(), radius: cutter.radius });
            }
            Ok(Shape::Line)
        }
        Shape::Arc { centre, counter_clockwise, turns } => {
            let arc = Arc { programmed, centre, counter_clockwise, turns };
            arc.remaining(from, to, cutter)
        }
    }
}

struct Arc<'a> {
    programmed: &'a Piece,
    centre: Point,
    counter_clockwise: bool,
    turns: u32,
}

impl Arc<'_> {
    fn remaining(&self, from: Point, to: Point, cutter: Cutter) -> Result<Shape, CompensationError> {
        let old = [self.programmed.from, self.programmed.to].map(|p| p.from(self.centre));
        let new = [from, to].map(|p| p.from(self.centre));
        let programmed = self.sweep(old);
        let left = programmed - self.turn(old[0], new[0]) - self.turn(new[1], old[1]);
        let radius = new[0].length();
        if left > programmed + LONGER_SWEEP {
            return Err(CompensationError::ArcDistorted { arc: old[0].length(), radius: cutter.radius });
        }
        if self.turns == 0 && radius.scaled(left.abs()) <= NOTHING {
            return Ok(Shape::Line);
        }
        let turns = ((left - self.sweep(new)) / Real::TAU).round_to_int();
        let turns = i64::from(self.turns).saturating_add(turns);
        let Ok(turns) = u32::try_from(turns) else {
            let length = old[0].length().scaled(programmed);
            return Err(CompensationError::MoveUnreachable { length, radius: cutter.radius });
        };
        Ok(Shape::Arc { centre: self.centre, counter_clockwise: self.counter_clockwise, turns })
    }

    /// The angle from one spoke to another in the direction of travel, −π…π.
    fn turn(&self, from: Vector, to: Vector) -> Real {
        let (Some(from), Some(to)) = (from.direction(), to.direction()) else {
            return Real::ZERO;
        };
        let turn = from.angle_to(to);
        if self.counter_clockwise { turn } else { -turn }
    }

    /// The angle swept between two spokes without extra turns; equal ones are a full turn.
    fn sweep(&self, [from, to]: [Vector; 2]) -> Real {
        let turn = self.turn(from, to);
        if from == to || turn <= Real::ZERO { turn + Real::TAU } else { turn }
    }
}
