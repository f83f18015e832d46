//! Statements of Fanuc's custom macro B: IF, WHILE, GOTO, DO, END.
//!
//! Output to a port (POPEN, PCLOS, DPRNT, BPRNT) moves nothing and is passed over.

use super::super::lexical::{number, trimmed};
use super::super::parameter::Surroundings;
use super::super::{FlowError, GcodeError, Number, ParameterError, Span};
use super::keyword::Label;
use super::open::{Kind, Open};
use super::reader::Reader;

impl<'p> Reader<'p> {
    /// Executes a statement of the macro language.
    pub(super) fn statement(&mut self, span: Span, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        if !self.dialect.has_macro_b() {
            return Err(self.error(FlowError::OtherDialect, span));
        }
        let text = self.rest(span.start);
        if let Some(rest) = behind(text, b"IF") {
            let (is_true, rest) = self.truth(rest, span, machine)?;
            return match (behind(rest, b"GOTO"), behind(rest, b"THEN")) {
                (Some(_), _) if !is_true => Ok(()),
                (Some(to), _) => self.goto(to, span, machine),
                (None, Some(_)) if !is_true => Ok(()),
                (None, Some(then)) => self.then(then, span, machine),
                (None, None) => Err(self.error(FlowError::Keyword, span)),
            };
        }
        if let Some(rest) = behind(text, b"WHILE") {
            let (is_true, rest) = self.truth(rest, span, machine)?;
            let label = behind(rest, b"DO").ok_or_else(|| self.error(FlowError::Keyword, span))?;
            let label = self.number(label, span)?;
            return if is_true { self.open_macro(label, span) } else { self.behind_end(label, span) };
        }
        if let Some(rest) = behind(text, b"GOTO") {
            return self.goto(rest, span, machine);
        }
        if let Some(rest) = behind(text, b"DO") {
            let label = self.number(rest, span)?;
            return self.open_macro(label, span);
        }
        if let Some(rest) = behind(text, b"END") {
            let label = Label::numbered(self.number(rest, span)?);
            let depth = self.calls.len() as u8;
            let open = self.open.find(label, depth).filter(|open| open.kind == Kind::Macro);
            let Some(before) = open.map(|open| open.before.clone()) else {
                return Err(self.error(FlowError::Unmatched, span));
            };
            self.open.close(label, depth);
            self.place.lines = before;
            self.jumps = self.jumps.saturating_add(1);
        }
        Ok(())
    }

    /// The value of a condition, and what follows it.
    fn truth(&self, text: &'p [u8], span: Span, machine: &impl Surroundings) -> Result<(bool, &'p [u8]), GcodeError> {
        if trimmed(text).first() != Some(&b'[') {
            return Err(self.error(FlowError::Condition, span));
        }
        let (value, rest) = self.evaluate(machine, text, false)?;
        Ok((value != 0.0 && !value.is_nan(), rest))
    }

    /// A written whole number at the end of the statement.
    fn number(&self, text: &'p [u8], span: Span) -> Result<u32, GcodeError> {
        let (rest, value) = number(text);
        self.nothing_behind(rest)?;
        let whole = value.ok().and_then(|v| v.exactly_times(1)).and_then(|v| u32::try_from(v).ok());
        whole.ok_or_else(|| self.error(FlowError::Label, span))
    }

    fn goto(&mut self, text: &'p [u8], span: Span, machine: &impl Surroundings) -> Result<(), GcodeError> {
        let (value, rest) = self.evaluate(machine, text, false)?;
        self.nothing_behind(rest)?;
        let whole = Number::Computed(value).exactly_times(1).and_then(|v| u32::try_from(v).ok());
        let number = whole.ok_or_else(|| self.error(FlowError::Label, span))?;
        self.jump(number, span)
    }

    fn then(&self, text: &'p [u8], span: Span, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let text = trimmed(text);
        let largest = self.dialect.largest_parameter();
        let wrong = || self.error(FlowError::Keyword, span);
        let number = text.strip_prefix(b"#").ok_or_else(wrong)?;
        let (number, rest) = self.evaluate(machine, number, false)?;
        let number = super::super::expression::parameter_number(number, self.dialect);
        let number = number.map_err(|kind| self.error(kind, span))?;
        if number == 0 {
            return Err(self.error(ParameterError::Number { largest }, span));
        }
        let right = trimmed(rest).strip_prefix(b"=").ok_or_else(wrong)?;
        let (value, rest) = self.evaluate(machine, right, true)?;
        self.nothing_behind(rest)?;
        machine.change(|m| m.set(number, value)).map_err(|kind| self.error(kind, span))
    }

    fn open_macro(&mut self, label: u32, span: Span) -> Result<(), GcodeError> {
        let behind = self.place.lines.clone();
        let before = behind.again(&self.line);
        let depth = self.calls.len() as u8;
        let open = Open { label: Label::numbered(label), kind: Kind::Macro, before, behind, depth };
        self.open.open(open).map_err(|kind| self.error(kind, span))
    }

    /// Behind the END of a loop that is not entered.
    fn behind_end(&mut self, label: u32, span: Span) -> Result<(), GcodeError> {
        let mut lines = self.place.lines.clone();
        let is_end = |text: &[u8]| {
            behind(text, b"END")
                .is_some_and(|rest| number(rest).1.ok().and_then(|v| v.exactly_times(1)) == Some(i64::from(label)))
        };
        let found = lines.any(|line| is_end(super::place::statement(&line)));
        if !found {
            return Err(self.error(FlowError::NoEnd, span));
        }
        self.place.lines = lines;
        Ok(())
    }
}

/// What stands behind a word of letters, if the text begins with it.
fn behind<'t>(text: &'t [u8], word: &[u8]) -> Option<&'t [u8]> {
    let (start, rest) = trimmed(text).split_at_checked(word.len())?;
    if start.eq_ignore_ascii_case(word) { Some(rest) } else { None }
}
