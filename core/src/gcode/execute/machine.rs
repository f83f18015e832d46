//! What a machine knows that no program says: its tool table.

use super::super::NineAxes;
use crate::units::Offset;

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
