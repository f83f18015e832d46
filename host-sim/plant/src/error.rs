//! What can be wrong with the path, the set-up, the machine or the commanded program.

use std::fmt;

/// Why the plant refuses to cut or to probe.
#[derive(Debug, Clone, PartialEq)]
pub enum PlantError {
    /// The path has no segment of more than zero length.
    EmptyPath,
    /// The segments do not join: `segment` (counted from 0) starts `gap_mm` from the end of the one before.
    Gap {
        /// Index of the segment that starts away from its predecessor.
        segment: usize,
        /// Distance, mm.
        gap_mm: f64,
    },
    /// Start and end of an arc lie at different distances from its centre.
    ArcRadii {
        /// Index of the arc.
        segment: usize,
        /// Distance of the start from the centre, mm.
        start_mm: f64,
        /// Distance of the end from the centre, mm.
        end_mm: f64,
    },
    /// A number is outside the range in which the plant means anything.
    OutOfRange {
        /// The key, with its unit.
        key: &'static str,
        /// The value found.
        value: f64,
        /// The range expected, in words.
        expected: &'static str,
    },
    /// `runout_mm` must be empty or hold one value a tooth.
    RunoutCount {
        /// Values found.
        found: usize,
        /// Teeth of the cutter.
        teeth: usize,
    },
    /// `bend_law = "maxwell"` on a single pass with one engagement for all heights.
    BendLaw,
    /// The commanded path leaves the nominal path before its end.
    NotCovered {
        /// Nominal length reached, mm.
        covered_mm: f64,
        /// Length of the nominal path, mm.
        length_mm: f64,
    },
    /// A probe place does not lie on the path, or no wall was cut there.
    NoWallAt {
        /// Place along the contour, mm.
        s_mm: f64,
    },
}

impl fmt::Display for PlantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EmptyPath => write!(f, "the path has no segment of more than zero length"),
            Self::Gap { segment, gap_mm } => {
                write!(f, "segment {segment} starts {gap_mm:.4} mm away from the end of the one before")
            }
            Self::ArcRadii { segment, start_mm, end_mm } => {
                write!(f, "arc {segment}: start and end are {start_mm:.4} and {end_mm:.4} mm from its centre")
            }
            Self::OutOfRange { key, value, expected } => write!(f, "{key} = {value}: expected {expected}"),
            Self::RunoutCount { found, teeth } => {
                write!(f, "runout_mm has {found} values for {teeth} teeth: give one a tooth, or none")
            }
            Self::BendLaw => {
                write!(f, "bend_law = \"maxwell\" needs the engagement of every height: simulate with --program")
            }
            Self::NotCovered { covered_mm, length_mm } => {
                write!(f, "the commanded path follows the contour for {covered_mm:.1} of {length_mm:.1} mm")
            }
            Self::NoWallAt { s_mm } => write!(f, "there is no wall to probe at s = {s_mm} mm"),
        }
    }
}

impl std::error::Error for PlantError {}

/// `Err(OutOfRange)` unless `ok`.
pub(super) fn require(ok: bool, key: &'static str, value: f64, expected: &'static str) -> Result<(), PlantError> {
    if ok { Ok(()) } else { Err(PlantError::OutOfRange { key, value, expected }) }
}
