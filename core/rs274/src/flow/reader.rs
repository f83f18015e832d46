//! Walks a program: block after block, each with the values of its words.

use super::super::expression::{Evaluator, Fault};
use super::super::lexical::{Token, Words, spelled, trimmed};
use super::super::parameter::Surroundings;
use super::super::{Dialect, FlowError, Foreign, GcodeError, GcodeErrorKind, Line, Number, Options, Source, Span};
use super::Program;
use super::frame::Frame;
use super::open::{CALLS, Call, CallKind, OpenList};
use super::place::Place;
use super::plain;
use super::sentence::{ASSIGNMENTS, Assignments, Sentence, Word};

/// The place in a program, and what has led there.
#[derive(Debug)]
pub(in super::super) struct Reader<'p> {
    pub(super) program: Program<'p>,
    pub(super) dialect: Dialect,
    as_linuxcnc: bool,
    pub(super) place: Place<'p>,
    pub(super) calls: heapless::Vec<Call<'p>, CALLS>,
    pub(super) open: OpenList<'p>,
    pub(super) jumps: u32,
    pub(super) ended: bool,
    /// The line being read.
    pub(super) line: Line<'p>,
    frame: Frame<'p>,
    pub(super) skip_block_delete: bool,
    block_limit: u32,
    blocks: u32,
}

/// What a line turned out to be.
pub(super) enum Read {
    Empty,
    Block,
    /// A statement that steers the program.
    Control(Span),
}

impl<'p> Reader<'p> {
    /// A reader before the first block.
    pub(in super::super) fn new(program: Program<'p>, options: &Options) -> Self {
        Self {
            program,
            dialect: options.dialect,
            as_linuxcnc: options.is_linuxcnc_itself(),
            place: Place::start_of(program.text, 0),
            calls: heapless::Vec::new(),
            open: OpenList::default(),
            jumps: 0,
            ended: false,
            line: Line { number: 1, start: 0, text: &[] },
            frame: if options.dialect.is_klartext() { Frame::WHOLE } else { Frame::of(program.text) },
            skip_block_delete: options.skip_block_delete,
            block_limit: options.block_limit,
            blocks: 0,
        }
    }

    /// Which part of the file is the program.
    pub(in super::super) const fn frame(&self) -> &Frame<'p> {
        &self.frame
    }

    /// Reads the next block to be executed; `false` when there is none.
    pub(in super::super) fn next(
        &mut self,
        machine: &mut impl Surroundings,
        sentence: &mut Sentence<'p>,
    ) -> Result<bool, GcodeError> {
        while !self.ended {
            let Some(line) = self.place.lines.next() else {
                self.end_of_text(machine)?;
                continue;
            };
            if self.place.file == 0 && !self.frame.holds(line.number) {
                continue;
            }
            self.line = line;
            self.count()?;
            match self.read(machine, sentence)? {
                Read::Empty => {}
                Read::Block => return Ok(true),
                #[cfg(feature = "klartext")]
                Read::Control(_) if self.dialect.is_klartext() => self.steer_klartext(machine)?,
                Read::Control(span) => self.steer(span, machine)?,
            }
        }
        Ok(false)
    }

    /// The first line with text behind the end of the program, unless that is a subprogram.
    pub(in super::super) fn text_after_end(&mut self) -> Option<Line<'p>> {
        // Labels stand behind M30.
        if !self.calls.is_empty() || self.dialect.is_klartext() {
            return None;
        }
        let (lines, frame) = (&mut self.place.lines, &self.frame);
        let text = |line: &Line<'_>| frame.holds(line.number) && frame.is_text(line);
        let is_program = |line: &Line<'_>| matches!(trimmed(line.text).first(), Some(b'O' | b'o' | b':'));
        lines.find(text).filter(|line| !is_program(line))
    }

    /// Counts blocks from the first jump on: without one, a program ends.
    fn count(&mut self) -> Result<(), GcodeError> {
        if self.jumps > 0 {
            self.blocks = self.blocks.saturating_add(1);
            if self.blocks > self.block_limit {
                return Err(self.error(FlowError::TooLong { limit: self.block_limit }, self.line.span()));
            }
        }
        Ok(())
    }

    fn read(&self, machine: &mut impl Surroundings, sentence: &mut Sentence<'p>) -> Result<Read, GcodeError> {
        let line = self.line;
        machine.reading(line.number);
        sentence.text = self.place.text;
        sentence.line = line;
        sentence.source = Source {
            file: self.place.file,
            line: line.number,
            block: line.span(),
            number: None,
            block_delete: false,
            depth: self.calls.len() as u8,
            jumps: self.jumps,
        };
        sentence.words.clear();
        sentence.block_delete = None;
        sentence.has_comments = false;
        sentence.remark = None;
        #[cfg(feature = "klartext")]
        if self.dialect.is_klartext() {
            return self.klartext(machine, sentence);
        }
        sentence.is_plain = plain::read(&line, sentence);
        if sentence.is_plain {
            return Ok(Read::Block);
        }
        sentence.remark = plain::remark(&line);
        sentence.has_comments = sentence.remark.is_some();
        if sentence.has_comments { Ok(Read::Block) } else { self.tokens(machine, sentence) }
    }

    /// Reads a line token by token.
    // Not beside the short way, which needs no room on the stack.
    #[inline(never)]
    fn tokens(&self, machine: &mut impl Surroundings, sentence: &mut Sentence<'p>) -> Result<Read, GcodeError> {
        let line = self.line;
        let mut assignments = Assignments::new();
        let mut begun = false;
        for token in Words::new(line) {
            let token = token.map_err(|e| e.in_file(self.place.file))?;
            self.check_siemens(&token)?;
            match token {
                Token::Word(word) if word.letter != b'N' => {
                    begun = true;
                    let value = match word.value {
                        Some(value) => Number::Exact(value),
                        None => match self.value(machine, word.span, self.before_value(word.span))? {
                            Some(value) => Number::Computed(value),
                            None => continue,
                        },
                    };
                    let word = Word { letter: word.letter, value, span: word.span };
                    sentence.push(word).map_err(|kind| self.error(kind, word.span))?;
                }
                Token::Word(word) => {
                    if begun {
                        return Err(self.error(GcodeErrorKind::OutOfPlace { letter: b'N' }, word.span));
                    }
                    let before = core::mem::replace(&mut sentence.source.number, word.value);
                    if before.is_some() {
                        return Err(self.error(GcodeErrorKind::DuplicateWord { letter: b'N' }, word.span));
                    }
                }
                Token::Comment { span, body } => {
                    let nested = body.end() < span.end() && body.of(self.place.text).contains(&b')');
                    if nested && self.as_linuxcnc {
                        return Err(self.error(GcodeErrorKind::StrayParenthesis, span));
                    }
                    sentence.has_comments = true;
                }
                Token::Percent(_) => {}
                Token::BlockDelete { span, .. } => {
                    if begun || sentence.block_delete.is_some() {
                        return Err(self.error(GcodeErrorKind::OutOfPlace { letter: b'/' }, span));
                    }
                    sentence.block_delete = Some(span);
                    sentence.source.block_delete = true;
                    if self.skip_block_delete {
                        return Ok(Read::Block);
                    }
                }
                Token::Corner(word) => {
                    begun = true;
                    let letter = word.letter.to_ascii_lowercase();
                    let skipped = word.span.len.saturating_sub(self.behind_letter(word.span));
                    let value = match word.value {
                        Some(value) => Number::Exact(value),
                        None => match self.value(machine, word.span, skipped)? {
                            Some(value) => Number::Computed(value),
                            None => continue,
                        },
                    };
                    let word = Word { letter, value, span: word.span };
                    sentence.push(word).map_err(|kind| self.error(kind, word.span))?;
                }
                Token::Assignment(span) => {
                    begun = true;
                    let assignment = self.assignment(machine, span)?;
                    let limit = ASSIGNMENTS as u8;
                    let full = |_| self.error(FlowError::TooManyAssignments { limit }, span);
                    assignments.push(assignment).map_err(full)?;
                }
                Token::Control(span) => return Ok(Read::Control(span)),
            }
        }
        // The number of a program is none inside of a subprogram that an O word has begun.
        if self.calls.last().is_some_and(|call| call.kind == CallKind::Sub)
            && let Some(word) = sentence.words.iter().find(|word| word.letter == b'O')
        {
            return Err(self.error(FlowError::Keyword, word.span));
        }
        self.assign(machine, &assignments)?;
        let empty = sentence.words.is_empty() && !sentence.has_comments && sentence.block_delete.is_none();
        Ok(if empty { Read::Empty } else { Read::Block })
    }

    /// Refuses a word of Siemens' own language in another dialect.
    fn check_siemens(&self, token: &Token) -> Result<(), GcodeError> {
        let first = self.rest(token.span().start).first().map(u8::to_ascii_uppercase);
        let foreign = match token {
            Token::Word(word) => {
                matches!((first, word.letter), (Some(b'C'), b'R') | (Some(b'S' | b'T' | b'A'), b'G') | (_, b't'))
            }
            Token::Comment { .. } | Token::Corner(_) => first.is_some_and(|byte| byte.is_ascii_alphabetic()),
            _ => false,
        };
        if self.dialect == Dialect::Siemens {
            return Ok(());
        }
        if foreign {
            return Err(self.error(GcodeErrorKind::ForeignDialect(Foreign::Siemens), token.span()));
        }
        let behind = self.rest(token.span().start).get(1..).map(trimmed);
        if matches!(token, Token::Word(_)) && behind.is_some_and(|rest| rest.first() == Some(&b'=')) {
            return Err(self.error(GcodeErrorKind::Stray(b'='), token.span()));
        }
        Ok(())
    }

    /// Bytes of a word before its value: its letter, or `CR=`.
    fn before_value(&self, span: Span) -> usize {
        let text = self.rest(span.start);
        let equals =
            spelled(text, b"CR").and_then(|len| text.get(len..)).map(trimmed).and_then(|r| r.strip_prefix(b"="));
        equals.map_or(1, |rest| text.len().saturating_sub(rest.len()))
    }

    /// Bytes of a corner word behind its letter.
    fn behind_letter(&self, span: Span) -> usize {
        let text = self.rest(span.start).get(..span.len).unwrap_or(&[]);
        text.iter().position(u8::is_ascii_alphabetic).map_or(0, |n| span.len.saturating_sub(n).saturating_sub(1))
    }

    /// The line from an offset of the file on.
    pub(super) fn rest(&self, start: usize) -> &'p [u8] {
        self.line.text.get(start.saturating_sub(self.line.start)..).unwrap_or(&[])
    }

    /// The value of a word behind its first `skipped` bytes; `None` for a vacant parameter.
    fn value(&self, machine: &impl Surroundings, span: Span, skipped: usize) -> Result<Option<f64>, GcodeError> {
        let (value, rest) = self.evaluate(machine, self.rest(span.start.saturating_add(skipped)), false)?;
        self.ends_at(rest, span.end())?;
        Ok(if value.is_nan() { None } else { Some(value) })
    }

    /// The value at the start of a rest of the line, and what follows it.
    pub(super) fn evaluate(
        &self,
        machine: &impl Surroundings,
        text: &'p [u8],
        open: bool,
    ) -> Result<(f64, &'p [u8]), GcodeError> {
        Evaluator::new(machine, self.dialect).value(text, open).map_err(|fault| self.fault(fault))
    }

    /// What the lexer measured must be what was computed.
    pub(super) fn ends_at(&self, rest: &[u8], end: usize) -> Result<(), GcodeError> {
        let at = self.line.span().end().saturating_sub(rest.len());
        if at == end {
            return Ok(());
        }
        let byte = trimmed(rest).first().copied().unwrap_or(b' ');
        Err(self.error(GcodeErrorKind::UnexpectedByte(byte), Span { start: at, len: 1 }))
    }

    /// An error at bytes of the present line.
    pub(super) fn error(&self, kind: impl Into<GcodeErrorKind>, span: Span) -> GcodeError {
        GcodeError::new(kind.into(), &self.line, span).in_file(self.place.file)
    }

    fn fault(&self, fault: Fault) -> GcodeError {
        let end = self.line.span().end();
        let span = Span { start: end.saturating_sub(fault.from), len: fault.from.saturating_sub(fault.to).max(1) };
        self.error(fault.kind, span)
    }
}
