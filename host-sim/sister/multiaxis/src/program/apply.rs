//! A block changes the state of the control.
//!
//! Order of execution as in RS274/NGC (NIST 6556, table 8): tool change, units, offsets and modes first, then the move.

use std::ops::Range;

use truepath_core::gcode::{Dialect, FeedMode};

use super::block::{Block, Word};
use super::codes::{Meaning, Motion, Transform, meaning};
use super::quantity::Quantity;
use super::state::{Reading, State};
use super::step::{Step, Trouble};

/// What the codes of one block say besides modes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OneShot {
    /// G4.
    pub dwell: bool,
    /// G28, G30, G53.
    pub elsewhere: bool,
    /// G53, which may cut; G28 and G30 never do.
    pub machine: bool,
    /// G92 or G52.
    pub names: Option<Meaning>,
    /// A code that is not known.
    pub unknown: bool,
    /// G10 writes an offset, or G43.1 and G43.2 of LinuxCNC a tool's: the axis words move nothing.
    pub table: bool,
}

impl State {
    /// Executes a block; `text` is its line.
    ///
    /// # Errors
    /// [`Trouble`]: what the control would refuse as well.
    pub fn block(&mut self, block: &Block, line: u32, text: &[u8], reading: &Reading) -> Result<Step, Trouble> {
        if let Some(span) = steered(block) {
            return Ok(Step::Steered(span));
        }
        if block.block_delete.is_some() && reading.skip_block_delete {
            return Ok(Step::Nothing);
        }
        if let Some(word) = block.twice {
            return Err(Trouble::Twice(word));
        }
        if block.assignment.as_ref().is_some_and(|span| is_offset(text.get(span.clone()).unwrap_or_default())) {
            self.lose_offsets(line);
        }
        let mut shot = OneShot::default();
        if self.miscellaneous(block, line, reading) {
            return Ok(Step::Steered(0..text.len()));
        }
        for word in block.words.iter().filter(|w| w.letter == b'G') {
            self.code(word, block, line, reading, &mut shot);
        }
        self.note_decimals(block);
        if let Some(word) = block.word(b'F') {
            self.feed_given = word.value.is_none_or(|v| v.mantissa() > 0);
        }
        if !shot.dwell {
            let foreign = |w: &&Word| match w.letter {
                b'A'..=b'C' => !reading.rotary[usize::from(w.letter - b'A')],
                b'U' | b'V' | b'W' => true,
                _ => false,
            };
            if let Some(word) = block.words.iter().find(foreign) {
                return Err(Trouble::NoAxis(*word));
            }
            if let Some(how) = shot.names {
                self.name(how, block, line, text, reading)?;
                return Ok(Step::Nothing);
            }
        }
        self.motion(block, text, reading, shot)
    }

    /// M and T words; whether the program is steered by one.
    fn miscellaneous(&mut self, block: &Block, line: u32, reading: &Reading) -> bool {
        if let Some(word) = block.word(b'T') {
            self.tool.0 = word.whole();
        }
        for word in block.words.iter().filter(|w| w.letter == b'M') {
            match word.whole() {
                Some(2 | 30) => self.ended = true,
                Some(99) if block.word(b'P').is_none() => self.ended = true,
                Some(97..=99) => return true,
                Some(6) => {
                    let before = self.tool.1;
                    self.tool.1 = self.tool.0;
                    if reading.one_tool && before.is_some() && before != self.tool.1 {
                        self.tool_changed = Some(line);
                    }
                    self.forget(0..3);
                }
                Some(code @ 428..=430) if reading.dialect == Dialect::Linuxcnc => {
                    self.centre_point = code == 428;
                    self.switched = self.centre_point;
                    self.transforms[Transform::Kinematics as usize] = (code == 430).then_some(line);
                    self.forget(0..3);
                }
                _ => {}
            }
        }
        false
    }

    fn code(&mut self, word: &Word, block: &Block, line: u32, reading: &Reading, shot: &mut OneShot) {
        let Some(tenths) = word.tenths() else {
            shot.unknown = true;
            return;
        };
        match meaning(tenths, reading.dialect) {
            Meaning::Motion(motion) => self.motion = motion,
            Meaning::Units(units) => self.units = units,
            Meaning::Absolute(absolute) => self.absolute = absolute,
            Meaning::FeedMode(mode) => {
                if mode != self.feed_mode {
                    self.feed_given = false;
                }
                self.feed_mode = mode;
            }
            Meaning::Compensation(on) => {
                // The tool stands beside the programmed place until a word of G90 leads it there.
                if !on && self.compensation.is_some() {
                    self.forget(0..3);
                }
                self.compensation = on.then_some(line);
            }
            Meaning::ToolLength => {
                let whole = self.centre_point || !matches!(tenths, 430 | 440 | 490);
                self.forget(if whole { 0..3 } else { 2..3 });
                // One modal group: G43 ends G43.4 as G49 does. Switched kinematics are not of it.
                self.centre_point &= self.switched || !matches!(tenths, 430 | 440 | 490);
                shot.table |= matches!(tenths, 431 | 432) && reading.dialect == Dialect::Linuxcnc;
            }
            Meaning::CentrePoint => {
                self.centre_point = true;
                self.forget(0..3);
            }
            Meaning::WorkOffset => {
                let row = block.word(b'P');
                // G54 P1 is G54.1 P1.
                let tenths = if tenths == 540 && row.is_some() { 541 } else { tenths };
                let number = if matches!(tenths, 541 | 1540) { row.and_then(Word::whole) } else { Some(0) };
                self.select_offset(tenths, number, line);
            }
            Meaning::Table => {
                shot.table = true;
                let tool = block.word(b'L').and_then(Word::whole).is_some_and(|l| matches!(l, 0 | 1 | 10..=13));
                if !tool {
                    self.lose_offsets(line);
                }
            }
            how @ (Meaning::Local | Meaning::Name | Meaning::NameOff(_)) => shot.names = Some(how),
            Meaning::Elsewhere => {
                shot.elsewhere = true;
                shot.machine |= tenths == 530;
            }
            Meaning::Dwell => shot.dwell = true,
            Meaning::Transform(which, on) => {
                self.transforms[which as usize] = on.then_some(line);
                self.forget(0..3);
            }
            Meaning::Unknown | Meaning::Macro => {
                shot.unknown = true;
                self.unknown.push(tenths);
            }
            Meaning::ExactStop | Meaning::Harmless => {}
        }
    }

    fn lose_offsets(&mut self, line: u32) {
        if self.frame.is_some() {
            self.offsets_lost.get_or_insert(line);
        }
        self.forget(0..6);
    }

    fn select_offset(&mut self, tenths: u16, number: Option<i64>, line: u32) {
        let Some(number) = number else { return self.lose_offsets(line) };
        let work = (tenths, number);
        if work == std::mem::replace(&mut self.work, work) {
            return;
        }
        self.forget(0..6);
        self.offsets_changed = self.frame.filter(|frame| *frame != work).map(|_| line);
    }

    /// G92 and G52 give the place another name.
    fn name(&mut self, how: Meaning, block: &Block, line: u32, text: &[u8], reading: &Reading) -> Result<(), Trouble> {
        let add = |place: Option<Quantity>, by: Option<Quantity>| Some(minus_negative(place?, by?));
        for axis in 0..6 {
            let in_frame = add(self.at[axis], self.local[axis]);
            let local = match how {
                Meaning::NameOff(true) => Some(Quantity::ZERO),
                Meaning::NameOff(false) => self.aside[axis],
                _ => {
                    let Some(word) = block.axis(axis) else { continue };
                    let value = self.value(word, axis, text, reading.decimal).ok_or(Trouble::TooFar(*word))?;
                    if how == Meaning::Name { in_frame.map(|at| at.minus(value)) } else { Some(value) }
                }
            };
            self.local[axis] = local;
            let unknown_name = how == Meaning::Name && local.is_none();
            self.at[axis] = match (in_frame, local) {
                (Some(at), Some(local)) => Some(at.minus(local)),
                _ if unknown_name => block.axis(axis).and_then(|w| self.value(w, axis, text, reading.decimal)),
                _ => None,
            };
            if local.is_none() {
                self.named_unknown = Some(line);
            }
        }
        // G92.2 leaves the numbers for G92.3, G92.1 does not.
        if how != Meaning::NameOff(true) {
            self.aside = self.local;
        } else if block.words.iter().any(|w| w.tenths() == Some(921)) {
            self.aside = [Some(Quantity::ZERO); 6];
        }
        Ok(())
    }

    /// Keeps the most decimals the program writes.
    fn note_decimals(&mut self, block: &Block) {
        for axis in 0..6 {
            if let Some(number) = block.axis(axis).and_then(|word| word.value) {
                let most = &mut self.decimals[usize::from(axis >= 3)];
                *most = number.decimals().max(*most);
            }
        }
    }

    /// Whether the feed of a cutting block is missing under G93.
    pub(super) fn lacks_inverse_time(&self, block: &Block) -> bool {
        self.feed_mode == FeedMode::InverseTime && block.word(b'F').is_none()
    }

    pub(super) fn cuts(&self) -> bool {
        !matches!(self.motion, Motion::None | Motion::Traverse)
    }
}

/// a + b.
fn minus_negative(a: Quantity, b: Quantity) -> Quantity {
    a.minus(Quantity::ZERO.minus(b))
}

/// What makes the order of the lines, or a place, depend on running the program.
fn steered(block: &Block) -> Option<Range<usize>> {
    if let Some(span) = &block.control {
        return Some(span.clone());
    }
    let computed = |w: &&Word| w.value.is_none() && matches!(w.letter, b'G' | b'M' | b'A'..=b'C' | b'U'..=b'Z');
    let calls = |w: &&Word| w.letter == b'G' && matches!(w.tenths(), Some(650 | 660 | 661));
    let polar = |w: &&Word| matches!(w.letter, b'@' | b'^');
    block.words.iter().find(|w| computed(w) || calls(w) || polar(w)).map(Word::span)
}

/// Whether an assignment may write an offset: `#5001` … `#7999` and above 14000, or a number that is computed.
fn is_offset(assignment: &[u8]) -> bool {
    let mut bytes = assignment.iter().skip(1).filter(|b| !b.is_ascii_whitespace()).peekable();
    match bytes.peek() {
        Some(b'<') => false,
        Some(b) if b.is_ascii_digit() => {
            let digits: Vec<u8> = bytes.take_while(|b| b.is_ascii_digit()).copied().take(7).collect();
            let number = digits.iter().fold(0u32, |n, d| n * 10 + u32::from(d - b'0'));
            matches!(number, 5_000..=7_999 | 14_000..)
        }
        _ => true,
    }
}
