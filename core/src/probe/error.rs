//! What can be wrong with a probe file.

use core::fmt;

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
            Self::ColumnMissing { .. } => "name the columns x, y and z in the first line, for example x_mm,y_mm,z_mm",
            Self::Empty => "probe the wall first, or check that the right file was given",
            Self::TooManyPoints { .. } => {
                "split the file or probe fewer places; a handful of points on each wall is enough"
            }
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
        }
    }
}

impl fmt::Display for ProbeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.kind)
    }
}
