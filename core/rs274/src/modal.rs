//! The modes of the machine that stay from block to block.

use super::{FeedMode, GCode, PathControl, Plane, RetractLevel, Shifts, Spindle, Units};
use truepath_units::Real;
use truepath_units::geometry::Side;

/// How an axis word without a motion code of its own moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// G0.
    Traverse,
    /// G1.
    Feed,
    /// G2 or G3.
    Arc {
        /// G3.
        counter_clockwise: bool,
    },
    /// G5, G5.1, G5.2.
    Spline(GCode),
    /// G33.1.
    Tap,
    /// G38.2 … G38.5.
    Probe {
        /// G38.4, G38.5: until contact is lost.
        away: bool,
        /// G38.2, G38.4: no contact is an error.
        must: bool,
    },
    /// G73, G74, G76, G81 … G89.
    Cycle(GCode),
}

impl Motion {
    /// The code that selects it.
    pub const fn code(self) -> GCode {
        GCode::from_tenths(match self {
            Self::Traverse => 0,
            Self::Feed => 10,
            Self::Arc { counter_clockwise: false } => 20,
            Self::Arc { counter_clockwise: true } => 30,
            Self::Spline(code) | Self::Cycle(code) => return code,
            Self::Tap => 331,
            Self::Probe { away: false, must: true } => 382,
            Self::Probe { away: false, must: false } => 383,
            Self::Probe { away: true, must: true } => 384,
            Self::Probe { away: true, must: false } => 385,
        })
    }
}

/// The modes in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modal {
    /// G20, G21.
    pub units: Units,
    /// The motion that axis words alone continue; `None` at the start and after G80.
    pub motion: Option<Motion>,
    /// G90 (true), G91.
    pub absolute: bool,
    /// G90.1 (true), G91.1.
    pub absolute_centres: bool,
    /// The side of the wall told by G41 or G42.
    pub wall: Option<Side>,
    /// D of the last G41 or G42.
    pub radius_offset: Option<u32>,
    /// Whether the moves are those of the cutter's centre beside the programmed path: G41 or G42, and a radius is known.
    pub compensated: bool,
    /// Whether G43 or G43.1 is in force.
    pub length_offset: bool,
    /// G17, G18, G19.
    pub plane: Plane,
    /// G93, G94, G95: what `feed` means.
    pub feed_mode: FeedMode,
    /// G98, G99.
    pub retract: RetractLevel,
    /// G54 (1) … G59.3 (9), 9 + P of G54.1 and G154.
    pub work_offset: u16,
    /// Where the origin of the program lies, as far as it is known.
    pub shifts: Shifts,
    /// Where A, B, C (millionths of a degree) and U, V, W (nanometres) stand, counted from their place at the start.
    pub auxiliary: [i64; 6],
    /// G61, G61.1, G64; `None` when the program has not said it.
    pub path: Option<PathControl>,
    /// F, mm/min (G94), one a minute (G93) or mm a revolution (G95); `None` before the first.
    pub feed: Option<Real>,
    /// S, revolutions per minute; `None` before the first.
    pub speed: Option<Real>,
    /// M3, M4, M5.
    pub spindle: Spindle,
    /// The last T.
    pub selected: Option<u32>,
    /// The tool that the last M6 put into the spindle.
    pub tool: Option<u32>,
}

impl Modal {
    /// At the start of a program: G17 G90 G91.1 G94 G40 G49 G54, no motion, spindle stopped.
    pub(super) const fn initial(units: Units) -> Self {
        Self {
            units,
            motion: None,
            absolute: true,
            absolute_centres: false,
            wall: None,
            radius_offset: None,
            compensated: false,
            length_offset: false,
            plane: Plane::Xy,
            feed_mode: FeedMode::PerMinute,
            retract: RetractLevel::Before,
            work_offset: 1,
            shifts: Shifts::NONE,
            auxiliary: [0; 6],
            path: None,
            feed: None,
            speed: None,
            spindle: Spindle::Stopped,
            selected: None,
            tool: None,
        }
    }
}
