//! Runs of cutting moves: the stretches of a program that may be a finishing contour.
//!
//! A run is consecutive cutting moves (G1, G2, G3) in X and Y at constant Z. A rapid, a move in Z, G28, G53, a tool
//! change, and a change of spindle or offset end it. Moves without length are dropped. A cutting move from an unknown
//! place to a known one brings the cutter to the part, as rapids do in programs that write none; a wall that it may cut on
//! the way is unknown, so it is no part of any run.

use crate::{
    Axes, Canon, Event, FeedMode, GcodeError, GcodeErrorKind, LineRange, Modal, PathControl, Span, Spindle, Units,
};
use truepath_units::geometry::{Block, Curve, Point, Side};
use truepath_units::{Offset, Position, Real};

/// A run of cutting moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// Its place among the runs in the order of execution, counted from 1.
    pub(super) number: u32,
    /// The first and the last line any of its blocks is written on.
    pub(super) lines: LineRange,
    /// The block it begins with.
    pub(super) first: Span,
    pub(super) blocks: usize,
    pub(super) length: Offset,
    pub(super) start: Point,
    pub(super) end: Point,
    pub(super) z: Option<Position>,
    pub(super) wall: Option<Side>,
    pub(super) both_sides: bool,
    /// Blocks up to and including the one along which G41 or G42 takes its offset.
    pub(super) entry: usize,
    /// Blocks from the one along which G40 gives it up.
    pub(super) exit: usize,
    pub(super) setup: Setup,
    pub(super) units: Units,
    pub(super) path: Option<PathControl>,
    pub(super) between: Between,
}

/// What lies before and behind a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Between {
    /// Whether the last change of its height before it was upward, from somewhere this tool had cut.
    pub came_up: bool,
    /// Whether the move that ends it goes down.
    pub goes_down: bool,
    /// The greatest height at which a move with the same tool and origin has ended, until behind it.
    pub top: Option<Position>,
}

/// What stays the same along a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setup {
    pub(super) spindle: Spindle,
    pub(super) speed: Option<Real>,
    pub(super) tool: Option<u32>,
    work_offset: u16,
    radius_offset: Option<u32>,
}

/// What a step means for the run in progress.
enum Step {
    /// It is part of a run.
    Cut(Curve),
    /// It does not touch it.
    Pass,
    /// It ends it.
    Break,
}

/// What a step brought.
#[derive(Default)]
pub(super) struct Progress {
    /// A run that has just ended.
    pub(super) ended: Option<Run>,
    /// A block of the run in progress.
    pub(super) block: Option<Block>,
}

/// Splits the steps of a program into runs.
#[derive(Debug)]
pub(super) struct RunReader {
    within: Option<LineRange>,
    run: Option<Run>,
    count: u32,
    /// G41, G42 (`true`) or G40 (`false`) that no move has acted on yet.
    offset: Option<bool>,
    /// Where A, B, C, U, V and W stand.
    auxiliary: [i64; 6],
    /// What is known of the next run.
    between: Between,
    /// The tool that has cut.
    cut_with: Option<Option<u32>>,
    /// The first cutting move from an unknown place.
    unknown: Option<(GcodeErrorKind, LineRange, Span)>,
}

impl RunReader {
    /// Of the lines named, or of all.
    pub(super) const fn new(within: Option<LineRange>) -> Self {
        Self {
            within,
            run: None,
            count: 0,
            offset: None,
            auxiliary: [0; 6],
            between: Between { came_up: false, goes_down: false, top: None },
            cut_with: None,
            unknown: None,
        }
    }

    /// Number of the run in progress, or of the last one.
    pub(super) const fn number(&self) -> u32 {
        self.count
    }

    /// What is wrong with a program without any run because its moves begin at an unknown place.
    pub(super) const fn without_start(&self) -> Option<GcodeError> {
        match self.unknown {
            Some((kind, lines, block)) => Some(error_at(kind, lines, block)),
            None => None,
        }
    }

    /// Takes the next step.
    pub(super) fn step(&mut self, event: &Event<'_>) -> Result<Progress, GcodeErrorKind> {
        if self.within.is_some_and(|lines| !lines.contains(event.source.line)) {
            return Ok(Progress { ended: self.run.take(), block: None });
        }
        match *event.canon {
            Canon::Compensation { wall, .. } => self.offset = Some(wall.is_some()),
            Canon::Traverse { from, to } if from.point() != to.point() => self.offset = None,
            _ => {}
        }
        // A move that turns the part or moves a second slide is no cut along a contour of the plane.
        if core::mem::replace(&mut self.auxiliary, event.modal.auxiliary) != event.modal.auxiliary {
            return Ok(Progress { ended: self.run.take(), block: None });
        }
        if let Canon::Feed { from, to } = *event.canon
            && from.z == to.z
            && from.point().is_none()
            && self.unknown.is_none()
        {
            let line = event.source.line;
            self.unknown = Some((start_unknown(from), LineRange { first: line, last: line }, event.source.block));
        }
        let down = self.heights(event);
        match step(*event.canon)? {
            Step::Pass => Ok(Progress::default()),
            Step::Break => {
                let ended = self.run.take().map(|run| Run {
                    between: Between { goes_down: down, top: self.between.top, ..run.between },
                    ..run
                });
                Ok(Progress { ended, block: None })
            }
            Step::Cut(curve) => Ok(self.cut(event, curve)),
        }
    }

    /// The run in progress at the end of the program.
    pub(super) const fn finish(self) -> Option<Run> {
        self.run
    }

    /// Notes what a step does to the height of the tool; whether it goes down.
    fn heights(&mut self, event: &Event<'_>) -> bool {
        let (from, to) = match *event.canon {
            Canon::Traverse { from, to }
            | Canon::Feed { from, to }
            | Canon::Arc { from, to, .. }
            | Canon::PlaneArc { from, to, .. } => (from, to),
            // Another tool, offset or origin: heights mean something else, or nothing.
            Canon::ChangeTool(_) | Canon::WorkOffset(_) | Canon::Shift(_) => {
                self.between = Between { came_up: false, top: None, ..self.between };
                return false;
            }
            _ => return false,
        };
        self.between.top = self.between.top.max(to.z);
        match (from.z, to.z) {
            (Some(from), Some(to)) if to != from => {
                self.between.came_up = to > from && self.cut_with == Some(event.modal.tool);
                to < from
            }
            _ => false,
        }
    }

    fn cut(&mut self, event: &Event<'_>, curve: Curve) -> Progress {
        let modal = event.modal;
        let z = match *event.canon {
            Canon::Feed { to, .. } | Canon::Arc { to, .. } => to.z,
            _ => None,
        };
        let setup = Setup {
            spindle: modal.spindle,
            speed: modal.speed,
            tool: modal.tool,
            work_offset: modal.work_offset,
            radius_offset: modal.radius_offset,
        };
        let feed = feed_per_minute(modal, curve.length());
        let line = event.source.line;
        let goes_on = |run: &Run| run.z == z && run.end == curve.start() && run.setup.continues(&setup);
        let ended = if self.run.as_ref().is_some_and(goes_on) { None } else { self.run.take() };
        if self.run.is_none() {
            self.count = self.count.saturating_add(1);
        }
        let offset = self.offset.take();
        self.cut_with = Some(modal.tool);
        let run = self.run.get_or_insert(Run {
            number: self.count,
            lines: LineRange { first: line, last: line },
            first: event.source.block,
            blocks: 0,
            length: Offset::ZERO,
            start: curve.start(),
            end: curve.start(),
            z,
            wall: None,
            both_sides: false,
            entry: 0,
            exit: 0,
            setup,
            units: modal.units,
            path: modal.path,
            between: self.between,
        });
        let block = Block { curve, s: run.length, feed, line };
        run.lines.first = run.lines.first.min(line);
        run.lines.last = run.lines.last.max(line);
        run.blocks = run.blocks.saturating_add(1);
        match offset {
            Some(true) => run.entry = run.blocks,
            Some(false) => run.exit = 1,
            None if run.exit > 0 => run.exit = run.exit.saturating_add(1),
            None => {}
        }
        run.length += curve.length();
        run.end = curve.end();
        run.both_sides |= run.wall.is_some() && modal.wall.is_some() && run.wall != modal.wall;
        run.wall = run.wall.or(modal.wall);
        Progress { ended, block: Some(block) }
    }
}

impl Run {
    /// An error about the run, at its first block.
    pub(super) const fn error(&self, kind: GcodeErrorKind) -> GcodeError {
        error_at(kind, self.lines, self.first)
    }
}

const fn error_at(kind: GcodeErrorKind, lines: LineRange, block: Span) -> GcodeError {
    GcodeError { kind, file: 0, line: lines.first, column: 1, start: block.start, len: block.len }
}

const fn start_unknown(from: Axes) -> GcodeErrorKind {
    GcodeErrorKind::StartUnknown { axis: if from.x.is_none() { b'X' } else { b'Y' } }
}

impl Setup {
    /// Whether a run with this setup goes on under another: G41 and G42 may take or leave their offset on the way.
    fn continues(&self, other: &Self) -> bool {
        let offset =
            self.radius_offset.is_none() || other.radius_offset.is_none() || self.radius_offset == other.radius_offset;
        offset && Self { radius_offset: None, ..*self } == Self { radius_offset: None, ..*other }
    }
}

/// The feed along a block, mm/min, whatever F means.
fn feed_per_minute(modal: &Modal, length: Offset) -> Real {
    let feed = modal.feed.unwrap_or_default();
    match modal.feed_mode {
        FeedMode::PerMinute => feed,
        FeedMode::PerRevolution => feed.times(modal.speed.unwrap_or_default()),
        FeedMode::InverseTime => feed.times(length.mm()),
    }
}

fn step(canon: Canon) -> Result<Step, GcodeErrorKind> {
    Ok(match canon {
        Canon::Traverse { .. }
        | Canon::MachineMove { .. }
        | Canon::Reference { .. }
        | Canon::ChangeTool(_)
        | Canon::ToolLength(_)
        | Canon::Shift(_)
        | Canon::PlaneArc { .. }
        | Canon::Probe { .. }
        | Canon::Tap { .. }
        | Canon::Spline { .. }
        | Canon::End(_) => Step::Break,
        Canon::Feed { from, to } if from.z != to.z => Step::Break,
        Canon::Feed { from, to } => line(from, to)?,
        Canon::Arc { from, to, curve, turns, .. } => {
            if from.z == to.z && turns == 0 {
                Step::Cut(curve)
            } else {
                Step::Break
            }
        }
        _ => Step::Pass,
    })
}

fn line(from: Axes, to: Axes) -> Result<Step, GcodeErrorKind> {
    if from.x == to.x && from.y == to.y {
        return Ok(Step::Pass);
    }
    let Some(end) = to.point() else {
        return Err(start_unknown(to));
    };
    let Some(start) = from.point() else { return Ok(Step::Break) };
    Ok(Curve::line(start, end).map_or(Step::Pass, Step::Cut))
}
