//! Errors of offsets, tools and modes.

use core::fmt;

use super::super::GCode;
use super::super::message::Letter;
use super::GcodeErrorKind;

/// What is wrong with a block that sets something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingError {
    /// Two codes of a block that both use the axis words.
    AxesUsedTwice {
        /// The one read first.
        first: GCode,
        /// The other.
        second: GCode,
    },
    /// A code without the axis words it needs.
    AxesMissing(GCode),
    /// A number that must be one of a few.
    NotBetween {
        /// Its letter.
        letter: u8,
        /// The least.
        least: u32,
        /// The greatest.
        greatest: u32,
    },
    /// An M code without a word it needs.
    MWordMissing {
        /// The code.
        m: u32,
        /// The letter.
        letter: u8,
    },
    /// A tool that the tool table does not hold.
    ToolUnknown {
        /// Its number.
        tool: u32,
    },
    /// More rows of the tool table are changed by G10 than are kept.
    TooManyTools {
        /// How many are kept.
        limit: u8,
    },
    /// M66 waits without a time.
    WaitWithoutTime,
    /// A code of a lathe.
    Lathe(GCode),
    /// A feed per revolution with S0 or without S.
    FeedPerRevolution,
    /// Polar words (@, ^) with X or Y.
    PolarMixed {
        /// `X` or `Y`.
        letter: u8,
    },
    /// G53 in G91.
    MachineMoveIncremental,
    /// An argument of G65 that is a length without a point, where such lengths are in least increments.
    ArgumentWithoutPoint {
        /// Its letter.
        letter: u8,
    },
    /// M72 without M70 or M73.
    NothingSaved,
}

impl SettingError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::AxesUsedTwice { .. } => "G060",
            Self::AxesMissing(_) => "G061",
            Self::NotBetween { .. } => "G062",
            Self::MWordMissing { .. } => "G063",
            Self::ToolUnknown { .. } => "G064",
            Self::TooManyTools { .. } => "G065",
            Self::WaitWithoutTime => "G066",
            Self::Lathe(_) => "G067",
            Self::FeedPerRevolution => "G068",
            Self::PolarMixed { .. } => "G069",
            Self::MachineMoveIncremental => "G049",
            Self::ArgumentWithoutPoint { .. } => "G116",
            Self::NothingSaved => "G048",
        }
    }
}

impl From<SettingError> for GcodeErrorKind {
    fn from(error: SettingError) -> Self {
        Self::Setting(error)
    }
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::AxesUsedTwice { first, second } => {
                write!(f, "{first} and {second} both use the axis words of this block; write them in two blocks")
            }
            Self::AxesMissing(code) => write!(f, "{code} has no axis word; add the axes it is meant for"),
            Self::NotBetween { letter, least, greatest } => {
                write!(f, "{} must be a whole number from {least} to {greatest} here; correct it", Letter(letter))
            }
            Self::MWordMissing { m, letter } => write!(f, "M{m} has no {}; add it to this block", Letter(letter)),
            Self::ToolUnknown { tool } => {
                write!(f, "tool {tool} is not in the tool table; add it there or correct the number")
            }
            Self::TooManyTools { limit } => {
                write!(f, "G10 changes more than {limit} rows of the tool table; set them at the machine")
            }
            Self::WaitWithoutTime => f.write_str("M66 waits for an input without a time; add Q"),
            Self::Lathe(code) => {
                write!(f, "{code} belongs to a lathe, whose moves are not computed; post the program for a mill")
            }
            Self::FeedPerRevolution => {
                f.write_str("feed per revolution (G95) without a spindle speed; give S before it")
            }
            Self::PolarMixed { letter } => {
                write!(f, "polar words (@, ^) and {} name the same place twice; keep one of them", Letter(letter))
            }
            Self::MachineMoveIncremental => {
                f.write_str("a move in machine coordinates (G53) cannot be incremental; write G90 before it")
            }
            Self::ArgumentWithoutPoint { letter } => write!(
                f,
                "{} is passed to a macro without a point, and controls set to least increments differ in what it means; write the point",
                Letter(letter)
            ),
            Self::NothingSaved => {
                f.write_str("M72 restores modes, but M70 or M73 has not saved any here; add M70 before it")
            }
        }
    }
}
