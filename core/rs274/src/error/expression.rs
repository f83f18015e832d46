//! Errors of expressions.

use core::fmt;

use super::GcodeErrorKind;

/// What is wrong with an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExpressionError {
    /// No number, parameter, function or bracket where one must stand.
    ValueMissing,
    /// A name that is no function.
    Function,
    /// Something else than an operator or `]` behind a value.
    Operator(u8),
    /// `[` without `]`.
    BracketNotClosed,
    /// `<` without `>`.
    NameNotClosed,
    /// `#<>`.
    NameEmpty,
    /// A name longer than is kept.
    NameTooLong {
        /// Bytes kept.
        limit: u8,
    },
    /// A number with more than 18 digits before its point.
    NumberTooLarge,
    /// More brackets and operators wait than there is room for.
    TooDeep {
        /// How many may wait.
        limit: u8,
    },
    /// `ATAN[y]` without `/[x]`.
    AtanNeedsTwo,
    /// `EXISTS` of something else than a parameter.
    ExistsWithoutParameter,
    /// Division by zero, or `MOD` of zero.
    DivisionByZero,
    /// A negative number to a power that is not whole.
    NegativePower,
    /// `ASIN` or `ACOS` beyond ±1.
    ArcOutOfRange,
    /// `LN` of zero or less.
    LogarithmOfNothing,
    /// `SQRT` of less than zero.
    RootOfNegative,
    /// The result is no finite number.
    NotFinite,
}

impl ExpressionError {
    /// The stable code of this kind.
    pub const fn code(self) -> &'static str {
        match self {
            Self::ValueMissing => "G160",
            Self::Function => "G161",
            Self::Operator(_) => "G162",
            Self::BracketNotClosed => "G163",
            Self::NameNotClosed => "G164",
            Self::NameEmpty => "G165",
            Self::NameTooLong { .. } => "G166",
            Self::NumberTooLarge => "G167",
            Self::TooDeep { .. } => "G168",
            Self::AtanNeedsTwo => "G169",
            Self::ExistsWithoutParameter => "G170",
            Self::DivisionByZero => "G171",
            Self::NegativePower => "G172",
            Self::ArcOutOfRange => "G173",
            Self::LogarithmOfNothing => "G174",
            Self::RootOfNegative => "G175",
            Self::NotFinite => "G176",
        }
    }
}

impl From<ExpressionError> for GcodeErrorKind {
    fn from(error: ExpressionError) -> Self {
        Self::Expression(error)
    }
}

impl fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match *self {
            Self::ValueMissing => "a number, a parameter, a function or `[` must stand here; write one",
            Self::Function => "this is no function; ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN are, with their argument in [ ]",
            Self::Operator(byte) => {
                return write!(f, "an operator or `]` must stand here, not `{}`; correct the expression", byte.escape_ascii());
            }
            Self::BracketNotClosed => "the bracket opened by `[` is not closed in this line; add `]`",
            Self::NameNotClosed => "the name opened by `<` is not closed in this line; add `>`",
            Self::NameEmpty => "a parameter without a name; write one between `<` and `>`",
            Self::NameTooLong { limit } => return write!(f, "a name has more than {limit} letters; use a shorter one"),
            Self::NumberTooLarge => "this number has more than 18 digits before its point; is a point missing?",
            Self::TooDeep { limit } => {
                return write!(f, "more than {limit} brackets and operators wait for each other; split the expression into several parameters");
            }
            Self::AtanNeedsTwo => "ATAN takes two numbers; write ATAN[y]/[x]",
            Self::ExistsWithoutParameter => "EXISTS takes one parameter; write EXISTS[#<name>]",
            Self::DivisionByZero => "this divides by zero; correct the divisor",
            Self::NegativePower => "a negative number has no power that is not whole; correct base or exponent",
            Self::ArcOutOfRange => "ASIN and ACOS take numbers from -1 to 1; correct the argument",
            Self::LogarithmOfNothing => "LN takes numbers above 0; correct the argument",
            Self::RootOfNegative => "SQRT takes no negative numbers; correct the argument",
            Self::NotFinite => "the result is too large to be a number; correct the expression",
        })
    }
}
