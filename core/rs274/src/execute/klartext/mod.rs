//! Conversational blocks: each becomes the words of G-code that do the same, at the places where its own words stand.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | which block does what; functions, feeds, tools, datum shifts |
//! | `path.rs` | lines, arcs, polar coordinates, the pole |
//! | `lead.rs` | APPR and DEP |
//! | `cycle.rs` | CYCL DEF, CYCL CALL, M99: holes |
//!
//! What the control does by itself is that of a TNC: radius compensation begins and ends beside the first and the last
//! point of the contour, at right angles to it; FMAX counts for its block; a tool call lifts the tool, as M6 does.

mod cycle;
mod lead;
mod path;

use super::super::block::BlockWords;
use super::super::flow::{Next, Sentence};
use super::super::{
    Canon, CornerError, Decimal, GcodeError, GcodeErrorKind, KlartextError, Line, Lines, Number, Span, Statement,
    Units, WarningKind, Word, klartext_letter as letter,
};
use super::Execution;
use super::klartext_memory::{Asked, LOWERED, Lowered};
use truepath_units::Position;

impl<'p> Execution<'p, '_, '_> {
    /// Executes a conversational block; tells where the program goes on.
    pub(super) fn klartext(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        let next = self.klartext_block(sentence);
        next.map_err(|error| placed(error, sentence.text))
    }

    fn klartext_block(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        if let Some(span) = sentence.comment {
            let body = Span { start: span.start.saturating_add(1), len: span.len.saturating_sub(1) };
            self.emit(Canon::Comment(body), span)?;
        }
        if let Some(span) = sentence.block_delete {
            if self.options.skip_block_delete {
                self.warn(WarningKind::BlockDeleteSkipped, span);
                return Ok(Next::Continue);
            }
            self.warn(WarningKind::BlockDeleteExecuted, span);
        }
        let span = self.block_span();
        match sentence.statement {
            Statement::Begin(units) => {
                self.units_given = true;
                self.modal.units = units;
                self.emit(Canon::Units(units), span)?;
            }
            Statement::End => {
                self.end = Some(2);
                self.emit(Canon::End(2), span)?;
                return Ok(Next::End);
            }
            Statement::Line
            | Statement::Arc
            | Statement::RadiusArc
            | Statement::TangentArc
            | Statement::PolarLine
            | Statement::PolarArc
            | Statement::PolarTangentArc => return self.path(sentence),
            Statement::Pole => self.set_pole(sentence)?,
            Statement::Rounding | Statement::Chamfer => self.corner_block(sentence)?,
            Statement::Approach(form, polar) => return self.approach(sentence, form, polar),
            Statement::Depart(form, polar) => return self.depart(sentence, form, polar),
            Statement::ToolCall => return self.tool_call(sentence),
            Statement::Functions | Statement::Stop => return self.functions_alone(sentence),
            Statement::Cycle(number, part) => self.cycle_block(sentence, number, part)?,
            Statement::CycleCall => return self.cycle_call_block(sentence),
            Statement::Empty
            | Statement::Passed
            | Statement::Label
            | Statement::Call
            | Statement::Function(_)
            | Statement::Assignment => {}
        }
        Ok(Next::Continue)
    }

    /// RND and CHF, which the line before them has taken.
    fn corner_block(&mut self, sentence: &Sentence<'p>) -> Result<(), GcodeError> {
        if !core::mem::take(&mut self.klartext.corner_taken) {
            return Err(self.error(CornerError::WithoutLine.into(), self.block_span()));
        }
        if let Some(word) = sentence.words.iter().find(|w| matches!(w.letter, letter::FEED | letter::FEED_PER_TURN)) {
            self.warn(WarningKind::FeedOfCorner, word.span);
        }
        Ok(())
    }

    /// M and F words without a move.
    fn functions_alone(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        let mut words = Lowered::new();
        if sentence.statement == Statement::Stop {
            self.put(&mut words, b'M', Number::ZERO, self.block_span())?;
        }
        let asked = self.functions(sentence, &mut words)?;
        self.feeds(sentence, &mut words)?;
        self.refuse_others(sentence, &[])?;
        let next = self.lower(sentence, &words)?;
        self.carry_out(asked)?;
        Ok(next)
    }

    /// Executes words of G-code in place of those of the block.
    fn lower(&mut self, sentence: &Sentence<'p>, words: &Lowered) -> Result<Next, GcodeError> {
        let mut lowered = Sentence::new(sentence.text);
        lowered.line = sentence.line;
        lowered.source = sentence.source;
        for word in words {
            lowered.push(*word).map_err(|kind| self.error(kind, word.span))?;
        }
        let mut block = BlockWords::of(&lowered.words);
        block.gather(&lowered, self.options.dialect)?;
        self.execute(&mut block)
    }

    fn put(&self, words: &mut Lowered, letter: u8, value: Number, span: Span) -> Result<(), GcodeError> {
        let limit = GcodeErrorKind::TooManyWords { limit: LOWERED as u8 };
        words.push(Word { letter, value, span }).map_err(|_| self.error(limit, span))
    }

    /// A code of G, by its number in tenths.
    fn put_code(&self, words: &mut Lowered, tenths: i64, span: Span) -> Result<(), GcodeError> {
        let value = Decimal::new(tenths, 1).map_or(Number::ZERO, Number::Exact);
        self.put(words, b'G', value, span)
    }

    /// A place of an axis as a number of the program.
    fn written(&self, place: Position) -> Number {
        match self.modal.units {
            Units::Millimetres => Decimal::new(place.nm(), 6).map_or(Number::ZERO, Number::Exact),
            units => Number::Computed(Number::of_nanometres(place.nm(), units)),
        }
    }

    /// FMAX, F, FAUTO, FU of a block; whether it is one of FMAX.
    fn feeds(&mut self, sentence: &Sentence<'p>, words: &mut Lowered) -> Result<bool, GcodeError> {
        let mut rapid = false;
        let mut of_function = false;
        for word in &sentence.words {
            match word.letter {
                letter::FUNCTION => of_function = word.value.exactly_times(1) == Some(103),
                letter::RAPID => rapid = true,
                letter::FEED if core::mem::take(&mut of_function) => {}
                letter::FEED => self.put(words, b'F', word.value, word.span)?,
                letter::FEED_PER_TURN => {
                    self.put_code(words, 950, word.span)?;
                    self.put(words, b'F', word.value, word.span)?;
                }
                letter::FEED_OF_TOOL => {
                    if let Some(feed) = self.klartext.feed_of_tool {
                        self.put(words, b'F', feed.value, word.span)?;
                    }
                }
                _ => {}
            }
        }
        Ok(rapid)
    }

    /// M functions of a block.
    fn functions(&mut self, sentence: &Sentence<'p>, words: &mut Lowered) -> Result<Asked, GcodeError> {
        let mut asked = Asked::default();
        for word in sentence.words.iter().filter(|w| w.letter == letter::FUNCTION) {
            let (m, span) = (self.whole(*word)?, word.span);
            let refused = Err(self.error(KlartextError::Machine { m }.into(), span));
            match m {
                0..=5 | 7..=9 | 30 => self.put(words, b'M', word.value, span)?,
                // TOOL CALL has changed it.
                6 => {}
                13 | 14 => {
                    let turn = Decimal::new(i64::from(m).saturating_sub(10), 0).map_or(Number::ZERO, Number::Exact);
                    self.put(words, b'M', turn, span)?;
                    let flood = Decimal::new(8, 0).map_or(Number::ZERO, Number::Exact);
                    self.put(words, b'M', flood, span)?;
                }
                89 => self.klartext.calls_cycle = true,
                99 => {
                    self.klartext.calls_cycle = false;
                    asked.cycle = true;
                }
                91 | 92 => asked.machine = true,
                97 | 98 if self.modal.compensated => return refused,
                114 | 118 | 128 | 130 => return refused,
                136 => self.put_code(words, 950, span)?,
                137 => self.put_code(words, 940, span)?,
                140 => asked.lift = Some(span),
                // Rotary axes, look-ahead, wear and feeds in corners: no place depends on them.
                90
                | 94
                | 97
                | 98
                | 101..=103
                | 107..=113
                | 115..=117
                | 120
                | 124
                | 126
                | 127
                | 129
                | 134
                | 135
                | 138
                | 141
                | 143..=145
                | 148..=150
                | 197 => self.emit(Canon::OtherM(m), span)?,
                _ => {
                    self.warn(WarningKind::UnknownM { m }, span);
                    self.emit(Canon::OtherM(m), span)?;
                }
            }
        }
        Ok(asked)
    }

    /// What functions ask for behind the move: M99, M140.
    fn carry_out(&mut self, asked: Asked) -> Result<(), GcodeError> {
        if let Some(span) = asked.lift {
            self.forget(2);
            let via = self.at;
            self.emit(Canon::Reference { second: false, axes: [false, false, true], via }, span)?;
        }
        if asked.cycle { self.call_cycle() } else { Ok(()) }
    }

    /// Refuses words that neither the block nor every block has.
    fn refuse_others(&self, sentence: &Sentence<'p>, of_block: &[&[u8]]) -> Result<(), GcodeError> {
        let common = [
            letter::FUNCTION,
            letter::FEED,
            letter::FEED_PER_TURN,
            letter::FEED_OF_TOOL,
            letter::RAPID,
            letter::OTHER,
            letter::LIFT,
        ];
        let known = |w: &&Word| common.contains(&w.letter) || of_block.iter().any(|of| of.contains(&w.letter));
        match sentence.words.iter().find(|w| !known(w)) {
            Some(word) => Err(self.error(KlartextError::Word.into(), word.span)),
            None => Ok(()),
        }
    }

    /// TOOL CALL: the tool, its speed, its feed and by how much it differs from the table.
    fn tool_call(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        let mut words = Lowered::new();
        let of = |wanted: u8| sentence.words.iter().find(|w| w.letter == wanted).copied();
        if let Some(axis) = of(letter::TOOL_AXIS).filter(|w| w.value.exactly_times(1) != Some(2)) {
            return Err(self.error(KlartextError::ToolAxis.into(), axis.span));
        }
        let changes = of(letter::TOOL).or(of(letter::TOOL_NAME));
        if let Some(tool) = changes {
            let name = if tool.letter == letter::TOOL { b'T' } else { b't' };
            self.put(&mut words, name, tool.value, tool.span)?;
            let six = Decimal::new(6, 0).map_or(Number::ZERO, Number::Exact);
            self.put(&mut words, b'M', six, tool.span)?;
            let oversize = of(letter::LARGER).map(|word| self.length(word)).transpose()?;
            self.klartext.oversize = oversize.unwrap_or_default();
            self.klartext.feed_of_tool = None;
            self.klartext.direction = None;
        }
        if let Some(speed) = of(letter::SPEED) {
            self.put(&mut words, b'S', speed.value, speed.span)?;
        }
        if let Some(feed) = of(letter::FEED) {
            self.klartext.feed_of_tool = Some(feed);
            self.put(&mut words, b'F', feed.value, feed.span)?;
        }
        self.refuse_others(
            sentence,
            &[&[
                letter::TOOL,
                letter::TOOL_NAME,
                letter::TOOL_AXIS,
                letter::SPEED,
                letter::LONGER,
                letter::LARGER,
                letter::LARGER_EDGE,
            ]],
        )?;
        self.lower(sentence, &words)
    }
}

/// An error whose bytes lie in another line than the one that was executed, as those of RND do, with its own line.
fn placed(error: GcodeError, text: &[u8]) -> GcodeError {
    let holds = |line: &Line<'_>| line.start <= error.start && error.start <= line.span().end();
    match Lines::new(text).find(holds) {
        Some(line) if line.number != error.line => GcodeError::new(error.kind, &line, error.span()).in_file(error.file),
        _ => error,
    }
}
