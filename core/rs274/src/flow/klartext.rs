//! Conversational programs: the values of the words of a block, labels, calls, repetitions, jumps and Q parameters.
//!
//! `CALL LBL 1` runs from `LBL 1` to `LBL 0` and returns; `CALL LBL 1 REP 3` goes back to `LBL 1` three times, so that
//! what lies between is executed four times in all. A rounding or a chamfer belongs to the line before it, whose end it
//! changes, and is read with it.

use super::super::expression::{arc_tangent, computed};
use super::super::klartext::{Formula, behind, comparison, parameter, written_number};
use super::super::lexical::{Operator, trimmed};
use super::super::parameter::Surroundings;
use super::super::{
    FlowError, GcodeError, GcodeErrorKind, KlartextBlock, KlartextError, KlartextValue, KlartextWord, Line, Lines,
    Number, Span, Statement, Word, klartext_letter,
};
use super::keyword::Label;
use super::open::{CallKind, Kind, Open};
use super::place::Place;
use super::reader::{Read, Reader};
use super::sentence::Sentence;

/// What cuts a corner, and its letter among the words of the line before it.
const CORNERS: [(Statement, u8); 2] =
    [(Statement::Rounding, klartext_letter::ROUNDING), (Statement::Chamfer, klartext_letter::CHAMFER)];
/// Repetitions of a part of the program; TNCs allow 65,534.
const REPETITIONS: u32 = 65_534;

impl<'p> Reader<'p> {
    /// Takes a line apart, and gives its words their values.
    pub(super) fn klartext(
        &self,
        machine: &mut impl Surroundings,
        sentence: &mut Sentence<'p>,
    ) -> Result<Read, GcodeError> {
        let block = KlartextBlock::of(self.line).map_err(|e| e.in_file(self.place.file))?;
        sentence.statement = block.statement;
        sentence.rest = block.span_of(block.rest());
        sentence.comment = block.comment;
        sentence.has_comments = block.comment.is_some();
        sentence.block_delete = block.delete;
        sentence.source.block_delete = block.delete.is_some();
        if block.delete.is_some() && self.skip_block_delete {
            return Ok(Read::Block);
        }
        if block.statement.is_control() {
            return Ok(Read::Control(block.head));
        }
        for word in block.words() {
            let word = word.map_err(|e| e.in_file(self.place.file))?;
            // A bare F, R or M says that nothing changes.
            if word.value == KlartextValue::None && word.letter != klartext_letter::LIFT {
                continue;
            }
            let value = self.klartext_value(machine, &word)?;
            let word = Word { letter: word.letter, value, span: word.span };
            sentence.push(word).map_err(|kind| self.error(kind, word.span))?;
        }
        if block.statement.is_path()
            && let Some(word) = self.corner_behind(machine)?
        {
            sentence.push(word).map_err(|kind| self.error(kind, word.span))?;
        }
        let nothing = block.statement == Statement::Empty && block.comment.is_none();
        Ok(if nothing { Read::Empty } else { Read::Block })
    }

    /// The value of a word; 0 where it has none.
    fn klartext_value(&self, machine: &impl Surroundings, word: &KlartextWord) -> Result<Number, GcodeError> {
        match word.value {
            KlartextValue::None => Ok(Number::ZERO),
            KlartextValue::Number(number) => Ok(Number::Exact(number)),
            KlartextValue::Parameter { .. } => {
                let start = word.value_span.start.saturating_sub(self.line.start);
                let text = self.line.text.get(start..).unwrap_or(&[]);
                Formula::new(machine.memory(), text)
                    .operand()
                    .map(Number::Computed)
                    .map_err(|kind| self.error(kind, word.span))
            }
        }
    }

    /// The rounding or chamfer that follows this block.
    fn corner_behind(&self, machine: &impl Surroundings) -> Result<Option<Word>, GcodeError> {
        for line in self.place.lines.clone() {
            // What cannot be read is refused when its turn comes.
            let Ok(block) = KlartextBlock::of(line) else { return Ok(None) };
            if block.statement == Statement::Empty {
                continue;
            }
            let Some((_, letter)) = CORNERS.into_iter().find(|(statement, _)| *statement == block.statement) else {
                return Ok(None);
            };
            if block.delete.is_some() && self.skip_block_delete {
                return Ok(None);
            }
            for word in block.words() {
                let word = word.map_err(|e| e.in_file(self.place.file))?;
                if word.letter == klartext_letter::RADIUS && word.value != KlartextValue::None {
                    let there = GcodeError::new(KlartextError::NumberMissing.into(), &line, word.span);
                    let value = match word.value {
                        KlartextValue::Number(number) => Number::Exact(number),
                        _ => {
                            let start = word.value_span.start.saturating_sub(line.start);
                            let text = line.text.get(start..).unwrap_or(&[]);
                            let value = Formula::new(machine.memory(), text).operand();
                            Number::Computed(value.map_err(|kind| GcodeError { kind, ..there })?)
                        }
                    };
                    return Ok(Some(Word { letter, value, span: word.span }));
                }
            }
            return Err(GcodeError::new(KlartextError::NumberMissing.into(), &line, block.head));
        }
        Ok(None)
    }

    /// Executes a block that steers the program or sets a parameter.
    pub(super) fn steer_klartext(&mut self, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let block = KlartextBlock::of(self.line).map_err(|e| e.in_file(self.place.file))?;
        let rest = trimmed(block.rest());
        let span = block.span_of(rest);
        match block.statement {
            Statement::Label => {
                let Some((label, rest)) = label_name(rest) else {
                    return Err(self.error(KlartextError::Label, block.head));
                };
                self.nothing_more(&block, rest)?;
                if label == Label::numbered(0) && !self.calls.is_empty() {
                    self.turn(machine);
                }
                Ok(())
            }
            Statement::Call => {
                let Some((label, rest)) = label_name(rest) else {
                    return Err(self.error(KlartextError::Label, block.head));
                };
                let rest = trimmed(rest);
                if rest.is_empty() {
                    let lines = self.behind_label(label, span)?;
                    let place = Place { lines, ..self.place.clone() };
                    return self.call(place, CallKind::Program, 1, block.head);
                }
                self.repeat_klartext(&block, label, rest, machine)
            }
            Statement::Function(number) => self.function(&block, number, machine),
            _ => self.assign_klartext(&block, None, machine),
        }
    }

    /// `REP 3`, `REP 3/2`: goes back to the label as many times, then on.
    fn repeat_klartext(
        &mut self,
        block: &KlartextBlock<'p>,
        label: Label,
        rest: &'p [u8],
        machine: &impl Surroundings,
    ) -> Result<(), GcodeError> {
        let wrong = self.error(KlartextError::Label, block.span_of(rest));
        let Some(rest) = rest.strip_prefix(b"REP").or_else(|| rest.strip_prefix(b"rep")) else { return Err(wrong) };
        let mut formula = Formula::new(machine.memory(), rest);
        let times = formula.operand().map_err(|kind| self.error(kind, block.span_of(rest)))?;
        let behind = trimmed(formula.rest);
        // The control writes how many are left behind a stroke.
        let counted = behind.strip_prefix(b"/").map_or(behind, |rest| {
            let rest = trimmed(rest);
            let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
            rest.get(digits..).unwrap_or(&[])
        });
        self.nothing_more(block, counted)?;
        let whole = Number::Computed(times).exactly_times(1).and_then(|n| u32::try_from(n).ok());
        let Some(times) = whole.filter(|n| *n <= REPETITIONS) else { return Err(wrong) };
        // The block itself names the repetition: one of it is open at a time on each level.
        let own = Label::numbered(self.line.number);
        let depth = self.calls.len() as u8;
        let left = match self.open.find(own, depth) {
            Some(Open { kind: Kind::Repeat(left), .. }) => *left,
            _ => {
                let behind = self.place.lines.clone();
                let before = behind.again(&self.line);
                let open = Open { label: own, kind: Kind::Repeat(times), before, behind, depth };
                self.open.open(open).map_err(|kind| self.error(kind, block.head))?;
                times
            }
        };
        if left == 0 {
            self.open.close(own, depth);
            return Ok(());
        }
        if let Some(open) = self.open.find(own, depth) {
            open.kind = Kind::Repeat(left.saturating_sub(1));
        }
        self.place.lines = self.behind_label(label, block.head)?;
        self.jumps = self.jumps.saturating_add(1);
        Ok(())
    }

    /// The lines behind a label of this file.
    fn behind_label(&self, wanted: Label, span: Span) -> Result<Lines<'p>, GcodeError> {
        let mut lines = Lines::new(self.place.text);
        while let Some(line) = lines.next() {
            if label_of(line) == Some(wanted) {
                return Ok(lines);
            }
        }
        Err(self.error(KlartextError::NoSuchLabel, span))
    }

    /// `FN 0` … `FN 13`.
    fn function(
        &mut self,
        block: &KlartextBlock<'p>,
        number: u8,
        machine: &mut impl Surroundings,
    ) -> Result<(), GcodeError> {
        if !(9..=12).contains(&number) {
            return self.assign_klartext(block, Some(number), machine);
        }
        let rest = trimmed(block.rest());
        let span = block.span_of(rest);
        let wrong = |reader: &Self| reader.error(KlartextError::Formula, span);
        let Some(condition) = word(rest, b"IF") else { return Err(wrong(self)) };
        let fault = |kind: GcodeErrorKind| self.error(kind, span);
        let mut formula = Formula::new(machine.memory(), condition);
        let left = formula.operand().map_err(fault)?;
        let Some((operator, rest)) = comparison(formula.rest) else { return Err(wrong(self)) };
        formula.rest = rest;
        let right = formula.operand().map_err(fault)?;
        let rest = word(trimmed(formula.rest), b"GOTO").and_then(|rest| word(trimmed(rest), b"LBL"));
        let Some((label, rest)) = rest.and_then(label_name) else {
            return Err(self.error(KlartextError::Label, span));
        };
        self.nothing_more(block, rest)?;
        if computed(operator, left, right).map_err(|kind| self.error(kind, span))? == 0.0 {
            return Ok(());
        }
        self.place.lines = self.behind_label(label, span)?;
        self.jumps = self.jumps.saturating_add(1);
        Ok(())
    }

    /// `Q1 = …`, as a formula or with the operation of an FN.
    fn assign_klartext(
        &self,
        block: &KlartextBlock<'p>,
        function: Option<u8>,
        machine: &mut impl Surroundings,
    ) -> Result<(), GcodeError> {
        let rest = trimmed(block.rest());
        let span = block.span_of(rest);
        let target = parameter(rest).and_then(|(number, rest)| Some((number, trimmed(rest).strip_prefix(b"=")?)));
        let Some((target, rest)) = target else { return Err(self.error(KlartextError::Parameter, span)) };
        let mut formula = Formula::new(machine.memory(), rest);
        let value = match function {
            None => formula.value(),
            Some(function) => of_function(function, &mut formula),
        };
        let value = value.map_err(|kind| self.error(kind, block.span_of(rest)))?;
        let behind = formula.rest;
        self.nothing_more(block, behind)?;
        machine.change(|memory| memory.set(target, value)).map_err(|kind| self.error(kind, span))
    }

    /// Refuses text behind a complete block.
    fn nothing_more(&self, block: &KlartextBlock<'p>, rest: &[u8]) -> Result<(), GcodeError> {
        let rest = trimmed(rest);
        if rest.is_empty() { Ok(()) } else { Err(self.error(FlowError::TextBehind, block.span_of(rest))) }
    }
}

/// The name of a label, and what follows it.
fn label_name(text: &[u8]) -> Option<(Label, &[u8])> {
    let text = trimmed(text);
    if text.first() == Some(&b'"') {
        let name = behind(text);
        let end = name.iter().position(|b| *b == b'"')?;
        return Some((Label::new(name.get(..end.saturating_add(1))?), behind(name.get(end..)?)));
    }
    let (rest, value) = written_number(text);
    let value = value.ok()?.exactly_times(1).and_then(|n| u32::try_from(n).ok())?;
    Some((Label::numbered(value), rest))
}

/// What stands behind a word of letters.
fn word<'t>(text: &'t [u8], word: &[u8]) -> Option<&'t [u8]> {
    let (start, rest) = text.split_at_checked(word.len())?;
    if start.eq_ignore_ascii_case(word) { Some(rest) } else { None }
}

/// The label of a line.
fn label_of(line: Line<'_>) -> Option<Label> {
    // Most lines are none, and are not taken apart.
    if !line.text.windows(3).any(|three| three.eq_ignore_ascii_case(b"LBL")) {
        return None;
    }
    let block = KlartextBlock::of(line).ok()?;
    if block.statement == Statement::Label { label_name(block.rest()).map(|(label, _)| label) } else { None }
}

/// The value of FN 0 … FN 8 and FN 13.
#[expect(clippy::float_arithmetic, reason = "Q parameters are computed in floating point")]
fn of_function(number: u8, formula: &mut Formula<'_, '_>) -> Result<f64, GcodeErrorKind> {
    let first = formula.operand()?;
    let mut second = |name: &[u8]| {
        formula.rest = word(trimmed(formula.rest), name).ok_or(KlartextError::Formula)?;
        formula.operand()
    };
    Ok(match number {
        // FN 5 to FN 7 name their function: `FN 6: Q1 = SIN +30`.
        0 | 5..=7 => first,
        1 => computed(Operator::Plus, first, second(b"+")?)?,
        2 => computed(Operator::Minus, first, second(b"-")?)?,
        3 => computed(Operator::Times, first, second(b"*")?)?,
        4 => {
            let divisor = second(b"DIV").or_else(|_| second(b"/"))?;
            computed(Operator::Over, first, divisor)?
        }
        8 => {
            let other = second(b"LEN")?;
            libm::sqrt(first * first + other * other)
        }
        13 => {
            let angle = arc_tangent(first, second(b"ANG")?);
            if angle < 0.0 { angle + 360.0 } else { angle }
        }
        _ => return Err(KlartextError::SystemFunction.into()),
    })
}
