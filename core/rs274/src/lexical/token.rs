//! The pieces of a line.

use super::super::Span;
use super::Decimal;

/// A letter with what stands behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenWord {
    /// The letter, upper case.
    pub letter: u8,
    /// Its number; `None` when it is a parameter or an expression, whose value is not known without running the program.
    pub value: Option<Decimal>,
    /// From the letter to the last byte of the number.
    pub span: Span,
}

/// One piece of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token {
    /// A letter with its number.
    Word(WrittenWord),
    /// `,R` or `,C`: how the corner to the next move is cut.
    Corner(WrittenWord),
    /// `#… = …`: a parameter is set.
    Assignment(Span),
    /// The rest of a line that steers the program: `O100 sub`, `O<name> call`, `IF [..] GOTO 10`.
    Control(Span),
    /// A comment: everything including its parentheses or semicolon, and what is inside.
    Comment {
        /// With the parentheses or the semicolon.
        span: Span,
        /// Without them.
        body: Span,
    },
    /// `/` or `/1` … `/9`: the line may be switched off at the machine.
    BlockDelete {
        /// The bytes.
        span: Span,
        /// The switch, 1 when no digit is given.
        switch: u8,
    },
    /// `%` as the first character of a line, with nothing but comments or a program number after it; or a line that names
    /// the file, `%_N_PART_MPF` or `$PART.MIN%`.
    Percent(Span),
}

impl Token {
    /// Its bytes.
    pub const fn span(&self) -> Span {
        match *self {
            Self::Word(WrittenWord { span, .. })
            | Self::Corner(WrittenWord { span, .. })
            | Self::Comment { span, .. }
            | Self::BlockDelete { span, .. }
            | Self::Assignment(span)
            | Self::Control(span)
            | Self::Percent(span) => span,
        }
    }
}
