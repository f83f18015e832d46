//! What can be wrong with a probe file.

use core::fmt;

use truepath_rs274::Line;
use truepath_units::{Millimetres, Offset, errors};

errors! {
    /// What is wrong.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ProbeErrorKind {
        /// Something that is not a number stands where a number is expected.
        NotANumber = "M001", "this is not a number; a coordinate was expected"
            => "write plain decimal numbers such as -12.345; for a comma as decimal sign separate the columns by blanks, tabs or semicolons";
        /// A number with more than 12 digits before its point.
        NumberTooLarge = "M002", "this number has more than 12 digits before its point; a coordinate was expected"
            => "check the unit and the separator of the file";
        /// A line with another count of numbers than the format has.
        WrongCount {
            /// Numbers the format has.
            expected: usize,
            /// Numbers found.
            found: usize,
        } = "M003", "found {found} numbers in this line; expected {expected}"
            => "a PROBEOPEN file has nine numbers in every line (X Y Z A B C U V W); set [probe] format = \"columns\" for other files, and probe again if the file was cut off";
        /// The header names no column for this axis.
        ColumnMissing {
            /// `x`, `y` or `z`.
            axis: char,
        } = "M004", "the header names no column for {axis}"
            => "name the columns x, y and z in the first line, for example x_mm,y_mm,z_mm, or say columns = \"x,y,z\" in [probe]";
        /// No line with a point.
        Empty = "M005", "the file holds no probe point"
            => "probe the wall first, or check that the right file was given and its format in [probe]";
        /// More points than the lent buffer holds.
        TooManyPoints {
            /// The buffer's length.
            limit: usize,
        } = "M006", "the file holds more than {limit} probe points"
            => "split the file or probe fewer places; a handful of points on each wall is enough";
        /// The file ends before its last line.
        CutOff {
            /// How the last line begins.
            expected: &'static str,
        } = "M007", "the file was cut off here; expected {expected} as its last line"
            => "fetch the file again, or let the verification program run to its end";
        /// The file says how many points it has, and has another number of them.
        PointsLost {
            /// Points it says.
            said: u32,
            /// Points it has.
            found: u32,
        } = "M008", "{found} points stand in the file; expected {said}"
            => "fetch the file again: lines are missing or were added";
        /// The file is of a part cut with another program.
        ProgramDiffers {
            /// CRC-32 in the file.
            file: u32,
            /// CRC-32 of the program of the job.
            job: u32,
        } = "M009", "the file is of a part cut with program {file:08x}; expected program {job:08x}"
            => "give the file measured on the part cut with this program, or make the verification program anew";
        /// The file is of a part that was cut with a correction.
        CutCorrected {
            /// CRC-32 of the correction.
            file: u32,
        } = "M038", "the file is of a part cut with correction {file:08x}; expected one cut without correction"
            => "give the points of a part that the program itself has cut; for the next part learn from this one with truepath learn, and name the folder of its correction with --from";
        /// The file is of a part that was cut with another correction.
        CorrectionDiffers {
            /// CRC-32 of that correction.
            file: u32,
        } = "M039", "the file is of a part cut with correction {file:08x}; expected the one of this folder"
            => "name the folder of the correction that the part was cut with";
        /// The ball of the file is not that of the job.
        BallDiffers {
            /// Diameter in the file.
            file: Offset,
            /// Diameter in the job.
            job: Offset,
        } = "M010",
            "the ball has a diameter of {file:.4} mm here; expected {job:.4} mm, as the job says",
                file = Millimetres(file), job = Millimetres(job)
            => "correct ball_diameter_mm in [probe]: it is a diameter; R of G801 is a radius, half of it; 25.4 times off is a file in the other unit";
        /// Machine coordinates, and no work offset.
        NoWorkOffset {
            /// `G54` and the like.
            system: &'static str,
        } = "M030", "machine coordinates, and the work offset {system} is not known; expected a line [{system}:x,y,z]"
            => "type $# (and $G) in the console before or after probing and keep its answer in the log, or say work_offset_mm = [x, y, z] in [probe]: the machine position of the work zero, tool length included";
        /// A work offset with two values.
        OffsetChanged {
            /// `G54`, `G92`, `TLO` and the like; `GC` when the active system changes.
            what: &'static str,
        } = "M031", "[{what}:…] has two values in this file; expected one"
            => "the points cannot all be of one setup: keep the part of the log that holds one run and one answer to $# and $G";
        /// Nothing says whether the numbers are millimetres or inches, or two things say it differently.
        UnitUnclear = "M032", "millimetres or inches cannot be told; expected $13=0 or $13=1"
            => "type $$ in the console and keep its answer in the log: $13=0 says mm, $13=1 inches";
        /// The header names the unit of the columns, and the job another.
        UnitDiffers = "M037", "the header names another unit than the job; expected one unit"
            => "say unit = \"inch\" or unit = \"mm\" in [probe] as the header does, or correct the header";
        /// A line that looks like one of the format and is not.
        Malformed {
            /// What was expected.
            expected: &'static str,
        } = "M033", "this line is not as it should be; expected {expected}"
            => "correct the line or fetch the file again; check the format in [probe]";
        /// A word that a line needs.
        WordMissing {
            /// Its letter.
            letter: char,
        } = "M034", "this line has no {letter}; expected {letter} with a number"
            => "print this coordinate as well; a height is needed beside X and Y";
        /// A measured point under the nominal one of another number.
        NumbersDiffer {
            /// Number of the nominal point.
            nominal: u32,
            /// Number of the measured one.
            measured: u32,
        } = "M035", "point {measured} is measured here; expected point {nominal}, whose G800 stands before"
            => "fetch the file again: every G801 belongs to the G800 before it";
        /// Two numbers that are not the components of a unit normal.
        NoNormal = "M036", "these numbers are not a normal; expected components of a length of 1"
            => "give the components of a normal of length 1; check the order of the columns";
    }
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
    /// An error at some bytes of a line.
    pub(super) fn at(kind: ProbeErrorKind, line: &Line, offset: usize, len: usize) -> Self {
        let column = u32::try_from(offset.saturating_add(1)).unwrap_or(u32::MAX);
        Self { kind, line: line.number, column, start: line.start.saturating_add(offset), len }
    }

    /// An error of a whole line.
    pub(super) fn of_line(kind: ProbeErrorKind, line: &Line) -> Self {
        Self::at(kind, line, 0, line.text.len())
    }

    /// An error at a part of a line: `rest` is what follows it.
    pub(super) fn before(kind: ProbeErrorKind, line: &Line, part: &[u8], rest: &[u8]) -> Self {
        Self::at(kind, line, line.text.len().saturating_sub(rest.len()).saturating_sub(part.len()), part.len())
    }
}

impl fmt::Display for ProbeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.kind)
    }
}
