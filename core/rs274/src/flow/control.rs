//! O words: subprograms, conditions and loops of LinuxCNC.

use super::super::lexical::{behind_comments, trimmed};
use super::super::parameter::Surroundings;
use super::super::{FlowError, GcodeError, Lines, Span};
use super::keyword::{Keyword, Label, OLine, digits, keyword, label};
use super::open::{CallKind, Kind, Open};
use super::place::Place;
use super::reader::Reader;

/// Arguments of a call.
const ARGUMENTS: u8 = 30;

/// One O word as it is executed.
#[derive(Clone, Copy)]
pub(super) struct OWord<'p> {
    label: Label,
    /// What follows the keyword.
    rest: &'p [u8],
    span: Span,
}

impl<'p> Reader<'p> {
    /// Executes a statement that steers the program.
    pub(super) fn steer(&mut self, span: Span, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let text = self.rest(span.start);
        let Some((b'O' | b'o', behind)) = text.split_first() else {
            return self.statement(span, machine);
        };
        // The name of a program at newer Fanucs: `O<PART>`.
        let name = text.get(..span.len).unwrap_or(text).trim_ascii_end();
        if self.dialect.has_macro_b() && trimmed(behind).starts_with(b"<") && name.ends_with(b">") {
            return Ok(());
        }
        if !self.dialect.has_o_words() {
            return Err(self.error(FlowError::OtherDialect, span));
        }
        let behind = trimmed(behind);
        let (name, label, rest) = match label(behind) {
            Some((label, rest)) => (behind, label, rest),
            None if matches!(behind.first(), Some(b'[' | b'#')) => {
                let (number, rest) = self.evaluate(machine, behind, false)?;
                let whole = super::super::Number::Computed(number).exactly_times(1);
                let number = whole.and_then(|n| u32::try_from(n).ok());
                let number = number.ok_or_else(|| self.error(FlowError::Label, span))?;
                (&digits(number)[..], Label::numbered(number), rest)
            }
            None => return Err(self.error(FlowError::Label, span)),
        };
        let Some((keyword, rest)) = keyword(rest) else {
            return Err(self.error(FlowError::Keyword, span));
        };
        let word = OWord { label, rest, span };
        match keyword {
            Keyword::Sub => self.seek(word, &[Keyword::EndSub]).map(|_| ()),
            Keyword::Call => self.call_sub(word, name, machine),
            Keyword::EndSub | Keyword::Return => self.return_from_sub(word, machine),
            Keyword::If => self.condition(word, machine),
            Keyword::ElseIf | Keyword::Else => {
                self.close(word, &[Kind::If])?;
                self.seek(word, &[Keyword::EndIf]).map(|_| ())
            }
            Keyword::EndIf => self.close(word, &[Kind::If]),
            Keyword::While => self.while_loop(word, machine),
            Keyword::Do => self.open_here(word, Kind::Do),
            Keyword::Repeat => self.repeat(word, machine),
            Keyword::EndWhile | Keyword::EndRepeat => self.end_of_turn(word, keyword),
            Keyword::Break | Keyword::Continue => self.leave_turn(word, keyword, machine),
        }
    }

    fn depth(&self) -> u8 {
        self.calls.len() as u8
    }

    fn open_here(&mut self, word: OWord<'p>, kind: Kind) -> Result<(), GcodeError> {
        let behind = self.place.lines.clone();
        let before = behind.again(&self.line);
        let open = Open { label: word.label, kind, before, behind, depth: self.depth() };
        self.open.open(open).map_err(|kind| self.error(kind, word.span))
    }

    fn close(&mut self, word: OWord<'p>, kinds: &[Kind]) -> Result<(), GcodeError> {
        let depth = self.depth();
        match self.open.find(word.label, depth) {
            Some(open) if kinds.contains(&open.kind) => {
                self.open.close(word.label, depth);
                Ok(())
            }
            _ => Err(self.error(FlowError::Unmatched, word.span)),
        }
    }

    fn go(&mut self, lines: Lines<'p>) {
        self.place.lines = lines;
        self.jumps = self.jumps.saturating_add(1);
    }

    /// The number in brackets behind a keyword.
    fn bracket(&self, word: OWord<'p>, machine: &impl Surroundings) -> Result<(f64, &'p [u8]), GcodeError> {
        if behind_comments(word.rest).first() != Some(&b'[') {
            return Err(self.error(FlowError::Condition, word.span));
        }
        self.evaluate(machine, behind_comments(word.rest), false)
    }

    pub(super) fn is_true(&self, word: OWord<'p>, machine: &impl Surroundings) -> Result<bool, GcodeError> {
        let (value, rest) = self.bracket(word, machine)?;
        self.nothing_behind(rest)?;
        Ok(value != 0.0 && !value.is_nan())
    }

    /// Goes behind the next line with this label and one of these keywords.
    fn seek(&mut self, word: OWord<'p>, keywords: &[Keyword]) -> Result<(Keyword, OWord<'p>), GcodeError> {
        let mut lines = self.place.lines.clone();
        while let Some(line) = lines.next() {
            let read = OLine::checked(&line).map_err(|kind| GcodeError::new(kind.into(), &line, line.span()));
            if let Some(o) = read.map_err(|error| error.in_file(self.place.file))?
                && o.label == word.label
                && keywords.contains(&o.keyword)
            {
                self.place.lines = lines;
                self.line = line;
                return Ok((o.keyword, OWord { label: o.label, rest: o.rest, span: line.span() }));
            }
        }
        Err(self.error(FlowError::NoEnd, word.span))
    }

    fn condition(&mut self, word: OWord<'p>, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let mut is_true = self.is_true(word, machine)?;
        while !is_true {
            match self.seek(word, &[Keyword::ElseIf, Keyword::Else, Keyword::EndIf])? {
                (Keyword::ElseIf, found) => is_true = self.is_true(found, machine)?,
                (Keyword::Else, _) => is_true = true,
                _ => return Ok(()),
            }
        }
        self.open_here(word, Kind::If)
    }

    fn while_loop(&mut self, word: OWord<'p>, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let is_true = self.is_true(word, machine)?;
        let depth = self.depth();
        if let Some(open) = self.open.find(word.label, depth)
            && open.kind == Kind::Do
        {
            let behind = open.behind.clone();
            if is_true {
                self.go(behind);
            } else {
                self.open.close(word.label, depth);
            }
            return Ok(());
        }
        if is_true {
            return self.open_here(word, Kind::While);
        }
        self.open.close(word.label, depth);
        self.seek(word, &[Keyword::EndWhile]).map(|_| ())
    }

    fn repeat(&mut self, word: OWord<'p>, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let (value, rest) = self.bracket(word, machine)?;
        self.nothing_behind(rest)?;
        // The conversion saturates; what is no number counts as 0.
        let turns = libm::round(value) as u32;
        if turns == 0 {
            return self.seek(word, &[Keyword::EndRepeat]).map(|_| ());
        }
        self.open_here(word, Kind::Repeat(turns.saturating_sub(1)))
    }

    fn end_of_turn(&mut self, word: OWord<'p>, keyword: Keyword) -> Result<(), GcodeError> {
        self.nothing_behind(word.rest)?;
        let depth = self.depth();
        let again = match self.open.find(word.label, depth) {
            Some(open) if open.kind == Kind::While && keyword == Keyword::EndWhile => Some(open.before.clone()),
            Some(open) if keyword == Keyword::EndRepeat => match open.kind {
                Kind::Repeat(0) => None,
                Kind::Repeat(turns) => {
                    open.kind = Kind::Repeat(turns.saturating_sub(1));
                    Some(open.behind.clone())
                }
                _ => return Err(self.error(FlowError::Unmatched, word.span)),
            },
            _ => return Err(self.error(FlowError::Unmatched, word.span)),
        };
        match again {
            Some(lines) => self.go(lines),
            None => self.open.close(word.label, depth),
        }
        Ok(())
    }

    /// `break` and `continue`, of `while` and `do` loops.
    fn leave_turn(
        &mut self,
        word: OWord<'p>,
        what: Keyword,
        machine: &mut impl Surroundings,
    ) -> Result<(), GcodeError> {
        self.nothing_behind(word.rest)?;
        let depth = self.depth();
        let Some((kind, before)) = self.open.find(word.label, depth).map(|open| (open.kind, open.before.clone()))
        else {
            return Err(self.error(FlowError::Unmatched, word.span));
        };
        match (kind, what) {
            (Kind::While, Keyword::Continue) => {
                self.go(before);
                Ok(())
            }
            (Kind::While, _) => {
                self.open.close(word.label, depth);
                self.seek(word, &[Keyword::EndWhile]).map(|_| ())
            }
            (Kind::Do, _) => {
                let (_, end) = self.seek(word, &[Keyword::While])?;
                if what == Keyword::Continue {
                    return self.while_loop(end, machine);
                }
                self.open.close(word.label, depth);
                Ok(())
            }
            _ => Err(self.error(FlowError::Unmatched, word.span)),
        }
    }

    fn call_sub(&mut self, word: OWord<'p>, name: &[u8], machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        let mut arguments = heapless::Vec::<f64, { ARGUMENTS as usize }>::new();
        let mut rest = behind_comments(word.rest);
        while rest.first() == Some(&b'[') {
            let (value, behind) = self.evaluate(machine, rest, false)?;
            let full = |_| self.error(FlowError::TooManyArguments { limit: ARGUMENTS }, word.span);
            arguments.push(value).map_err(full)?;
            rest = behind_comments(behind);
        }
        self.nothing_behind(rest)?;
        let place = self.sub_place(word.label, name).ok_or_else(|| self.error(FlowError::NoSuchProgram, word.span))?;
        self.call(place, CallKind::Sub, 1, word.span)?;
        machine
            .change(|memory| {
                memory.enter();
                (1u16..).zip(&arguments).try_for_each(|(number, value)| memory.set(number, *value))
            })
            .map_err(|kind| self.error(kind, word.span))
    }

    /// Behind the `sub` line of a label: in this text, in the main program, or in a file of its own.
    fn sub_place(&self, label: Label, name: &[u8]) -> Option<Place<'p>> {
        let within = |place: Place<'p>| {
            let mut lines = Lines::new(place.text);
            let is_sub = |o: OLine<'_>| o.label == label && o.keyword == Keyword::Sub;
            lines.find(|line| OLine::of(line).is_some_and(is_sub))?;
            Some(Place { lines, ..place })
        };
        let main = Place::start_of(self.program.text, 0);
        within(self.place.clone()).or_else(|| within(main)).or_else(|| {
            let name = match super::super::expression::name(name) {
                Ok((name, _)) => name,
                Err(_) => name.iter().copied().take_while(u8::is_ascii_digit).collect(),
            };
            let file = self.program.file(&name)?;
            within(Place::start_of(file.text, file.number))
        })
    }

    fn return_from_sub(&mut self, word: OWord<'p>, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        if !self.calls.last().is_some_and(|call| call.kind == CallKind::Sub) {
            return Err(self.error(FlowError::ReturnOutside, word.span));
        }
        let given = behind_comments(word.rest).first() == Some(&b'[');
        let (value, rest) =
            if given { self.evaluate(machine, behind_comments(word.rest), false)? } else { (0.0, word.rest) };
        self.nothing_behind(rest)?;
        let returned = if given { 1.0 } else { 0.0 };
        for (name, value) in [(&b"_value"[..], value), (b"_value_returned", returned)] {
            machine.change(|m| m.set_named(name, value)).map_err(|kind| self.error(kind, word.span))?;
        }
        self.leave(machine);
        Ok(())
    }
}
