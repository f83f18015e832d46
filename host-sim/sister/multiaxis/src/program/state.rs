//! What a program has said up to a line: modes, and where the axes stand.
//!
//! A coordinate is unknown until a word of G90 gives it, and again after whatever moves an axis to a place that the
//! program does not name (G28, G53, a tool change, other offsets). Places are program coordinates; with `local` added
//! (G92, G52) they are in the frame in which the machine file gives its axes.

use truepath_core::gcode::{Dialect, FeedMode, PointlessLength, Units};

use super::block::Word;
use super::codes::{Motion, TRANSFORMS};
use super::quantity::{Quantity, Scale};

/// Coordinates of X, Y, Z, A, B, C.
pub type Place = [Option<Quantity>; 6];

/// How the program is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The control it is for.
    pub dialect: Dialect,
    /// What a length without a point is.
    pub decimal: PointlessLength,
    /// Which of A, B, C the machine has.
    pub rotary: [bool; 3],
    /// Whether one length of the tool holds for the whole program: with an axis in the head it must.
    pub one_tool: bool,
    /// Whether blocks with `/` are left out.
    pub skip_block_delete: bool,
}

/// The state of the control.
#[derive(Clone, Debug)]
pub struct State {
    /// G20, G21.
    pub units: Units,
    /// G90.
    pub absolute: bool,
    /// G0, G1 …
    pub motion: Motion,
    /// G93, G94, G95.
    pub feed_mode: FeedMode,
    /// Whether F has been given since.
    pub feed_given: bool,
    /// Where the axes stand.
    pub at: Place,
    /// G92 or G52 in force.
    pub local: Place,
    /// What G92.3 takes up again; not known until G92 or G92.1, since controls keep it when they are off.
    pub(super) aside: Place,
    /// The line of G41 or G42 in force.
    pub compensation: Option<u32>,
    /// Whether G43.4, G43.5, G234 or M428 is in force.
    pub centre_point: bool,
    /// Whether it is M428, which G49 does not end.
    pub(super) switched: bool,
    /// The lines of the transforms in force.
    pub transforms: [Option<u32>; TRANSFORMS],
    /// The work offset in force: its code in tenths, and P.
    pub(super) work: (u16, i64),
    /// That in which the axes of the machine are given.
    pub(super) frame: Option<(u16, i64)>,
    /// The line since which the offsets are another one's.
    pub offsets_changed: Option<u32>,
    /// The line on which an offset was written, for good.
    pub(super) offsets_lost: Option<u32>,
    /// The line of a G92 that named a place not known.
    pub(super) named_unknown: Option<u32>,
    /// T, and the tool in the spindle.
    pub(super) tool: (Option<i64>, Option<i64>),
    /// The most decimals of a length and of an angle so far.
    pub decimals: [u8; 2],
    /// Codes of the last block that are not known, in tenths.
    pub unknown: Vec<u16>,
    /// M2, M30 or M99 was read.
    pub ended: bool,
    /// The line since which another tool than the first is in the spindle.
    pub tool_changed: Option<u32>,
}

impl State {
    /// At the start: G21 G90 G94 G54, no motion, nothing known of the axes.
    pub fn new() -> Self {
        Self {
            units: Units::Millimetres,
            absolute: true,
            motion: Motion::None,
            feed_mode: FeedMode::PerMinute,
            feed_given: false,
            at: [None; 6],
            local: [Some(Quantity::ZERO); 6],
            aside: [None; 6],
            switched: false,
            compensation: None,
            centre_point: false,
            transforms: [None; TRANSFORMS],
            work: (540, 0),
            frame: None,
            offsets_changed: None,
            offsets_lost: None,
            named_unknown: None,
            tool: (None, None),
            decimals: [0; 2],
            unknown: Vec::new(),
            ended: false,
            tool_changed: None,
        }
    }

    /// The scale of an axis.
    pub fn scale(&self, axis: usize) -> Scale {
        Scale::of_axis(axis, self.units)
    }

    /// The value of an axis word; `None` beyond the farthest coordinate, or for an expression.
    pub fn value(&self, word: &Word, axis: usize, text: &[u8], decimal: PointlessLength) -> Option<Quantity> {
        let number = word.value?;
        let scale = self.scale(axis);
        let pointless = !text.get(word.span()).is_some_and(|t| t.contains(&b'.'));
        if decimal == PointlessLength::Calculator || !pointless {
            return Quantity::written(number, scale);
        }
        let places = if scale == Scale::Inches { 4 } else { 3 };
        let least = truepath_core::gcode::Decimal::new(number.mantissa(), number.decimals().saturating_add(places))?;
        Quantity::written(least, scale)
    }

    /// Coordinates in the frame of the machine file, mm and degrees; the number of the first axis that is not known.
    pub fn in_frame(&self, place: &Place, needed: &[usize]) -> Result<[f64; 6], usize> {
        let mut values = [0.0; 6];
        for &axis in needed {
            let (Some(at), Some(local)) = (place[axis], self.local[axis]) else { return Err(axis) };
            values[axis] = at.value() + local.value();
        }
        Ok(values)
    }

    pub(super) fn forget(&mut self, axes: impl IntoIterator<Item = usize>) {
        for axis in axes {
            self.at[axis] = None;
        }
    }
}
