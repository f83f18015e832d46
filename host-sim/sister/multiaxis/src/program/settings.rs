//! How a program is worked on, where the results go, and how a pass ends.

use std::io::{self, Write};

use truepath_core::gcode::Units;
use truepath_ground::diagnostics::InputError;

use super::report::{MoveRow, Report};
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

/// How a pass ended.
#[derive(Debug)]
pub enum Outcome {
    /// The program was read to its end.
    Done(Box<Report>),
    /// This line steers the program, or computes a place: reading it line by line is not enough.
    Steered(u32),
}

/// Why it did not.
#[derive(Debug)]
pub enum PassError {
    /// The program is wrong.
    Input(InputError),
    /// It cannot be read.
    Read(io::Error),
    /// The result cannot be written.
    Write(io::Error),
}

impl From<InputError> for PassError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// Where the results of a pass go.
pub struct Sinks<'s> {
    /// The rewritten program.
    pub text: &'s mut dyn Write,
    /// One row a move.
    pub row: &'s mut dyn FnMut(&MoveRow) -> Result<(), InputError>,
    /// Told the bytes read, now and then.
    pub progress: &'s mut dyn FnMut(u64),
}
