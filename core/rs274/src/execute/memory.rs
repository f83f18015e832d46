//! What codes remember from block to block: splines, cycles, saved modes, changed tools.

use super::super::{Axes, FeedMode, GCode, Modal, Number, PathControl, Plane, RetractLevel, Spindle, Units};
use super::spline::{ControlPoint, POINTS};
use truepath_units::Real;
use truepath_units::geometry::Vector;

/// Rows of the tool table that a program may change with G10.
pub(super) const CHANGED_TOOLS: usize = 8;

/// The spline that is open, and where the last one led.
#[derive(Debug, Default)]
pub(super) struct SplineMemory {
    /// The second control point of the next G5 when it gives none: against (P, Q) of the last.
    pub(super) tangent: Option<Vector>,
    /// The order of the spline that G5.2 has begun, its start, and its control points from there.
    pub(super) order: usize,
    pub(super) start: Axes,
    pub(super) points: heapless::Vec<ControlPoint, POINTS>,
}

impl SplineMemory {
    /// Whether G5.2 has begun a spline that is not ended.
    pub(super) fn is_open(&self) -> bool {
        !self.points.is_empty()
    }

    /// A move that is no spline comes.
    pub(super) fn interrupted(&mut self) {
        self.tangent = None;
        self.points.clear();
    }
}

/// The words that stay from hole to hole.
#[derive(Clone, Copy, Debug)]
pub(super) struct CycleMemory {
    pub(super) code: GCode,
    pub(super) clearance: i64,
    pub(super) depth: i64,
    pub(super) peck: Option<i64>,
    pub(super) dwell: Option<Number>,
    pub(super) aside: [Option<i64>; 3],
}

/// Levels of calls, the main program included.
pub(super) const LEVELS: usize = 11;

/// The modes that M72 brings back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SavedModes {
    pub(super) units: Units,
    pub(super) plane: Plane,
    pub(super) absolute: bool,
    pub(super) absolute_centres: bool,
    pub(super) feed_mode: FeedMode,
    pub(super) retract: RetractLevel,
    pub(super) path: Option<PathControl>,
    pub(super) feed: Option<Real>,
    pub(super) speed: Option<Real>,
    pub(super) spindle: Spindle,
    pub(super) work_offset: u16,
    pub(super) length_offset: bool,
    /// M73: restored when the level returns.
    pub(super) on_return: bool,
}

impl SavedModes {
    pub(super) const fn of(modal: &Modal, on_return: bool) -> Self {
        Self {
            units: modal.units,
            plane: modal.plane,
            absolute: modal.absolute,
            absolute_centres: modal.absolute_centres,
            feed_mode: modal.feed_mode,
            retract: modal.retract,
            path: modal.path,
            feed: modal.feed,
            speed: modal.speed,
            spindle: modal.spindle,
            work_offset: modal.work_offset,
            length_offset: modal.length_offset,
            on_return,
        }
    }
}
