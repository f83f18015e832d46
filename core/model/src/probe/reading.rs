//! What one line of a measurement file says, and where lines are collected.

use super::error::{ProbeError, ProbeErrorKind};
use truepath_rs274::Line;
use truepath_units::geometry::{Direction, Point, Vector};
use truepath_units::{Offset, Position, Real};

/// How a probe move ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The probe touched.
    #[default]
    Touched,
    /// It did not; the position is the end of the move, or the nominal one.
    Missed,
    /// It touched, and the next reading is the slow touch of the same place.
    Superseded,
}

/// One point of a file: where the probe was when it touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// X, Y, Z in work coordinates.
    pub position: [Position; 3],
    /// Distance from there to the wall along its normal: the ball's radius for a centre, zero for a surface point.
    pub radius: Offset,
    /// How the move ended.
    pub outcome: Outcome,
    /// Normal of the nominal wall, from the wall to the free side, where the file gives it.
    pub normal: Option<Direction>,
    /// Line, counted from 1.
    pub line: u32,
}

impl Reading {
    /// Its place in the plane.
    pub const fn place(&self) -> Point {
        let [x, y, _] = self.position;
        Point { x, y }
    }
}

/// Readings on their way into the lent buffer.
pub(super) struct Sink<'a> {
    readings: &'a mut [Reading],
    count: usize,
}

impl<'a> Sink<'a> {
    pub(super) const fn new(readings: &'a mut [Reading]) -> Self {
        Self { readings, count: 0 }
    }

    pub(super) const fn count(&self) -> usize {
        self.count
    }

    pub(super) fn push(&mut self, reading: Reading, line: &Line) -> Result<(), ProbeError> {
        let limit = self.readings.len();
        let slot = self.readings.get_mut(self.count);
        *slot.ok_or_else(|| ProbeError::of_line(ProbeErrorKind::TooManyPoints { limit }, line))? = reading;
        self.count = self.count.saturating_add(1);
        Ok(())
    }

    pub(super) fn last(&mut self) -> Option<&mut Reading> {
        self.count.checked_sub(1).and_then(|at| self.readings.get_mut(at))
    }
}

/// A normal from its components; `None` unless its length is 1 within a tenth.
pub(super) fn unit_normal(x: Real, y: Real) -> Option<Direction> {
    let limit = Real::from_int(2);
    let square = if x.abs() < limit && y.abs() < limit { Real::dot(x, x, y, y) } else { Real::ZERO };
    let unit = Real::ratio(81, 100) <= square && square <= Real::ratio(121, 100);
    Vector::from_nm(x.bits(), y.bits()).direction().filter(|_| unit)
}
