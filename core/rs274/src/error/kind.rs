//! The kinds of errors and their codes.

use super::super::compensation::CompensationError;
use super::super::{GCode, LineRange};
use super::{CornerError, CycleError, ExpressionError, FlowError, Foreign, ParameterError, SettingError};
use truepath_units::Offset;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GcodeErrorKind {
    /// A byte that belongs to no word and no comment.
    UnexpectedByte(u8),
    /// A letter without a number.
    NumberMissing {
        /// The letter.
        letter: u8,
    },
    /// A number with more than 18 digits before its point.
    NumberTooLarge {
        /// Its letter.
        letter: u8,
    },
    /// `(` without `)` in the same line.
    UnclosedComment,
    /// `)` without `(`.
    StrayParenthesis,
    /// `#`, `[`, `]`, `=` or `*` where none belongs.
    Stray(u8),
    /// Three or more letters in a row outside a comment.
    Text,
    /// The program is in another language.
    ForeignDialect(Foreign),
    /// Something else than a comment after `%`.
    TextAfterPercent,

    /// A letter given twice in a block.
    DuplicateWord {
        /// The letter.
        letter: u8,
    },
    /// N or `/` after another word.
    OutOfPlace {
        /// `N`, `/` or `O`.
        letter: u8,
    },
    /// Two G codes of one modal group in a block.
    Conflict {
        /// The one read first.
        first: GCode,
        /// The other.
        second: GCode,
    },
    /// Two M codes that exclude each other in a block.
    ConflictM {
        /// The one read first.
        first: u32,
        /// The other.
        second: u32,
    },
    /// More words in a block than are kept.
    TooManyWords {
        /// How many are kept.
        limit: u8,
    },
    /// More M codes in a block than are kept.
    TooManyM {
        /// How many are kept.
        limit: u8,
    },
    /// A number that must be whole is not.
    NotWhole {
        /// Its letter.
        letter: u8,
    },
    /// A number that must not be negative is.
    Negative {
        /// Its letter.
        letter: u8,
    },
    /// A word that no code of the block uses.
    UnusedWord {
        /// Its letter.
        letter: u8,
    },
    /// A coordinate, feed, speed or number out of range.
    OutOfRange {
        /// Its letter.
        letter: u8,
    },
    /// A second program begins before the first has ended.
    SecondProgram {
        /// Number of the first.
        first: u32,
        /// Number of the second.
        second: u32,
    },

    /// A G code that is not known.
    UnknownG(GCode),
    /// A known G code that is not computed.
    Unsupported(GCode),
    /// A plane other than XY.
    WrongPlane(GCode),
    /// A call of a macro.
    Macro(GCode),
    /// A G that is no number of a G code.
    NotAGCode,

    /// Axis words, but no motion is active.
    NoMotion,
    /// G53 with axis words needs G0 or G1.
    MachineMoveNeedsLine,
    /// G4 without its time.
    DwellWithoutTime,
    /// An incremental move or an arc from an axis position that is not known.
    PositionUnknown {
        /// The axis.
        axis: u8,
    },

    /// An arc with neither I, J nor R.
    ArcWithoutCentre,
    /// An arc with R as well as I or J.
    ArcMixed,
    /// An absolute centre (G90.1) of which one coordinate is missing.
    ArcCentreIncomplete {
        /// The missing letter.
        missing: u8,
    },
    /// An arc with R whose end is its start.
    ArcRadiusFullCircle,
    /// A radius too small to reach the end.
    ArcRadiusTooSmall {
        /// Distance from start to end.
        chord: Offset,
        /// The radius without its sign.
        radius: Offset,
    },
    /// The end is not as far from the centre as the start.
    ArcEndOffRadius {
        /// Distance of the start from the centre.
        start: Offset,
        /// Distance of the end from the centre.
        end: Offset,
    },
    /// The centre coincides with the start or the end.
    ArcNoRadius,

    /// A parameter, or the memory for them.
    Parameter(ParameterError),
    /// Cutter radius compensation.
    Compensation(CompensationError),
    /// An expression.
    Expression(ExpressionError),
    /// The order in which blocks are executed.
    Flow(FlowError),
    /// A canned cycle, a spline, a probing move.
    Cycle(CycleError),
    /// What a corner word asks for.
    Corner(CornerError),
    /// An offset, a tool, a mode.
    Setting(SettingError),

    /// No cutting move in X or Y at constant Z.
    NoContour,
    /// More than one candidate.
    SeveralContours {
        /// How many.
        count: u32,
        /// Lines of the first.
        first: LineRange,
        /// Lines of the second.
        second: LineRange,
    },
    /// The program has no such blocks of a run.
    PartMissing {
        /// The run, counted from 1 in the order of execution.
        run: u32,
        /// The first of its blocks that counts, from 0.
        first: u32,
        /// How many count.
        blocks: u32,
    },
    /// More blocks than the buffer holds.
    ContourTooLong {
        /// What it holds.
        limit: usize,
    },
    /// A cutting move from a place that is not known.
    StartUnknown {
        /// The axis whose position is not known.
        axis: u8,
    },
    /// The height of the contour is never given.
    HeightUnknown,
    /// The contour is cut with G41 in one part and G42 in another.
    BothSides,
}

impl GcodeErrorKind {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::UnexpectedByte(_) => "G001",
            Self::NumberMissing { .. } => "G002",
            Self::NumberTooLarge { .. } => "G003",
            Self::UnclosedComment => "G004",
            Self::StrayParenthesis => "G005",
            Self::Stray(_) => "G006",
            Self::Text => "G008",
            Self::ForeignDialect(_) => "G009",
            Self::TextAfterPercent => "G010",
            Self::DuplicateWord { .. } => "G022",
            Self::OutOfPlace { .. } => "G023",
            Self::Conflict { .. } => "G024",
            Self::ConflictM { .. } => "G025",
            Self::TooManyM { .. } => "G026",
            Self::TooManyWords { .. } => "G047",
            Self::Parameter(error) => error.code(),
            Self::Compensation(error) => error.code(),
            Self::Expression(error) => error.code(),
            Self::Flow(error) => error.code(),
            Self::Corner(error) => error.code(),
            Self::Cycle(error) => error.code(),
            Self::Setting(error) => error.code(),
            Self::NotWhole { .. } => "G027",
            Self::Negative { .. } => "G028",
            Self::UnusedWord { .. } => "G029",
            Self::OutOfRange { .. } => "G030",
            Self::SecondProgram { .. } => "G031",
            Self::UnknownG(_) => "G032",
            Self::Unsupported(_) => "G033",
            Self::WrongPlane(_) => "G034",
            Self::Macro(_) => "G038",
            Self::NotAGCode => "G041",
            Self::NoMotion => "G042",
            Self::MachineMoveNeedsLine => "G043",
            Self::DwellWithoutTime => "G044",
            Self::PositionUnknown { .. } => "G045",
            Self::ArcWithoutCentre => "G050",
            Self::ArcMixed => "G051",
            Self::ArcCentreIncomplete { .. } => "G052",
            Self::ArcRadiusFullCircle => "G053",
            Self::ArcRadiusTooSmall { .. } => "G054",
            Self::ArcEndOffRadius { .. } => "G055",
            Self::ArcNoRadius => "G056",
            Self::NoContour => "G070",
            Self::SeveralContours { .. } => "G071",
            Self::ContourTooLong { .. } => "G072",
            Self::StartUnknown { .. } => "G073",
            Self::HeightUnknown => "G074",
            Self::BothSides => "G075",
            Self::PartMissing { .. } => "G076",
        }
    }
}
