//! Calls of subprograms and the way back.

use super::super::lexical::behind_comments;
use super::super::parameter::Surroundings;
use super::super::{FlowError, GcodeError, GcodeErrorKind, Span};
use super::keyword::digits;
use super::next::{Next, Target};
use super::open::{CALLS, Call, CallKind};
use super::place::Place;
use super::reader::Reader;
use super::sentence::Sentence;

impl<'p> Reader<'p> {
    /// Goes where a block leads.
    pub(in super::super) fn follow(
        &mut self,
        next: Next,
        sentence: &Sentence<'p>,
        machine: &mut impl Surroundings,
    ) -> Result<(), GcodeError> {
        match next {
            Next::Continue => Ok(()),
            Next::End => {
                self.ended = true;
                Ok(())
            }
            Next::Jump { to, span } => self.jump(to, span),
            Next::Call { target, times, arguments, span } => {
                let place = match target {
                    Target::Program(number) => self.program_place(number),
                    Target::Block(number) => {
                        let lines = self.place.block(number);
                        let lines = lines.ok_or_else(|| self.error(FlowError::NoSuchBlock { number }, span))?;
                        Some(Place { lines, ..self.place.clone() })
                    }
                };
                let place = place.ok_or_else(|| self.error(FlowError::NoSuchProgram, span))?;
                let kind = if arguments { CallKind::Macro } else { CallKind::Program };
                self.call(place, kind, times, span)?;
                if arguments {
                    machine.change(|m| m.enter());
                    self.pass(sentence, machine, span)?;
                }
                Ok(())
            }
            Next::Return { to, span } => {
                let called = !self.calls.is_empty();
                if called && to.is_none() {
                    self.turn(machine);
                    return Ok(());
                }
                if called {
                    self.leave(machine);
                }
                match to {
                    Some(number) => self.jump(number, span),
                    None => {
                        // M99 in the main program repeats it; once is what it says about its path.
                        self.ended = true;
                        Ok(())
                    }
                }
            }
        }
    }

    /// Behind the last line of a text.
    pub(super) fn end_of_text(&mut self, machine: &mut impl Surroundings) -> Result<(), GcodeError> {
        match self.calls.last() {
            None => self.ended = true,
            Some(Call { kind: CallKind::Sub, .. }) => {
                return Err(self.error(FlowError::NoEnd, self.line.span()));
            }
            Some(_) => self.turn(machine),
        }
        Ok(())
    }

    /// Begins a call.
    pub(super) fn call(&mut self, place: Place<'p>, kind: CallKind, times: u32, span: Span) -> Result<(), GcodeError> {
        if times == 0 {
            return Ok(());
        }
        let begin = place.lines.clone();
        let turns = times.saturating_sub(1);
        let call = Call { back: self.place.clone(), begin, turns, kind };
        if self.calls.push(call).is_err() {
            return Err(self.error(FlowError::TooManyCalls { limit: CALLS as u8 }, span));
        }
        self.place = Place { start: place.lines.clone(), ..place };
        self.jumps = self.jumps.saturating_add(1);
        Ok(())
    }

    /// The end of a subprogram: its next turn, or back.
    pub(super) fn turn(&mut self, machine: &mut impl Surroundings) {
        self.jumps = self.jumps.saturating_add(1);
        let depth = self.calls.len() as u8;
        if let Some(call) = self.calls.last_mut()
            && call.turns > 0
        {
            call.turns = call.turns.saturating_sub(1);
            self.place.lines = call.begin.clone();
            self.open.leave(depth.saturating_sub(1));
            return;
        }
        self.leave(machine);
    }

    /// Back to the caller.
    pub(super) fn leave(&mut self, machine: &mut impl Surroundings) {
        let Some(call) = self.calls.pop() else { return };
        self.jumps = self.jumps.saturating_add(1);
        self.open.leave(self.calls.len() as u8);
        machine.level_ended(self.calls.len().saturating_add(1) as u8);
        if call.kind != CallKind::Program {
            machine.change(|m| m.leave());
        }
        self.place = call.back;
    }

    /// Jumps to a block number.
    pub(super) fn jump(&mut self, number: u32, span: Span) -> Result<(), GcodeError> {
        let lines = self.place.block(number);
        self.place.lines = lines.ok_or_else(|| self.error(FlowError::NoSuchBlock { number }, span))?;
        self.jumps = self.jumps.saturating_add(1);
        Ok(())
    }

    /// Program `O…`: in this text, in the main program, or in a file of its own.
    fn program_place(&self, number: u32) -> Option<Place<'p>> {
        let main = Place::start_of(self.program.text, 0);
        for place in [&self.place, &main] {
            if let Some(lines) = place.program(number) {
                return Some(Place { lines, ..place.clone() });
            }
        }
        let file = self.program.file(&digits(number))?;
        let place = Place::start_of(file.text, file.number);
        Some(match place.program(number) {
            Some(lines) => Place { lines, ..place },
            None => place,
        })
    }

    /// Passes the words of a G65 block, argument lists I and II of custom macro B.
    fn pass(&self, sentence: &Sentence<'p>, machine: &mut impl Surroundings, span: Span) -> Result<(), GcodeError> {
        let mut before = [0u16; 3];
        for word in &sentence.words {
            let number = match word.letter {
                b'G' | b'P' | b'L' | b'O' => continue,
                letter @ b'I'..=b'K' => {
                    let place = usize::from(letter.saturating_sub(b'I'));
                    let Some(times) = before.get_mut(place) else { continue };
                    let number = 4u16.saturating_add(place as u16).saturating_add(times.saturating_mul(3));
                    *times = times.saturating_add(1);
                    number
                }
                letter => argument(letter).ok_or_else(|| self.error(FlowError::Argument { letter }, word.span))?,
            };
            if number > u16::from(self.dialect.locals()) {
                let limit = self.dialect.locals();
                return Err(self.error(FlowError::TooManyArguments { limit }, span));
            }
            machine.change(|m| m.set(number, word.value.value())).map_err(|kind| self.error(kind, span))?;
        }
        Ok(())
    }

    /// Refuses text behind a complete statement; comments may follow.
    pub(super) fn nothing_behind(&self, rest: &[u8]) -> Result<(), GcodeError> {
        let rest = behind_comments(rest);
        if matches!(rest.first(), None | Some(b';')) {
            return Ok(());
        }
        if rest.first() == Some(&b'(') {
            let start = self.line.span().end().saturating_sub(rest.len());
            return Err(self.error(GcodeErrorKind::UnclosedComment, Span { start, len: rest.len() }));
        }
        let start = self.line.span().end().saturating_sub(rest.len());
        Err(self.error(FlowError::TextBehind, Span { start, len: rest.trim_ascii_end().len() }))
    }
}

/// The parameter of a letter in argument list I; I, J and K are counted besides.
const fn argument(letter: u8) -> Option<u16> {
    Some(match letter {
        b'A' => 1,
        b'B' => 2,
        b'C' => 3,
        b'D' => 7,
        b'E' => 8,
        b'F' => 9,
        b'H' => 11,
        b'M' => 13,
        letter @ b'Q'..=b'Z' => 17u16.saturating_add((letter as u16).saturating_sub(b'Q' as u16)),
        _ => return None,
    })
}
