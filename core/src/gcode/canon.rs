//! Canonical moves: what a program does, freed of how it is written.
//!
//! Lengths are nanometres in program coordinates, centres are absolute, modes are resolved. Every event names the
//! block it comes from, so that a writer can change the words of one move and keep every other byte. The vocabulary
//! follows the canonical machining functions of RS274/NGC (NIST 6556, chapter 4).

use super::{Decimal, Modal, Span};
use crate::geometry::{Curve, Point, Side};
use crate::units::{Offset, Position, Real};

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
}

/// What one block, or part of one, does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Canon {
    /// A comment; what is inside it.
    Comment(Span),
    /// The number of the program (O word).
    ProgramNumber(u32),
    /// G20 or G21.
    Units(Units),
    /// G17.
    PlaneXy,
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
    /// G54 (1) … G59.3 (9).
    WorkOffset(u8),
    /// G61, G61.1, G64.
    PathControl(PathControl),
    /// G4; the number as written, because its unit (s or ms) is the machine's.
    Dwell(Decimal),
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
        /// The arc in the plane.
        curve: Curve,
        /// Its centre.
        centre: Point,
        /// G3.
        counter_clockwise: bool,
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
    /// An M code kept without being understood.
    OtherM(u32),
    /// M2 or M30.
    End(u32),
}

/// The unit of length of the words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// G20.
    Inches,
    /// G21.
    Millimetres,
}

impl Units {
    /// Nanometres in one of it.
    pub const fn nanometres(self) -> i64 {
        match self {
            Self::Inches => 25_400_000,
            Self::Millimetres => 1_000_000,
        }
    }
}

/// The spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spindle {
    /// M5, and before any M3 or M4.
    Stopped,
    /// M3.
    Clockwise,
    /// M4.
    CounterClockwise,
}

/// The coolant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coolant {
    /// M7.
    Mist,
    /// M8.
    Flood,
    /// M9.
    Off,
}

/// Where the tool length comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolLength {
    /// G49.
    Off,
    /// G43; the table row, or that of the tool in the spindle.
    Table(Option<u32>),
    /// G43.1: values in the program.
    InProgram,
}

/// How closely the machine keeps to the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathControl {
    /// G61.
    Exact,
    /// G61.1.
    ExactStop,
    /// G64.
    Blend {
        /// P, when given.
        tolerance: Option<Offset>,
        /// Q, the tolerance below which short lines are merged, when given.
        merge: Option<Offset>,
    },
}

/// The block an event comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Line, counted from 1.
    pub line: u32,
    /// The whole line without its end; its words are found with [`Words`](super::Words).
    pub block: Span,
    /// Its N word.
    pub number: Option<Decimal>,
    /// Whether it carries `/`.
    pub block_delete: bool,
}

/// One step of the program.
#[derive(Clone, Copy, Debug)]
pub struct Event<'a> {
    /// What happens.
    pub canon: Canon,
    /// Where it is written.
    pub source: Source,
    /// The modes in force when it happens, this step's own change included.
    pub modal: &'a Modal,
}
