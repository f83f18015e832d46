//! CYCL DEF and its calls.
//!
//! Holes (200 … 209, 240, 241) go down to Q203 + Q201 and back to their clearance; datum shift (7) and preset (247) move
//! the origin; what only sets how the path is followed (32), or undoes what was never done (8, 10, 11, 19 without
//! values), is passed over. Every other cycle cuts or moves along a path that is not in the program: it is refused where
//! it would run, not where it is defined.

use super::super::super::flow::{Next, Sentence};
use super::super::super::klartext::{Formula, parameter};
use super::super::super::lexical::trimmed;
use super::super::super::{Axes, Canon, GCode, GcodeError, GcodeErrorKind, KlartextError, Lines, Motion, Number, Word};
use super::super::Execution;
use super::super::klartext_memory::{Asked, Lowered};
use super::path::PLACE;
use truepath_units::{Offset, Position};

impl<'p> Execution<'p, '_, '_> {
    /// CYCL DEF.
    pub(super) fn cycle_block(&mut self, sentence: &Sentence<'p>, number: u16, part: u8) -> Result<(), GcodeError> {
        let span = self.block_span();
        let text = sentence.rest.of(sentence.text);
        let refused = |kind: KlartextError| Err(self.error(kind.into(), span));
        match number {
            7 if part > 0 => self.datum_shift(sentence),
            // Titles; tolerance, load, orientation of the spindle; contours and their data, which other cycles cut.
            7 | 13 | 32 | 239 | 14 | 20 | 270 | 271 => Ok(()),
            8 | 10 | 11 | 19 | 26 if part == 0 => Ok(()),
            8 if trimmed(text).is_empty() => Ok(()),
            10 | 11 | 19 | 26 if is_neutral(text, number == 11 || number == 26) => Ok(()),
            8 | 10 | 11 | 19 | 26 => refused(KlartextError::Transformation { number }),
            9 if part > 0 => {
                let digits = text.iter().position(u8::is_ascii_digit).unwrap_or(text.len());
                let (_, value) = super::super::super::lexical::number(text.get(digits..).unwrap_or(&[]));
                self.emit(Canon::Dwell(value.map_or(Number::ZERO, Number::Exact)), span)
            }
            9 => Ok(()),
            247 => self.preset(),
            // They run where they are defined.
            220 | 221 => refused(KlartextError::Cycle { number }),
            400..=499 | 580..=599 | 1_400..=1_499 => refused(KlartextError::Touch),
            _ => {
                self.klartext.cycle = Some(number);
                Ok(())
            }
        }
    }

    /// CYCL DEF 7.1 …: the origin lies where the words say, from that of the preset.
    fn datum_shift(&mut self, sentence: &Sentence<'p>) -> Result<(), GcodeError> {
        let span = self.block_span();
        let mut rest = trimmed(sentence.rest.of(sentence.text));
        let mut words = Lowered::new();
        self.put_code(&mut words, 520, span)?;
        while let Some((&first, behind)) = rest.split_first() {
            let step = first.eq_ignore_ascii_case(&b'I');
            let (letter, value) = if step { behind.split_first().unwrap_or((&0, &[])) } else { (&first, behind) };
            let letter = letter.to_ascii_uppercase();
            let Some(axis) = b"XYZABCUVW".iter().position(|a| *a == letter) else {
                return Err(self.error(KlartextError::Transformation { number: 7 }.into(), span));
            };
            let mut formula = Formula::new(self.memory, value);
            let written = super::super::super::lexical::number(value);
            let (number, behind) = match written {
                (behind, Ok(number)) => (Number::Exact(number), behind),
                _ => {
                    let computed = formula.operand().map_err(|kind| self.error(kind, span))?;
                    (Number::Computed(computed), formula.rest)
                }
            };
            let word = Word { letter, value: number, span };
            let before = if step { self.modal.shifts.local.get(axis).copied().unwrap_or(0) } else { 0 };
            let value = match before {
                0 => number,
                _ => {
                    let by = self.axis_value(word, axis)?;
                    self.written(Position::from_nm(before) + by)
                }
            };
            self.put(&mut words, letter, value, span)?;
            rest = trimmed(behind);
        }
        if words.len() == 1 {
            return Err(self.error(KlartextError::Word.into(), span));
        }
        self.klartext.pole = [None; 2];
        self.lower(sentence, &words).map(|_| ())
    }

    /// CYCL DEF 247: another preset, whose number stands as Q339 in the lines of the block.
    fn preset(&mut self) -> Result<(), GcodeError> {
        let end = self.line.span().end();
        let behind = self.text.get(end..).unwrap_or(&[]);
        let q339 = Lines::new(behind).take(3).find_map(|line| {
            let (number, rest) = parameter(trimmed(line.text))?;
            if number != 340 {
                return None;
            }
            let rest = trimmed(trimmed(rest).strip_prefix(b"=")?);
            super::super::super::lexical::number(rest).1.ok()?.exactly_times(1)
        });
        let system = q339.and_then(|n| u16::try_from(n).ok()).unwrap_or(1);
        if system != self.modal.work_offset {
            self.at = Axes::UNKNOWN;
        }
        self.modal.work_offset = system;
        self.emit(Canon::WorkOffset(system), self.block_span())
    }

    /// CYCL CALL, CYCL CALL POS.
    pub(super) fn cycle_call_block(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        let mut words = Lowered::new();
        let asked = self.functions(sentence, &mut words)?;
        self.feeds(sentence, &mut words)?;
        self.refuse_others(sentence, &[PLACE])?;
        let before = words.len();
        self.axis_targets(sentence, &mut words, false)?;
        if words.len() > before {
            self.put_code(&mut words, 0, self.block_span())?;
        }
        let next = self.lower(sentence, &words)?;
        self.call_cycle()?;
        self.carry_out(Asked { cycle: false, ..asked })?;
        Ok(next)
    }

    /// Runs the cycle that is defined, where the tool stands.
    pub(super) fn call_cycle(&mut self) -> Result<(), GcodeError> {
        let span = self.block_span();
        let Some(number) = self.klartext.cycle else {
            return Err(self.error(KlartextError::CycleMissing.into(), span));
        };
        if !matches!(number, 200..=207 | 209 | 240 | 241) {
            return Err(self.error(KlartextError::Cycle { number }.into(), span));
        }
        let value = |q: u16| Number::Computed(self.memory.get(q.saturating_add(1))).nanometres(self.modal.units);
        let (Some(clearance), Some(depth), Some(surface), Some(second)) =
            (value(200), value(201), value(203), value(204))
        else {
            return Err(self.error(GcodeErrorKind::OutOfRange { letter: b'Z' }, span));
        };
        let height = |above: i64| Some(Position::from_nm(surface) + Offset::from_nm(above));
        let before = self.modal.motion;
        self.modal.motion = Some(Motion::Cycle(GCode::from_tenths(810)));
        let to = |z: Option<Position>, at: Axes| Axes { z, ..at };
        self.traverse_to(to(height(clearance), self.at), span)?;
        self.feed_to(to(height(depth), self.at), span)?;
        self.traverse_to(to(height(clearance.max(second)), self.at), span)?;
        self.modal.motion = before;
        self.klartext.direction = None;
        Ok(())
    }
}

/// Whether all numbers of a text are 0, or 1 for factors.
fn is_neutral(text: &[u8], factor: bool) -> bool {
    let wanted = i64::from(factor);
    let mut rest = text;
    while let Some(at) = rest.iter().position(u8::is_ascii_digit) {
        let (behind, value) = super::super::super::lexical::number(rest.get(at..).unwrap_or(&[]));
        // ABST of the tilted plane is a distance.
        let distance = rest.get(..at).is_some_and(|t| t.ends_with(b"ABST") || t.ends_with(b"DIST"));
        if !distance && value.ok().and_then(|v| v.exactly_times(1)) != Some(wanted) {
            return false;
        }
        rest = behind;
    }
    !text.iter().any(|b| matches!(b, b'Q' | b'q'))
}
