//! Where a program goes on behind a block.

use super::super::Span;

/// What follows a block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(dead_code, reason = "jumps are answered as their codes are executed")]
pub(in super::super) enum Next {
    /// The block behind it.
    Continue,
    /// M98, G65, M97: a subprogram, a number of times, or a block of this program.
    Call {
        /// What is called.
        target: Target,
        /// How often, at least once.
        times: u32,
        /// Whether the words of the block are its arguments (G65).
        arguments: bool,
        /// Where it is written.
        span: Span,
    },
    /// M99: back to the caller, or to the block with this number.
    Return {
        /// P.
        to: Option<u32>,
        /// Where it is written.
        span: Span,
    },
    /// To the block with this number.
    Jump {
        /// The number.
        to: u32,
        /// Where it is written.
        span: Span,
    },
    /// M2, M30: the program ends.
    End,
}

/// What a call leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Target {
    /// Program `O…`, in this text or the library.
    Program(u32),
    /// Block `N…` of this text.
    Block(u32),
}
