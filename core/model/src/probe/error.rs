//! What can be wrong with a probe file.

use core::fmt;

use truepath_rs274::Line;
use truepath_units::Offset;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeErrorKind {
    /// Something that is not a number stands where a number is expected.
    NotANumber,
    /// A number with more than 12 digits before its point.
    NumberTooLarge,
    /// A line with another count of numbers than the format has.
    WrongCount {
        /// Numbers the format has.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// The header names no column for this axis.
    ColumnMissing {
        /// `x`, `y` or `z`.
        axis: char,
    },
    /// No line with a point.
    Empty,
    /// More points than the lent buffer holds.
    TooManyPoints {
        /// The buffer's length.
        limit: usize,
    },
    /// The file ends before its last line.
    CutOff {
        /// How the last line begins.
        expected: &'static str,
    },
    /// The file says how many points it has, and has another number of them.
    PointsLost {
        /// Points it says.
        said: u32,
        /// Points it has.
        found: u32,
    },
    /// The file is of a part cut with another program.
    ProgramDiffers {
        /// CRC-32 in the file.
        file: u32,
        /// CRC-32 of the program of the job.
        job: u32,
    },
    /// The file is of a part that was cut with a correction.
    CutCorrected {
        /// CRC-32 of the correction.
        file: u32,
    },
    /// The file is of a part that was cut with another correction.
    CorrectionDiffers {
        /// CRC-32 of that correction.
        file: u32,
    },
    /// The ball of the file is not that of the job.
    BallDiffers {
        /// Diameter in the file.
        file: Offset,
        /// Diameter in the job.
        job: Offset,
    },
    /// Machine coordinates, and no work offset.
    NoWorkOffset {
        /// `G54` and the like.
        system: &'static str,
    },
    /// A work offset with two values.
    OffsetChanged {
        /// `G54`, `G92`, `TLO` and the like; `GC` when the active system changes.
        what: &'static str,
    },
    /// Nothing says whether the numbers are millimetres or inches, or two things say it differently.
    UnitUnclear,
    /// The header names the unit of the columns, and the job another.
    UnitDiffers,
    /// A line that looks like one of the format and is not.
    Malformed {
        /// What was expected.
        expected: &'static str,
    },
    /// A word that a line needs.
    WordMissing {
        /// Its letter.
        letter: char,
    },
    /// A measured point under the nominal one of another number.
    NumbersDiffer {
        /// Number of the nominal point.
        nominal: u32,
        /// Number of the measured one.
        measured: u32,
    },
    /// Two numbers that are not the components of a unit normal.
    NoNormal,
}

/// An error with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeError {
    /// What is wrong.
    pub kind: ProbeErrorKind,
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// Offset of the offending bytes from the start of the file.
    pub start: usize,
    /// Their number.
    pub len: usize,
}

impl ProbeError {
    /// At some bytes of a line.
    pub(super) fn at(kind: ProbeErrorKind, line: &Line, offset: usize, len: usize) -> Self {
        let column = u32::try_from(offset.saturating_add(1)).unwrap_or(u32::MAX);
        Self { kind, line: line.number, column, start: line.start.saturating_add(offset), len }
    }

    /// At a whole line.
    pub(super) fn of_line(kind: ProbeErrorKind, line: &Line) -> Self {
        Self::at(kind, line, 0, line.text.len())
    }

    /// At a part of a line: `rest` is what follows it.
    pub(super) fn before(kind: ProbeErrorKind, line: &Line, part: &[u8], rest: &[u8]) -> Self {
        Self::at(kind, line, line.text.len().saturating_sub(rest.len()).saturating_sub(part.len()), part.len())
    }
}

impl ProbeErrorKind {
    /// A code that keeps its meaning.
    pub const fn code(self) -> &'static str {
        match self {
            Self::NotANumber => "M001",
            Self::NumberTooLarge => "M002",
            Self::WrongCount { .. } => "M003",
            Self::ColumnMissing { .. } => "M004",
            Self::Empty => "M005",
            Self::TooManyPoints { .. } => "M006",
            Self::CutOff { .. } => "M007",
            Self::PointsLost { .. } => "M008",
            Self::ProgramDiffers { .. } => "M009",
            Self::BallDiffers { .. } => "M010",
            Self::NoWorkOffset { .. } => "M030",
            Self::OffsetChanged { .. } => "M031",
            Self::UnitUnclear => "M032",
            Self::Malformed { .. } => "M033",
            Self::WordMissing { .. } => "M034",
            Self::NumbersDiffer { .. } => "M035",
            Self::NoNormal => "M036",
            Self::UnitDiffers => "M037",
            Self::CutCorrected { .. } => "M038",
            Self::CorrectionDiffers { .. } => "M039",
        }
    }
    /// What to do about it.
    pub const fn help(self) -> &'static str {
        match self {
            Self::NotANumber => {
                "write plain decimal numbers such as -12.345; for a comma as decimal sign separate the columns by blanks, tabs or semicolons"
            }
            Self::NumberTooLarge => "check the unit and the separator of the file",
            Self::WrongCount { .. } => {
                "a PROBEOPEN file has nine numbers in every line (X Y Z A B C U V W); set [probe] format = \"columns\" for other files, and probe again if the file was cut off"
            }
            Self::ColumnMissing { .. } => {
                "name the columns x, y and z in the first line, for example x_mm,y_mm,z_mm, or say columns = \"x,y,z\" in [probe]"
            }
            Self::Empty => "probe the wall first, or check that the right file was given and its format in [probe]",
            Self::TooManyPoints { .. } => {
                "split the file or probe fewer places; a handful of points on each wall is enough"
            }
            Self::CutOff { .. } => "fetch the file again, or let the verification program run to its end",
            Self::PointsLost { .. } => "fetch the file again: lines are missing or were added",
            Self::ProgramDiffers { .. } => {
                "give the file measured on the part cut with this program, or make the verification program anew"
            }
            Self::CutCorrected { .. } => {
                "give the points of a part that the program itself has cut; for the next part learn from this one with truepath learn, and name the folder of its correction with --from"
            }
            Self::CorrectionDiffers { .. } => "name the folder of the correction that the part was cut with",
            Self::BallDiffers { .. } => {
                "correct ball_diameter_mm in [probe]: it is a diameter; R of G801 is a radius, half of it; 25.4 times off is a file in the other unit"
            }
            Self::NoWorkOffset { .. } => {
                "type $# (and $G) in the console before or after probing and keep its answer in the log, or say work_offset_mm = [x, y, z] in [probe]: the machine position of the work zero, tool length included"
            }
            Self::OffsetChanged { .. } => {
                "the points cannot all be of one setup: keep the part of the log that holds one run and one answer to $# and $G"
            }
            Self::UnitUnclear => "type $$ in the console and keep its answer in the log: $13=0 says mm, $13=1 inches",
            Self::UnitDiffers => {
                "say unit = \"inch\" or unit = \"mm\" in [probe] as the header does, or correct the header"
            }
            Self::Malformed { .. } => "correct the line or fetch the file again; check the format in [probe]",
            Self::WordMissing { .. } => "print this coordinate as well; a height is needed beside X and Y",
            Self::NumbersDiffer { .. } => "fetch the file again: every G801 belongs to the G800 before it",
            Self::NoNormal => "give the components of a normal of length 1; check the order of the columns",
        }
    }
}

impl fmt::Display for ProbeErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotANumber => write!(f, "this is not a number; a coordinate was expected"),
            Self::NumberTooLarge => {
                write!(f, "this number has more than 12 digits before its point; a coordinate was expected")
            }
            Self::WrongCount { expected, found } => {
                write!(f, "found {found} numbers in this line; expected {expected}")
            }
            Self::ColumnMissing { axis } => write!(f, "the header names no column for {axis}"),
            Self::Empty => write!(f, "the file holds no probe point"),
            Self::TooManyPoints { limit } => write!(f, "the file holds more than {limit} probe points"),
            Self::CutOff { expected } => write!(f, "the file was cut off here; expected {expected} as its last line"),
            Self::PointsLost { said, found } => write!(f, "{found} points stand in the file; expected {said}"),
            Self::ProgramDiffers { file, job } => {
                write!(f, "the file is of a part cut with program {file:08x}; expected program {job:08x}")
            }
            Self::CutCorrected { file } => {
                write!(f, "the file is of a part cut with correction {file:08x}; expected one cut without correction")
            }
            Self::CorrectionDiffers { file } => {
                write!(f, "the file is of a part cut with correction {file:08x}; expected the one of this folder")
            }
            Self::BallDiffers { file, job } => {
                write!(f, "the ball has a diameter of ")?;
                length(f, *file)?;
                write!(f, " here; expected ")?;
                length(f, *job)?;
                write!(f, ", as the job says")
            }
            Self::NoWorkOffset { system } => write!(
                f,
                "machine coordinates, and the work offset {system} is not known; expected a line [{system}:x,y,z]"
            ),
            Self::OffsetChanged { what } => write!(f, "[{what}:…] has two values in this file; expected one"),
            Self::UnitUnclear => write!(f, "millimetres or inches cannot be told; expected $13=0 or $13=1"),
            Self::UnitDiffers => write!(f, "the header names another unit than the job; expected one unit"),
            Self::Malformed { expected } => write!(f, "this line is not as it should be; expected {expected}"),
            Self::WordMissing { letter } => write!(f, "this line has no {letter}; expected {letter} with a number"),
            Self::NumbersDiffer { nominal, measured } => {
                write!(f, "point {measured} is measured here; expected point {nominal}, whose G800 stands before")
            }
            Self::NoNormal => write!(f, "these numbers are not a normal; expected components of a length of 1"),
        }
    }
}

/// A length in millimetres with four decimals, without floating point.
fn length(f: &mut fmt::Formatter<'_>, length: Offset) -> fmt::Result {
    let tenths = truepath_units::div_rounded(i128::from(length.nm()), 100).unsigned_abs();
    let sign = if length < Offset::ZERO { "-" } else { "" };
    write!(f, "{sign}{}.{:04} mm", tenths / 10_000, tenths % 10_000)
}

impl fmt::Display for ProbeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.kind)
    }
}
