//! The moves of a program, each with the line it is written on and the modes around it.

use truepath_core::gcode::{Axes, Canon, GcodeError, HostMemory, Interpreter, Modal, Motion, Options};
use truepath_core::geometry::Curve;

/// One move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    /// Line, counted from 1.
    pub(super) line: u32,
    pub(super) kind: Kind,
    pub(super) from: Axes,
    pub(super) to: Axes,
    /// The modes in force while it moves.
    pub(super) modal: Modal,
    /// The motion in force before its block.
    pub(super) motion_before: Option<Motion>,
}

/// What kind of move.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Traverse,
    Feed,
    Arc(Curve),
    /// To a place in machine coordinates (G53).
    Machine,
    /// To a reference point (G28, G30).
    Reference,
}

impl Move {
    /// Whether its start and end are one point of the plane, both known.
    pub(super) fn stands_still(&self) -> bool {
        self.from.point().is_some()
            && self.from.point() == self.to.point()
            && matches!(self.kind, Kind::Traverse | Kind::Feed)
    }
    /// Whether it cuts in the plane.
    pub(super) fn cuts(&self) -> bool {
        matches!(self.kind, Kind::Feed | Kind::Arc(_)) && !self.stands_still()
    }
    /// The line or arc it cuts along; `None` when it does not cut, or from an unknown place.
    pub(super) fn curve(&self) -> Option<Curve> {
        match self.kind {
            Kind::Arc(curve) => Some(curve),
            Kind::Feed => Curve::line(self.from.point()?, self.to.point()?),
            Kind::Traverse | Kind::Machine | Kind::Reference => None,
        }
    }
}

/// All moves of a program.
pub(super) fn survey(program: &[u8], options: Options) -> Result<Vec<Move>, GcodeError> {
    let mut moves = Vec::new();
    let mut motion_before = None;
    let mut line = (0, None);
    let mut memory = Box::new(HostMemory::new());
    Interpreter::new(options).run(program, &mut memory.lend(), &mut |event| {
        if event.source.line != line.0 {
            line = (event.source.line, motion_before);
        }
        motion_before = event.modal.motion;
        let unknown = Axes::UNKNOWN;
        let (kind, from, to) = match event.canon {
            Canon::Traverse { from, to } => (Kind::Traverse, from, to),
            Canon::Feed { from, to } => (Kind::Feed, from, to),
            Canon::Arc { from, to, curve, .. } => (Kind::Arc(curve), from, to),
            Canon::MachineMove { .. } => (Kind::Machine, unknown, unknown),
            Canon::Reference { .. } => (Kind::Reference, unknown, unknown),
            _ => return Ok(()),
        };
        moves.push(Move { line: event.source.line, kind, from, to, modal: *event.modal, motion_before: line.1 });
        Ok(())
    })?;
    Ok(moves)
}
