//! Errors in the order of execution: subprograms, loops, jumps.

use core::fmt;

use super::GcodeErrorKind;

/// What is wrong with the order in which blocks are executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowError {
    /// A word behind an O word that is none of its keywords.
    Keyword,
    /// An O word without number or name.
    Label,
    /// A condition that does not stand in brackets.
    Condition,
    /// Something behind a complete statement.
    TextBehind,
    /// A subprogram that is neither in this text nor in the library.
    NoSuchProgram,
    /// A block number that no block has.
    NoSuchBlock {
        /// The number.
        number: u32,
    },
    /// `sub`, `if`, `while`, `do` or `repeat` without its end.
    NoEnd,
    /// `else`, `endif`, `endwhile`, `break` … outside of what it belongs to.
    Unmatched,
    /// `return` outside of a subprogram.
    ReturnOutside,
    /// More calls inside each other than are followed.
    TooManyCalls {
        /// How many are followed.
        limit: u8,
    },
    /// More loops and conditions inside each other than are kept.
    TooManyOpen {
        /// How many are kept.
        limit: u8,
    },
    /// More arguments of a call than there are parameters for.
    TooManyArguments {
        /// How many there are.
        limit: u8,
    },
    /// More assignments in a block than are kept.
    TooManyAssignments {
        /// How many are kept.
        limit: u8,
    },
    /// More blocks executed than allowed.
    TooLong {
        /// How many are allowed behind the first jump.
        limit: u32,
    },
    /// A statement that the dialect does not have.
    OtherDialect,
    /// A block that can be no argument list of G65.
    Argument {
        /// The letter.
        letter: u8,
    },
}

impl FlowError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::Keyword => "G140",
            Self::Label => "G141",
            Self::Condition => "G142",
            Self::TextBehind => "G143",
            Self::NoSuchProgram => "G144",
            Self::NoSuchBlock { .. } => "G145",
            Self::NoEnd => "G146",
            Self::Unmatched => "G147",
            Self::ReturnOutside => "G148",
            Self::TooManyCalls { .. } => "G149",
            Self::TooManyOpen { .. } => "G150",
            Self::TooManyArguments { .. } => "G151",
            Self::TooManyAssignments { .. } => "G152",
            Self::TooLong { .. } => "G153",
            Self::OtherDialect => "G154",
            Self::Argument { .. } => "G155",
        }
    }
}

impl From<FlowError> for GcodeErrorKind {
    fn from(error: FlowError) -> Self {
        Self::Flow(error)
    }
}

impl fmt::Display for FlowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Keyword => f.write_str(
                "an O word is followed by sub, endsub, call, return, if, elseif, else, endif, while, endwhile, do, repeat, endrepeat, break or continue; correct the word",
            ),
            Self::Label => f.write_str("an O word needs a number or a name in < >; write one"),
            Self::Condition => f.write_str("a condition or a number of repetitions stands in brackets; put it in [ ]"),
            Self::TextBehind => f.write_str("nothing may follow this statement in its line; put it in a line of its own"),
            Self::NoSuchProgram => {
                f.write_str("this subprogram is neither in the program nor in a file beside it; add it, or correct its name")
            }
            Self::NoSuchBlock { number } => write!(f, "no block has the number N{number}; correct the number or add the block"),
            Self::NoEnd => f.write_str("the end of this part of the program is missing; add the line that closes it"),
            Self::Unmatched => f.write_str("nothing that this line could belong to is open here; add its beginning or remove the line"),
            Self::ReturnOutside => f.write_str("a return outside of a subprogram; remove it"),
            Self::TooManyCalls { limit } => {
                write!(f, "more than {limit} calls inside each other; does a subprogram call itself?")
            }
            Self::TooManyOpen { limit } => {
                write!(f, "more than {limit} loops and conditions inside each other; make them fewer")
            }
            Self::TooManyArguments { limit } => write!(f, "a call takes {limit} arguments at most; pass fewer"),
            Self::TooManyAssignments { limit } => {
                write!(f, "more than {limit} parameters are set in one block; use several blocks")
            }
            Self::TooLong { limit } => {
                write!(f, "{limit} blocks were executed since the first loop or call; does a loop never end?")
            }
            Self::OtherDialect => f.write_str(
                "this statement belongs to the macro language of another control; name the control's dialect, or write it in the language of this one",
            ),
            Self::Argument { letter } => {
                write!(f, "{} cannot pass an argument here; use another letter", char::from(letter))
            }
        }
    }
}
