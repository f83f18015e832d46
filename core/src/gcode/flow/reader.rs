//! Walks a program: block after block, each with the values of its words.

use super::super::lexical::{Token, Words};
use super::super::parameter::Surroundings;
use super::super::{GcodeError, GcodeErrorKind, Line, Lines, Number, Source};
use super::Program;
use super::frame::Frame;
use super::next::Next;
use super::sentence::{Sentence, Word};

/// The place in a program.
#[derive(Debug)]
pub(in super::super) struct Reader<'p> {
    program: Program<'p>,
    frame: Frame<'p>,
    lines: Lines<'p>,
    ended: bool,
}

impl<'p> Reader<'p> {
    /// Before the first block.
    pub(in super::super) fn new(program: Program<'p>) -> Self {
        let frame = Frame::of(program.text);
        Self { program, frame, lines: Lines::new(program.text), ended: false }
    }

    /// Which part of the file is the program.
    pub(in super::super) const fn frame(&self) -> &Frame<'p> {
        &self.frame
    }

    /// Reads the next block to be executed; `false` when there is none.
    pub(in super::super) fn next<'m>(
        &mut self,
        _machine: &mut dyn Surroundings<'m>,
        sentence: &mut Sentence<'p>,
    ) -> Result<bool, GcodeError> {
        if self.ended {
            return Ok(false);
        }
        loop {
            let Some(line) = self.lines.next() else {
                return Ok(false);
            };
            if self.frame.holds(line.number) {
                self.read(line, sentence)?;
                return Ok(true);
            }
        }
    }

    /// Goes where a block leads.
    pub(in super::super) fn follow(&mut self, next: Next) {
        self.ended = next == Next::End;
    }

    /// The first line with text behind the end of the program.
    pub(in super::super) fn text_after_end(&mut self) -> Option<Line<'p>> {
        let (lines, frame) = (&mut self.lines, &self.frame);
        lines.find(|line| frame.holds(line.number) && frame.is_text(line))
    }

    fn read(&mut self, line: Line<'p>, sentence: &mut Sentence<'p>) -> Result<(), GcodeError> {
        sentence.text = self.program.text;
        sentence.line = line;
        sentence.source = Source { line: line.number, block: line.span(), ..Source::NONE };
        sentence.words.clear();
        sentence.block_delete = None;
        sentence.has_comments = false;
        let error = |kind, span| GcodeError::new(kind, &line, span);
        let mut begun = false;
        for token in Words::new(line) {
            match token? {
                Token::Comment { .. } => sentence.has_comments = true,
                Token::Percent(_) => {}
                Token::BlockDelete { span, .. } => {
                    if begun || sentence.block_delete.is_some() {
                        return Err(error(GcodeErrorKind::OutOfPlace { letter: b'/' }, span));
                    }
                    sentence.block_delete = Some(span);
                    sentence.source.block_delete = true;
                }
                Token::Word(word) => {
                    let unknown = || error(GcodeErrorKind::Expression(b'['), word.span);
                    let value = word.value.ok_or_else(unknown)?;
                    if word.letter == b'N' {
                        if begun {
                            return Err(error(GcodeErrorKind::OutOfPlace { letter: b'N' }, word.span));
                        }
                        if sentence.source.number.replace(value).is_some() {
                            return Err(error(GcodeErrorKind::DuplicateWord { letter: b'N' }, word.span));
                        }
                        continue;
                    }
                    begun = true;
                    let value = Number::Exact(value);
                    let word = Word { letter: word.letter, value, span: word.span };
                    sentence.push(word).map_err(|kind| error(kind, word.span))?;
                }
                Token::Corner(word) => {
                    let unknown = || error(GcodeErrorKind::Expression(b'['), word.span);
                    let value = Number::Exact(word.value.ok_or_else(unknown)?);
                    let word = Word { letter: word.letter.to_ascii_lowercase(), value, span: word.span };
                    sentence.push(word).map_err(|kind| error(kind, word.span))?;
                }
                Token::Assignment(span) => return Err(error(GcodeErrorKind::Expression(b'='), span)),
                Token::Control(span) => return Err(error(GcodeErrorKind::NamedProgram, span)),
            }
        }
        Ok(())
    }
}
