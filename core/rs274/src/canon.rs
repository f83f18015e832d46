//! Canonical moves: what a program does, freed of how it is written.
//!
//! Lengths are nanometres in program coordinates, centres are absolute, modes are resolved. Every event names the
//! block it comes from, so that a writer can change the words of one move and keep every other byte. The vocabulary
//! follows the canonical machining functions of RS274/NGC (NIST 6556, chapter 4).

use super::{
    Axes, Coolant, Decimal, FeedMode, GcodeErrorKind, MachineParameters, Modal, Number, PathControl, Plane, Span,
    Spindle, ToolLength, Units,
};
use truepath_units::Real;
use truepath_units::geometry::{Curve, Point, Side};

/// What one block, or part of one, does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Canon {
    /// A comment; what is inside it.
    Comment(Span),
    /// The number of the program (O word).
    ProgramNumber(u32),
    /// G20 or G21.
    Units(Units),
    /// G17, G18, G19.
    Plane(Plane),
    /// G93, G94, G95.
    FeedMode(FeedMode),
    /// F, mm/min.
    FeedRate(Real),
    /// S, revolutions per minute.
    SpindleSpeed(Real),
    /// M3, M4, M5.
    Spindle(Spindle),
    /// T.
    SelectTool(u32),
    /// M6, to the tool selected last.
    ChangeTool(Option<u32>),
    /// M7, M8, M9.
    Coolant(Coolant),
    /// G43, G43.1, G49.
    ToolLength(ToolLength),
    /// G40, G41, G42.
    Compensation {
        /// The side of the wall; `None` for G40.
        wall: Option<Side>,
        /// D.
        offset_number: Option<u32>,
    },
    /// G54 (1) … G59.3 (9), or 9 + P of G54.1 and G154; its origin is in [`Modal::shifts`].
    WorkOffset(u16),
    /// The origin of the program's coordinates changes by G92, G52 or G10; the new one is in [`Modal::shifts`].
    Shift(ShiftKind),
    /// G10 L1, L10, L11: a row of the tool table changes.
    ToolEntry {
        /// Its number.
        tool: u32,
    },
    /// G61, G61.1, G64.
    PathControl(PathControl),
    /// G4; the number as written, because its unit (s or ms) is the machine's.
    Dwell(Number),
    /// G0.
    Traverse {
        /// Before.
        from: Axes,
        /// After.
        to: Axes,
    },
    /// G1.
    Feed {
        /// Before.
        from: Axes,
        /// After.
        to: Axes,
    },
    /// G2, G3; Z may change evenly along it.
    Arc {
        /// Before.
        from: Axes,
        /// After.
        to: Axes,
        /// The arc in the plane, without the extra turns.
        curve: Curve,
        /// Its centre.
        centre: Point,
        /// G3.
        counter_clockwise: bool,
        /// Full turns before the arc itself (P − 1).
        turns: u32,
    },
    /// G2, G3 in G18 or G19; the third axis may change evenly along it.
    PlaneArc {
        /// The plane, never XY.
        plane: Plane,
        /// Before.
        from: Axes,
        /// After.
        to: Axes,
        /// The arc in the plane: x is the plane's first axis, y its second.
        curve: Curve,
        /// Its centre, likewise.
        centre: Point,
        /// G3, seen against the plane's third axis.
        counter_clockwise: bool,
        /// Full turns before the arc itself (P − 1).
        turns: u32,
    },
    /// A spline (G5, G5.1, G5.2) as a whole, when the options ask for it; otherwise
    /// it comes as lines.
    Spline {
        /// Before.
        from: Axes,
        /// After.
        to: Axes,
        /// How many control points it has.
        points: u32,
    },
    /// G38.2 … G38.5: towards `to` until the probe answers. Where it stops is not in the program.
    Probe {
        /// Before.
        from: Axes,
        /// The end of the search.
        to: Axes,
        /// G38.4, G38.5: until contact is lost.
        away: bool,
        /// G38.2, G38.4: no contact is an error.
        must: bool,
    },
    /// G33.1: down to `to` and back, in step with the spindle.
    Tap {
        /// Before, and after.
        from: Axes,
        /// The deepest place.
        to: Axes,
    },
    /// G53: a move in machine coordinates. The axes named have no known program position afterwards.
    MachineMove {
        /// Machine coordinates of the axes named.
        to: Axes,
        /// G0.
        rapid: bool,
    },
    /// G28, G30: to a reference point. The axes named have no known program position afterwards.
    Reference {
        /// G30.
        second: bool,
        /// Whether X, Y, Z move.
        axes: [bool; 3],
        /// Where they pass on the way, program coordinates, when it is known.
        via: Axes,
    },
    /// M0, or M1 when optional.
    Stop {
        /// M1.
        optional: bool,
    },
    /// An M code that does not move an axis and is passed on: outputs, inputs, overrides, pallets, or one not known.
    OtherM(u32),
    /// M2 or M30.
    End(u32),
}

/// What moves the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShiftKind {
    /// G10 L2, L20 to the work offset in force.
    Work,
    /// G92, G92.1, G92.2, G92.3, G52.
    Local,
}

/// The block an event comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file: 0 for the program, otherwise the number its library gives it.
    pub file: u16,
    /// Line of the file, counted from 1.
    pub line: u32,
    /// The whole line without its end; its words are found with [`Words`](super::Words).
    pub block: Span,
    /// Its N word.
    pub number: Option<Decimal>,
    /// Whether it carries `/`.
    pub block_delete: bool,
    /// How many calls deep it stands, 0 in the main program.
    pub depth: u8,
    /// How many calls, returns and jumps the program took before it. A line that comes again with another number is
    /// executed more than once.
    pub jumps: u32,
}

impl Source {
    /// No block yet.
    pub(super) const NONE: Self = Self {
        file: 0,
        line: 1,
        block: Span { start: 0, len: 0 },
        number: None,
        block_delete: false,
        depth: 0,
        jumps: 0,
    };
}

/// One step of the program.
#[derive(Clone, Copy)]
pub struct Event<'a> {
    /// What happens.
    pub canon: &'a Canon,
    /// Where it is written.
    pub source: Source,
    /// The modes in force when it happens, this step's own change included.
    pub modal: &'a Modal,
    /// The bytes of the file it is written in, in which all its spans lie.
    pub text: &'a [u8],
    /// The parameters at this moment.
    pub parameters: &'a dyn MachineParameters,
}

/// What takes the steps of a program. Called dynamically, so that the interpreter is in a compiled program once, whoever calls it.
pub type Sink<'s> = dyn FnMut(&Event<'_>) -> Result<(), GcodeErrorKind> + 's;
