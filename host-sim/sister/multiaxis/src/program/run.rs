//! One pass over a program: every line is read, every five-axis move measured, the divided ones written anew.
//!
//! Memory does not grow with the program: one line, the state of the control, statistics and a profile of fixed size.

use std::io::{self, BufRead, Write};

use truepath_ground::diagnostics::InputError;

use super::block::Block;
use super::lines::{Line, LineError, LineReader};
use super::notes::Note;
use super::refusal::At;
use super::report::{MoveRow, Report};
use super::settings::{CentrePoint, Settings};
use super::split::{Plan, Writing};
use super::state::State;
use super::step::{Move, Step};
use super::writer::{Original, write};
use crate::codes::A007;
use crate::machine::Coordinates;

/// Lines between two tellings of the progress.
const TELL_EVERY: u32 = 2048;

/// How a pass ended.
#[derive(Debug)]
pub enum Outcome {
    /// The program was read to its end.
    Done(Box<Report>),
    /// This line steers the program, or computes a place: reading it line by line is not enough.
    Steered(u32),
}

/// Why it did not.
#[derive(Debug)]
pub enum PassError {
    /// The program is wrong.
    Input(InputError),
    /// It cannot be read.
    Read(io::Error),
    /// The result cannot be written.
    Write(io::Error),
}

impl From<InputError> for PassError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// Where the results of a pass go.
pub struct Sinks<'s> {
    /// The rewritten program.
    pub text: &'s mut dyn Write,
    /// One row a move.
    pub row: &'s mut dyn FnMut(&MoveRow) -> Result<(), InputError>,
    /// Told the bytes read, now and then.
    pub progress: &'s mut dyn FnMut(u64),
}

struct Pass<'s, 'm> {
    settings: &'s Settings<'m>,
    name: &'s str,
    state: State,
    report: Report,
    sinks: Sinks<'s>,
    block: Block,
    /// The first line end of the program.
    ending: &'static [u8],
    /// A `%` was read: before any block (opening), or behind one.
    opened: bool,
    begun: bool,
    closed: bool,
    written: Vec<u8>,
    /// The lines that the lines of an unrolled program come from.
    origin: Option<&'s [u32]>,
}

/// Reads `input`, the program `name`, and writes the program in which no move exceeds the tolerance.
///
/// # Errors
/// [`PassError`].
pub fn run<'s>(
    input: impl BufRead,
    name: &'s str,
    settings: &'s Settings<'s>,
    origin: Option<&'s [u32]>,
    sinks: Sinks<'s>,
) -> Result<Outcome, PassError> {
    let mut reader = LineReader::new(input);
    let mut line = Line::default();
    let state = State { units: settings.units, ..State::new() };
    let mut pass = Pass {
        settings,
        name,
        state,
        report: Report::new(settings),
        sinks,
        block: Block::default(),
        ending: b"",
        opened: false,
        begun: false,
        closed: false,
        written: Vec::new(),
        origin,
    };
    loop {
        match reader.next(&mut line) {
            Ok(true) => {}
            Ok(false) => break,
            Err(LineError::Io(error)) => return Err(PassError::Read(error)),
            Err(LineError::TooLong) => {
                return Err(At { name, number: reader.number(), text: &[] }.too_long().into());
            }
        }
        if pass.ending.is_empty() {
            pass.ending = line.end;
        }
        if line.number.is_multiple_of(TELL_EVERY) {
            (pass.sinks.progress)(reader.bytes());
        }
        if pass.line(&line)? {
            return Ok(Outcome::Steered(line.number));
        }
    }
    pass.report.lines = u64::from(reader.number().saturating_sub(1));
    pass.report.bytes = reader.bytes();
    pass.report.units = pass.state.units;
    Ok(Outcome::Done(Box::new(pass.report)))
}

impl Pass<'_, '_> {
    /// Works on a line; `true` when the program is steered by it.
    fn line(&mut self, line: &Line) -> Result<bool, PassError> {
        self.written.clear();
        if self.state.ended || self.closed {
            self.behind_end(line)?;
        } else if !line.text.iter().all(|b| b.is_ascii_whitespace()) {
            let at = At { name: self.name, number: line.number, text: &line.text };
            let mut block = std::mem::take(&mut self.block);
            block.read(line.number, &line.text).map_err(|error| at.unread(&error))?;
            let steered = self.block(&block, line, &at);
            self.block = block;
            if steered? {
                return Ok(true);
            }
        }
        if self.written.is_empty() {
            self.written.extend_from_slice(&line.text);
        }
        self.written.extend_from_slice(line.end);
        self.sinks.text.write_all(&self.written).map_err(PassError::Write)?;
        Ok(false)
    }

    /// Text behind the end is passed on; a program that only begins there is an error.
    fn behind_end(&mut self, line: &Line) -> Result<(), PassError> {
        let text = line.text.trim_ascii();
        let nothing = text.iter().all(|b| matches!(b, b'%' | 0 | 0x1A)) || matches!(text.first(), Some(b'(' | b';'));
        if nothing {
            return Ok(());
        }
        if self.closed && !self.opened {
            let at = At { name: self.name, number: line.number, text: &line.text };
            let found = "a block behind a %, and blocks in front of it";
            return Err(at.error(A007, found, "the program between two %", 0..line.text.len()).into());
        }
        self.report.notes.add(Note::TextBehindEnd, line.number);
        Ok(())
    }

    fn block(&mut self, block: &Block, line: &Line, at: &At<'_>) -> Result<bool, PassError> {
        if block.percent {
            self.closed = self.opened || self.begun;
            self.opened |= !self.begun;
            return Ok(false);
        }
        if block.words.is_empty() && block.control.is_none() && block.assignment.is_none() {
            return Ok(false);
        }
        // A second program number begins a subprogram. Wherever it stands in its block: in a line that is divided the words before it can
        // go to the end.
        let program = block.words.iter().any(|w| w.letter == b'O');
        if program && self.begun {
            return Ok(true);
        }
        self.begun = true;
        let number = self.origin_of(line.number);
        if block.block_delete.is_some() {
            self.report.notes.add(Note::BlockDelete, number);
        }
        let before = self.state.centre_point;
        let step = self.state.block(block, number, &line.text, &self.settings.reading);
        let step = step.map_err(|trouble| PassError::Input(at.trouble(trouble)))?;
        self.report.blocks += 1;
        for code in self.state.unknown.drain(..) {
            self.report.notes.add(Note::UnknownCode(code), number);
        }
        if self.state.centre_point && !before {
            self.report.notes.add(Note::CentrePoint, number);
        }
        let full = self.state.centre_point && self.settings.centre_point == CentrePoint::Full;
        if matches!(step, Step::Straight | Step::Move(_)) && !self.state.feed_given {
            self.report.notes.add(Note::FeedMissing, number);
        }
        match step {
            Step::Nothing => {}
            Step::Straight => self.report.straight += 1,
            Step::Steered(_) => return Ok(true),
            Step::Move(_) | Step::Unchecked(_) if full => self.report.full_interpolation += 1,
            Step::Unchecked(reason) => self.report.left.add(number, reason, None),
            Step::Move(moved) => self.divide(block, line, &moved)?,
        }
        Ok(false)
    }

    fn origin_of(&self, line: u32) -> u32 {
        self.origin.and_then(|o| o.get(line.saturating_sub(1) as usize)).copied().unwrap_or(line)
    }

    fn divide(&mut self, block: &Block, line: &Line, moved: &Move) -> Result<(), PassError> {
        let coordinates = if self.state.centre_point { Coordinates::Tip } else { self.settings.coordinates };
        if !moved.travels && coordinates == Coordinates::Joints {
            self.report.rotary_alone += 1;
            self.report.notes.add(Note::RotaryAlone, self.origin_of(line.number));
            return Ok(());
        }
        let writing = Writing { coordinates, units: self.state.units, own: self.state.decimals };
        let plan = self.settings.splitter.plan(moved, writing);
        if let Some(contacts) = &mut self.report.contacts {
            let splitter = &self.settings.splitter;
            splitter.ends(moved, writing).iter().for_each(|joints| contacts.add(splitter.machine, joints));
        }
        let number = self.origin_of(line.number);
        if let Some(reason) = plan.refused {
            self.report.left.add(number, reason, Some(plan.before));
        }
        self.report.tips += u64::from(coordinates == Coordinates::Tip);
        self.record(number, &plan)?;
        if !plan.inserted.is_empty() {
            let original = Original {
                number,
                text: &line.text,
                block,
                end: if self.ending.is_empty() { b"\n" } else { self.ending },
                units: writing.units,
                absolute: self.state.absolute,
                feed_mode: self.state.feed_mode,
                dialect: self.settings.reading.dialect,
            };
            write(&original, moved, &plan, &mut self.written);
        }
        Ok(())
    }

    fn record(&mut self, number: u32, plan: &Plan) -> Result<(), PassError> {
        let row = MoveRow {
            line: number,
            error_before_mm: plan.before,
            pieces: plan.after.len(),
            error_after_mm: plan.after.iter().fold(0.0f64, |m, e| m.max(*e)),
            passage: plan.passage,
        };
        self.report.add(&row, plan);
        (self.sinks.row)(&row)?;
        Ok(())
    }
}
