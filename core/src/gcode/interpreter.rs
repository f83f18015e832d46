//! Blocks → canonical moves: the modal interpreter.
//!
//! One block at a time, in the order of execution of RS274/NGC (NIST 6556 table 8), not in the order of the text; the
//! one difference is that a unit code acts before the F of its own block, as Fanuc, Haas and grbl do (with a
//! warning). Every word must be used by some code of its block; anything else is an error with its place.
//!
//! Positions are what the program says, in its own coordinates: at the start, and after whatever moves an axis to a
//! place that the program does not name (G28, G53, a new offset, a tool change), they are unknown and stay so until
//! given in G90.
//!
//! Limits: three axes, the XY plane, feed per minute; no cutter radius compensation (G41 and G42 tell the side of the
//! wall), no parameters, subprograms or cycles. Those are refused by name.

use super::block::BlockWords;
use super::frame::Frame;
use super::{
    Axes, Canon, Event, GcodeError, GcodeErrorKind, Line, Lines, Modal, Source, Span, Token, Units, WarningKind,
    Warnings, Words, is_marked_corrected, program_crc,
};

/// What the program does not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The unit until G20 or G21.
    pub units: Units,
    /// Where the axes stand at the start.
    pub start: Axes,
    /// Whether blocks with `/` are skipped.
    pub skip_block_delete: bool,
}

impl Default for Options {
    /// Millimetres, positions unknown, `/` blocks executed.
    fn default() -> Self {
        Self { units: Units::Millimetres, start: Axes::UNKNOWN, skip_block_delete: false }
    }
}

/// What is known of a program after it was read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramSummary {
    /// O word.
    pub number: Option<u32>,
    /// The M code that ended it, 2 or 30.
    pub end: Option<u32>,
    /// Lines read, to the end of the program.
    pub lines: u32,
    /// [`program_crc`] of the bytes.
    pub crc: u32,
    /// Whether it carries the mark of a corrected program.
    pub already_corrected: bool,
    /// What deserves a look.
    pub warnings: Warnings,
}

/// Reads programs as a machine would.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interpreter {
    options: Options,
}

impl Interpreter {
    /// With what the program does not say.
    pub const fn new(options: Options) -> Self {
        Self { options }
    }

    /// Executes a program from its first block to M2, M30 or the last line, and gives each step to `sink`.
    ///
    /// # Errors
    /// The first thing that is not understood, or what `sink` answers, with the place of the block.
    pub fn run<S>(&self, program: &[u8], sink: &mut S) -> Result<ProgramSummary, GcodeError>
    where
        S: FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
    {
        let frame = Frame::of(program);
        let mut warnings = Warnings::default();
        frame.warn(&mut warnings);
        let mut execution = Execution {
            options: self.options,
            modal: Modal::initial(self.options.units),
            at: self.options.start,
            units_given: false,
            program_number: None,
            end: None,
            warnings,
            line: Line { number: 1, start: 0, text: &[] },
            source: Source { line: 1, block: Span::default(), number: None, block_delete: false },
            sink,
        };
        for line in Lines::new(program).filter(|l| frame.holds(l.number)) {
            execution.line = line;
            if execution.end.is_none() {
                execution.line()?;
            } else if frame.is_text(&line) {
                execution.warn(WarningKind::TextAfterEnd, line.span());
                break;
            }
        }
        if execution.end.is_none() {
            execution.warn(WarningKind::EndMissing, execution.line.span());
        }
        Ok(ProgramSummary {
            number: execution.program_number,
            end: execution.end,
            lines: execution.source.line,
            crc: program_crc(program),
            already_corrected: is_marked_corrected(program),
            warnings: execution.warnings,
        })
    }
}

/// The machine while it executes a program. Its parts: `execute.rs` (modes), `motion.rs` (moves).
pub(super) struct Execution<'p, 's, S> {
    pub(super) options: Options,
    pub(super) modal: Modal,
    pub(super) at: Axes,
    pub(super) units_given: bool,
    pub(super) program_number: Option<u32>,
    pub(super) end: Option<u32>,
    warnings: Warnings,
    line: Line<'p>,
    source: Source,
    sink: &'s mut S,
}

impl<S> Execution<'_, '_, S>
where
    S: FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
{
    fn line(&mut self) -> Result<(), GcodeError> {
        let mut block = BlockWords::gather(&self.line)?;
        self.source = Source {
            line: self.line.number,
            block: self.line.span(),
            number: block.number,
            block_delete: block.block_delete.is_some(),
        };
        if block.has_comments {
            self.comments()?;
        }
        if let Some(span) = block.block_delete {
            if self.options.skip_block_delete {
                self.warn(WarningKind::BlockDeleteSkipped, span);
                return Ok(());
            }
            self.warn(WarningKind::BlockDeleteExecuted, span);
        }
        self.execute(&mut block)
    }

    fn comments(&mut self) -> Result<(), GcodeError> {
        for token in Words::new(self.line) {
            if let Token::Comment { span, body } = token? {
                self.emit(Canon::Comment(body), span)?;
            }
        }
        Ok(())
    }

    /// Gives one step to the sink; what it answers is an error at `span`.
    pub(super) fn emit(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        let event = Event { canon, source: self.source, modal: &self.modal };
        (self.sink)(&event).map_err(|kind| self.error(kind, span))
    }

    pub(super) fn error(&self, kind: GcodeErrorKind, span: Span) -> GcodeError {
        GcodeError::new(kind, &self.line, span)
    }

    pub(super) fn warn(&mut self, kind: WarningKind, span: Span) {
        self.warnings.note(kind, &self.line, span);
    }

    /// The bytes of the block without the blanks around them.
    pub(super) fn block_span(&self) -> Span {
        let text = self.line.text;
        let lead = text.len().saturating_sub(text.trim_ascii_start().len());
        Span { start: self.line.start.saturating_add(lead), len: text.trim_ascii().len() }
    }
}
