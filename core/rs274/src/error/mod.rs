//! What can be wrong with a program, and where.
//!
//! Every kind has a code that never changes its meaning (`G00…` lexical, `G02…` one block, `G03…` a code, `G04…` motion,
//! `G05…` arcs and corners, `G11…` corners, `G07…` the contour, `G08…` parameters, `G12…` and `G13…` cutter compensation,
//! `G14…` and `G15…` the order of blocks, `G16…` and
//! `G17…` expressions, `G18…` … `G21…` conversational programs) and carries both sides of a mismatch.

mod compensation;
mod corner;
mod cycle;
mod expression;
mod flow;
mod kind;
mod klartext;
mod parameter;
mod setting;

use core::fmt;

use super::{Line, Span};

pub use compensation::CompensationError;
pub use corner::CornerError;
pub use cycle::CycleError;
pub use expression::ExpressionError;
pub use flow::FlowError;
pub use kind::{Foreign, GcodeErrorKind};
pub use klartext::KlartextError;
pub use parameter::ParameterError;
pub use setting::SettingError;

/// What is wrong, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GcodeError {
    /// What is wrong.
    pub kind: GcodeErrorKind,
    /// The file: 0 for the program, otherwise the number its library gives it.
    pub file: u16,
    /// Line, counted from 1.
    pub line: u32,
    /// Column of the first offending byte, in bytes, counted from 1.
    pub column: u32,
    /// Offset of that byte from the start of the program.
    pub start: usize,
    /// Number of offending bytes.
    pub len: usize,
}

impl GcodeError {
    /// An error at a span of a line.
    pub(super) fn new(kind: GcodeErrorKind, line: &Line<'_>, span: Span) -> Self {
        let column = span.start.saturating_sub(line.start).saturating_add(1);
        let column = u32::try_from(column).unwrap_or(u32::MAX);
        Self { kind, file: 0, line: line.number, column, start: span.start, len: span.len }
    }
    /// The same error in another file.
    pub(super) const fn in_file(self, file: u16) -> Self {
        Self { file, ..self }
    }
    /// The offending bytes.
    pub const fn span(&self) -> Span {
        Span { start: self.start, len: self.len }
    }
}

impl fmt::Display for GcodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}: {}", self.line, self.column, self.kind.code(), self.kind)
    }
}

impl core::error::Error for GcodeError {}
