//! The moves of a program, each with the line it is written on and the modes around it.

use truepath_core::gcode::{Axes, Canon, Event, GcodeError, HostMemory, Interpreter, Modal, Motion, Options};
use truepath_core::geometry::Curve;

/// One move, or something else that decides where the next one begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    /// Line, counted from 1; 0 for a line of another file.
    pub(super) line: u32,
    /// Calls, returns and jumps before it: a line that comes again with another number is executed again.
    pub(super) jumps: u32,
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
    /// In the XY plane, and its full turns beside the arc itself.
    Arc(Curve, u32),
    /// Any other move along a path of its own: arcs in other planes, splines, probing, tapping.
    Special,
    /// To a place that the program does not know (G28, G30, G53): whether X and Y move.
    Away([bool; 2]),
    /// No move: the origin is set (G92, G52, G10).
    Origin,
}

impl Move {
    /// Whether it goes straight to a place of the program.
    pub(super) const fn is_straight(&self) -> bool {
        matches!(self.kind, Kind::Traverse | Kind::Feed)
    }
    /// Whether it belongs to a canned cycle: its line stands for several moves.
    pub(super) const fn in_cycle(&self) -> bool {
        matches!(self.modal.motion, Some(Motion::Cycle(_)))
    }
    /// Whether its start and end are one point of the plane, both known.
    pub(super) fn stands_still(&self) -> bool {
        self.is_straight() && self.from.point().is_some() && self.from.point() == self.to.point()
    }
    /// Whether it cuts in the plane.
    pub(super) fn cuts(&self) -> bool {
        matches!(self.kind, Kind::Feed | Kind::Arc(..)) && !self.stands_still()
    }
    /// The line or arc it cuts along; `None` when it does not cut, or from an unknown place.
    pub(super) fn curve(&self) -> Option<Curve> {
        match self.kind {
            Kind::Arc(curve, _) => Some(curve),
            Kind::Feed => Curve::line(self.from.point()?, self.to.point()?),
            _ => None,
        }
    }
}

/// All moves of a program.
pub(super) fn survey(program: &[u8], options: Options) -> Result<Vec<Move>, GcodeError> {
    let mut moves = Vec::new();
    let mut motion_before = None;
    let mut line = (0, None);
    let mut memory = Box::new(HostMemory::new());
    let mut sink = |event: &Event<'_>| {
        if event.source.line != line.0 {
            line = (event.source.line, motion_before);
        }
        motion_before = event.modal.motion;
        let unknown = Axes::UNKNOWN;
        let (kind, from, to) = match *event.canon {
            Canon::Traverse { from, to } => (Kind::Traverse, from, to),
            Canon::Feed { from, to } => (Kind::Feed, from, to),
            Canon::Arc { from, to, curve, turns, .. } => (Kind::Arc(curve, turns), from, to),
            Canon::PlaneArc { from, to, .. }
            | Canon::Spline { from, to, .. }
            | Canon::Probe { from, to, .. }
            | Canon::Tap { from, to } => (Kind::Special, from, to),
            Canon::MachineMove { to, .. } => (Kind::Away([to.x.is_some(), to.y.is_some()]), unknown, unknown),
            Canon::Reference { axes: [x, y, _], .. } => (Kind::Away([x, y]), unknown, unknown),
            Canon::Shift(_) => (Kind::Origin, unknown, unknown),
            _ => return Ok(()),
        };
        let source = event.source;
        let own_line = if source.file == 0 { source.line } else { 0 };
        moves.push(Move {
            line: own_line,
            jumps: source.jumps,
            kind,
            from,
            to,
            modal: *event.modal,
            motion_before: line.1,
        });
        Ok(())
    };
    Interpreter::new(options).run_observed(program.into(), &mut memory.lend(), &mut sink, &mut |_| ())?;
    Ok(moves)
}
