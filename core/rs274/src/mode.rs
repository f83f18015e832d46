//! What the modes of a machine can be: units, planes, feed, spindle, coolant, path.

use truepath_units::Offset;

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
    /// Nanometres in the least increment of a control set to it: 0.001 mm, 0.0001 in.
    pub const fn least_increment(self) -> i64 {
        match self {
            Self::Inches => 2_540,
            Self::Millimetres => 1_000,
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

/// The plane of arcs, cycles and cutter radius compensation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    #[default]
    Xy,
    /// G18: Z is its first axis.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// The numbers of its first, second and third axis: X 0, Y 1, Z 2.
    pub const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }
}

/// What F means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FeedMode {
    /// G94: length a minute.
    #[default]
    PerMinute,
    /// G93: one over the minutes that a move takes.
    InverseTime,
    /// G95: length a revolution.
    PerRevolution,
}

/// Where a canned cycle retracts to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RetractLevel {
    /// G98: the height before the cycle, when it is above R.
    #[default]
    Before,
    /// G99: the plane of R.
    Clearance,
}
