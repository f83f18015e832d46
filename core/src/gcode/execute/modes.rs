//! The codes of one block that set modes, in their order of execution.

use super::super::block::{BlockWords, whole};
use super::super::code::Group;
use super::super::mcode::MCodes;
use super::super::{
    Canon, Coolant, Event, GcodeError, GcodeErrorKind, Motion, PathControl, Plane, Spindle, ToolLength, Units,
    WarningKind, Word,
};
use super::Execution;
use crate::units::{Offset, Real};

/// The largest F (mm/min) and S (rpm).
const LARGEST_RATE: i32 = 1_000_000;

impl<S> Execution<'_, '_, '_, S>
where
    S: FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
{
    /// Executes a block.
    pub(super) fn execute(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        if let Some((second, span)) = block.program {
            if let Some(first) = self.program_number {
                return Err(self.error(GcodeErrorKind::SecondProgram { first, second }, span));
            }
            self.program_number = Some(second);
            return self.emit(Canon::ProgramNumber(second), span);
        }
        let m = MCodes::sorted(block).map_err(|(kind, span)| self.error(kind, span))?;
        self.units(block)?;
        self.rates(block)?;
        self.tool(block, &m)?;
        self.switches(&m)?;
        if !m.other.is_empty() {
            // Their own words: M64 P0, M66 P0 L3 Q5.
            for letter in [b'P', b'L', b'Q'] {
                block.use_word(letter);
            }
        }
        self.dwell(block)?;
        if let Some((_, span)) = block.code(Group::Plane) {
            self.emit(Canon::Plane(Plane::Xy), span)?;
        }
        self.compensation(block)?;
        self.tool_length(block)?;
        self.work_offset(block)?;
        self.path_control(block)?;
        if let Some((code, _)) = block.code(Group::Distance) {
            self.modal.absolute = code.tenths() == 900;
        }
        if let Some((code, _)) = block.code(Group::ArcDistance) {
            self.modal.absolute_centres = code.tenths() == 901;
        }
        self.moves(block)?;
        for letter in [b'H', b'D'] {
            if let Some(word) = block.use_word(letter) {
                self.warn(WarningKind::UnusedOffsetNumber { letter }, word.span);
            }
        }
        if let Some(word) = block.first_unused() {
            return Err(self.error(GcodeErrorKind::UnusedWord { letter: word.letter }, word.span));
        }
        self.stop(&m)
    }

    fn units(&mut self, block: &BlockWords) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::Units) else {
            return Ok(());
        };
        let units = if code.tenths() == 200 { Units::Inches } else { Units::Millimetres };
        if units != self.modal.units && block.word(b'F').is_some() {
            self.warn(WarningKind::UnitsWithFeed, span);
        }
        self.units_given = true;
        self.modal.units = units;
        self.emit(Canon::Units(units), span)
    }

    fn rates(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        if let Some(word) = block.use_word(b'F') {
            self.note_unit(word);
            let feed = match self.modal.units {
                Units::Millimetres => word.value.real(),
                Units::Inches => word.value.real_ratio(254, 10),
            };
            self.modal.feed = Some(self.rate(word, feed)?);
            self.emit(Canon::FeedRate(feed), word.span)?;
        }
        if let Some(word) = block.use_word(b'S') {
            let speed = self.rate(word, word.value.real())?;
            self.modal.speed = Some(speed);
            self.emit(Canon::SpindleSpeed(speed), word.span)?;
        }
        Ok(())
    }

    fn rate(&self, word: Word, value: Real) -> Result<Real, GcodeError> {
        let letter = word.letter;
        if value < 0 {
            return Err(self.error(GcodeErrorKind::Negative { letter }, word.span));
        }
        if value > LARGEST_RATE {
            return Err(self.error(GcodeErrorKind::OutOfRange { letter }, word.span));
        }
        Ok(value)
    }

    fn tool(&mut self, block: &mut BlockWords, m: &MCodes) -> Result<(), GcodeError> {
        if let Some(word) = block.use_word(b'T') {
            let tool = self.whole(word)?;
            self.modal.selected = Some(tool);
            self.emit(Canon::SelectTool(tool), word.span)?;
        }
        if let Some(code) = m.tool {
            self.modal.tool = self.modal.selected;
            // Many machines lift to change the tool, and the new one has another length.
            self.at.z = None;
            self.emit(Canon::ChangeTool(self.modal.tool), code.span)?;
        }
        Ok(())
    }

    fn switches(&mut self, m: &MCodes) -> Result<(), GcodeError> {
        if let Some(code) = m.spindle {
            self.modal.spindle = match code.number {
                3 => Spindle::Clockwise,
                4 => Spindle::CounterClockwise,
                _ => Spindle::Stopped,
            };
            self.emit(Canon::Spindle(self.modal.spindle), code.span)?;
        }
        for code in &m.coolant {
            let coolant = match code.number {
                7 => Coolant::Mist,
                8 => Coolant::Flood,
                _ => Coolant::Off,
            };
            self.emit(Canon::Coolant(coolant), code.span)?;
        }
        for code in &m.other {
            self.warn(WarningKind::UnknownM { m: code.number }, code.span);
            self.emit(Canon::OtherM(code.number), code.span)?;
        }
        Ok(())
    }

    fn dwell(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        let Some((_, span)) = block.code(Group::OneShot).filter(|(c, _)| c.tenths() == 40) else {
            return Ok(());
        };
        // X is Fanuc's other letter for the time: no axis moves.
        let Some(word) = block.use_word(b'P').or_else(|| block.use_word(b'X')) else {
            return Err(self.error(GcodeErrorKind::DwellWithoutTime, span));
        };
        if word.value.is_negative() {
            return Err(self.error(GcodeErrorKind::Negative { letter: word.letter }, word.span));
        }
        self.emit(Canon::Dwell(word.value), span)
    }

    /// A new tool length gives the same place another Z.
    fn tool_length(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        let (length, span) = match block.code(Group::ToolLength) {
            Some((code, span)) if code.tenths() == 490 => (ToolLength::Off, span),
            Some((code, span)) if code.tenths() == 431 => {
                for letter in [b'X', b'Y', b'Z'] {
                    if let Some(word) = block.use_word(letter) {
                        self.length(word)?;
                        self.forget(letter);
                    }
                }
                (ToolLength::InProgram, span)
            }
            Some((_, span)) => {
                let number = block.use_word(b'H').map(|w| self.whole(w)).transpose()?;
                (ToolLength::Table(number), span)
            }
            None if self.modal.length_offset => {
                let Some(word) = block.use_word(b'H') else {
                    return Ok(());
                };
                (ToolLength::Table(Some(self.whole(word)?)), word.span)
            }
            None => return Ok(()),
        };
        self.modal.length_offset = length != ToolLength::Off;
        self.at.z = None;
        self.emit(Canon::ToolLength(length), span)
    }

    fn work_offset(&mut self, block: &BlockWords) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::WorkOffset) else {
            return Ok(());
        };
        let system = match code.tenths() {
            tenths @ 540..=590 => (tenths / 10).saturating_sub(53),
            tenths => tenths.saturating_sub(584),
        };
        if system != self.modal.work_offset {
            self.forget_all();
        }
        self.modal.work_offset = system;
        self.emit(Canon::WorkOffset(system), span)
    }

    fn path_control(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::PathControl) else {
            return Ok(());
        };
        let path = match code.tenths() {
            610 => PathControl::Exact,
            611 => PathControl::ExactStop,
            _ => {
                let tolerance = self.tolerance(block, b'P')?;
                PathControl::Blend { tolerance, merge: self.tolerance(block, b'Q')? }
            }
        };
        self.modal.path = Some(path);
        self.emit(Canon::PathControl(path), span)
    }

    fn tolerance(&mut self, block: &mut BlockWords, letter: u8) -> Result<Option<Offset>, GcodeError> {
        let Some(word) = block.use_word(letter) else {
            return Ok(None);
        };
        if word.value.is_negative() {
            return Err(self.error(GcodeErrorKind::Negative { letter }, word.span));
        }
        self.length(word).map(Some)
    }

    fn stop(&mut self, m: &MCodes) -> Result<(), GcodeError> {
        let Some(code) = m.stop else { return Ok(()) };
        match code.number {
            0 | 1 => self.emit(Canon::Stop { optional: code.number == 1 }, code.span),
            number => {
                self.end = Some(number);
                self.emit(Canon::End(number), code.span)
            }
        }
    }

    /// The number of a word that must be whole.
    pub(super) fn whole(&self, word: Word) -> Result<u32, GcodeError> {
        whole(word).map_err(|kind| self.error(kind, word.span))
    }

    /// Sets the motion that stays.
    pub(super) fn set_motion(&mut self, tenths: u16) {
        self.modal.motion = match tenths {
            0 => Some(Motion::Traverse),
            10 => Some(Motion::Feed),
            20 => Some(Motion::Arc { counter_clockwise: false }),
            30 => Some(Motion::Arc { counter_clockwise: true }),
            _ => None,
        };
    }
}
