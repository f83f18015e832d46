//! How a program is worked on.

use truepath_core::gcode::Units;

use super::split::Splitter;
use super::state::Reading;
use crate::machine::Coordinates;

/// What the control does while it keeps the tool's tip (G43.4, G43.5, G234, LinuxCNC's M428).
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum CentrePoint {
    /// It transforms every interpolated point: no chord error.
    ///
    /// The tip stays on the chord, there is nothing to divide.
    Full,
    /// It transforms the ends of blocks only.
    ///
    /// It moves the joints linearly between them.
    Ends,
}

/// How a program is worked on.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'m> {
    /// How its words are read.
    pub reading: Reading,
    /// The unit until G20 or G21.
    pub units: Units,
    /// What XYZ are while no centre point code is in force.
    pub coordinates: Coordinates,
    /// What such a code does.
    pub centre_point: CentrePoint,
    /// How moves are divided.
    pub splitter: Splitter<'m>,
    /// The surface whose contact point is followed, if one is named: its normal out of the part.
    pub normal: Option<[f64; 3]>,
}
