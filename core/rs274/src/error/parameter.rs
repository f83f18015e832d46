//! Errors of parameters and of the memory for them.

use core::fmt;

use super::GcodeErrorKind;

/// What is wrong with a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterError {
    /// More numbered parameters are set than the memory holds.
    TooMany {
        /// What it holds.
        limit: u16,
    },
    /// More named parameters than the memory holds.
    TooManyNames {
        /// How many names it holds.
        limit: u16,
        /// How many bytes of names.
        bytes: u16,
    },
    /// A parameter number that does not exist.
    Number {
        /// The largest that does.
        largest: u16,
    },
    /// A parameter number with decimals.
    NotWhole,
    /// A named parameter that was never set.
    NotDefined,
    /// A parameter that follows the machine is set.
    ReadOnly,
}

impl ParameterError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::TooMany { .. } => "G080",
            Self::TooManyNames { .. } => "G081",
            Self::Number { .. } => "G082",
            Self::NotWhole => "G083",
            Self::NotDefined => "G084",
            Self::ReadOnly => "G085",
        }
    }
}

impl From<ParameterError> for GcodeErrorKind {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooMany { limit } => {
                write!(f, "more than {limit} numbered parameters are set, which is all the memory; use fewer of them")
            }
            Self::TooManyNames { limit, bytes } => {
                write!(
                    f,
                    "more named parameters than the memory holds, {limit} names of {bytes} bytes together; use fewer or shorter names"
                )
            }
            Self::Number { largest } => {
                write!(f, "a parameter number lies between 1 and {largest}; correct the number")
            }
            Self::NotWhole => f.write_str("a parameter number has no decimals; round it"),
            Self::NotDefined => f.write_str("this parameter has no value yet; set it before it is used"),
            Self::ReadOnly => f.write_str("this parameter follows the machine and cannot be set; use another one"),
        }
    }
}
