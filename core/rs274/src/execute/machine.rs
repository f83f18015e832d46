//! What a machine knows that no program says: its tool table, its unit, how its probe answers.

use super::super::{NineAxes, Units};
use truepath_units::Offset;

/// A row of the tool table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tool {
    /// T and H.
    pub number: u32,
    /// Its place in the changer.
    pub pocket: u32,
    /// The diameter of the cutter.
    pub diameter: Offset,
    /// Its offsets, in which the length is Z.
    pub offset: NineAxes,
}

impl Tool {
    /// Tool 0 without offsets.
    pub const NONE: Self = Self { number: 0, pocket: 0, diameter: Offset::ZERO, offset: [0; 9] };
}

/// A machine whose offsets are those of the parameters and the tool table: every position is known.
///
/// Without it a program is read for whatever machine it will run on, and positions are unknown after every change that
/// depends on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The unit of the offsets in the parameters.
    pub units: Units,
    /// How far before the end of a probing move the probe is taken to answer.
    pub probe_before_end: Offset,
}
