//! M codes that switch something, and the codes that set how the path is followed.

use super::super::block::BlockWords;
use super::super::group::Group;
use super::super::mcode::{MCode, MCodes};
use super::super::{
    Canon, Coolant, CycleError, Dialect, GcodeError, GcodeErrorKind, Number, PathControl, SettingError, Span, Spindle,
    WarningKind,
};
use super::Execution;
use truepath_units::Offset;

impl Execution<'_, '_, '_> {
    /// M62 … M68: outputs and inputs, with the words they need.
    pub(super) fn inputs_and_outputs(&mut self, block: &mut BlockWords<'_>, m: &MCodes) -> Result<(), GcodeError> {
        let Some(code) = m.io else { return Ok(()) };
        let number = code.number;
        let missing = |letter| GcodeErrorKind::from(SettingError::MWordMissing { m: number, letter });
        match number {
            62..=65 => {
                let Some(word) = block.use_word(b'P') else { return Err(self.error(missing(b'P'), code.span)) };
                self.whole(word)?;
            }
            66 => self.wait_words(block, code)?,
            _ => {
                let Some(word) = block.use_word(b'E') else { return Err(self.error(missing(b'E'), code.span)) };
                self.whole(word)?;
                block.use_word(b'Q');
            }
        }
        self.emit(Canon::OtherM(number), code.span)
    }

    /// M66: P or E, L how to wait, Q how long.
    fn wait_words(&mut self, block: &mut BlockWords<'_>, code: MCode) -> Result<(), GcodeError> {
        let digital = block.word(b'P').is_some();
        let Some(word) = block.use_word(b'P').or_else(|| block.use_word(b'E')) else {
            return Err(self.error(SettingError::MWordMissing { m: 66, letter: b'P' }.into(), code.span));
        };
        self.whole(word)?;
        let wait = match block.use_word(b'L') {
            // The value of an analog input can only be read.
            Some(word) => self.between(word, 0, if digital { 4 } else { 0 })?,
            None => 0,
        };
        let time = block.use_word(b'Q');
        if wait != 0 && time.is_none_or(|q| q.value.is_negative() || q.value.exactly_times(1) == Some(0)) {
            return Err(self.error(SettingError::WaitWithoutTime.into(), code.span));
        }
        Ok(())
    }

    /// M3, M4, M5, M19.
    pub(super) fn spindle(&mut self, block: &mut BlockWords<'_>, m: &MCodes) -> Result<(), GcodeError> {
        let Some(code) = m.spindle else { return Ok(()) };
        if code.number == 19 {
            if let Some(word) = block.use_word(b'R')
                && (word.value.is_negative() || word.value.real() > 360)
            {
                return Err(self.error(GcodeErrorKind::OutOfRange { letter: b'R' }, word.span));
            }
            for letter in [b'Q', b'P'] {
                block.use_word(letter);
            }
            return self.emit(Canon::OtherM(19), code.span);
        }
        let to = match code.number {
            3 => Spindle::Clockwise,
            4 => Spindle::CounterClockwise,
            _ => Spindle::Stopped,
        };
        self.turn(to, code.span)
    }

    /// M7, M8, M9; M48 … M53; codes that are not known.
    pub(super) fn switches(&mut self, block: &mut BlockWords<'_>, m: &MCodes) -> Result<(), GcodeError> {
        for code in &m.coolant {
            self.coolant = match code.number {
                7 => (true, self.coolant.1),
                8 => (self.coolant.0, true),
                _ => (false, false),
            };
            let coolant = match code.number {
                7 => Coolant::Mist,
                8 => Coolant::Flood,
                _ => Coolant::Off,
            };
            self.emit(Canon::Coolant(coolant), code.span)?;
        }
        if let Some(code) = m.overrides {
            block.use_word(b'P');
            self.emit(Canon::OtherM(code.number), code.span)?;
        }
        for code in &m.other {
            self.warn(WarningKind::UnknownM { m: code.number }, code.span);
            self.emit(Canon::OtherM(code.number), code.span)?;
        }
        if !m.other.is_empty() {
            // Their own words, as user codes take them (M100 P0 Q5).
            for letter in [b'P', b'L', b'Q', b'E'] {
                block.use_word(letter);
            }
        }
        Ok(())
    }

    pub(super) fn dwell(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((_, span)) = block.code(Group::OneShot).filter(|(c, _)| c.tenths() == 40) else {
            return Ok(());
        };
        // X and U are Fanuc's other letters for the time: no axis moves.
        let siemens = self.options.dialect == Dialect::Siemens;
        let word = [b'P', b'X', b'U'].iter().find_map(|&letter| block.use_word(letter));
        let word = word.or_else(|| block.use_word_if(b'F', siemens)).or_else(|| block.use_word(b'S'));
        let Some(word) = word else {
            return Err(self.error(GcodeErrorKind::DwellWithoutTime, span));
        };
        if word.value.is_negative() {
            return Err(self.error(GcodeErrorKind::Negative { letter: word.letter }, word.span));
        }
        let time = match word.letter {
            b'S' if siemens => self.revolutions(word.value),
            b'S' => {
                self.warn(WarningKind::DwellByS, word.span);
                word.value
            }
            _ => word.value,
        };
        self.emit(Canon::Dwell(time), span)
    }

    /// The seconds of some turns of the spindle; 0 while it has no speed.
    #[expect(clippy::float_arithmetic, reason = "a time, of which no place depends")]
    fn revolutions(&self, turns: Number) -> Number {
        match self.modal.speed.map(|speed| Number::of_real(speed, 1, 1)) {
            Some(speed) if speed > 0.0 => Number::Computed(turns.value() * 60.0 / speed),
            _ => Number::ZERO,
        }
    }

    /// G61, G61.1, G64 P Q; G187 P E, G5 P, G5.1 Q R, G8 P, G103 P are words of other controls for the like and set nothing
    /// that is known here.
    pub(super) fn path_control(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        if block.code(Group::Smoothness).is_some() {
            for letter in [b'P', b'E', b'Q', b'R'] {
                block.use_word(letter);
            }
        }
        let Some((code, span)) = block.code(Group::PathControl) else {
            return Ok(());
        };
        let path = match code.tenths() {
            610 => PathControl::Exact,
            611 => {
                // Mazak names the shape of the corners.
                if self.options.dialect == Dialect::Fanuc
                    && let Some(word) = block.use_word(b'P')
                {
                    self.warn(WarningKind::IdleWord { letter: b'P' }, word.span);
                }
                PathControl::ExactStop
            }
            _ => {
                let tolerance = self.tolerance(block, b'P')?;
                PathControl::Blend { tolerance, merge: self.tolerance(block, b'Q')? }
            }
        };
        self.modal.path = Some(path);
        self.emit(Canon::PathControl(path), span)
    }

    fn tolerance(&mut self, block: &mut BlockWords<'_>, letter: u8) -> Result<Option<Offset>, GcodeError> {
        let Some(word) = block.use_word(letter) else {
            return Ok(None);
        };
        if word.value.is_negative() {
            return Err(self.error(GcodeErrorKind::Negative { letter }, word.span));
        }
        self.length(word).map(Some)
    }

    /// M0, M1, M2, M30, M60.
    pub(super) fn stop(&mut self, m: &MCodes) -> Result<(), GcodeError> {
        let Some(code) = m.stop else { return Ok(()) };
        match code.number {
            0 | 1 => self.emit(Canon::Stop { optional: code.number == 1 }, code.span),
            60 => {
                self.emit(Canon::OtherM(60), code.span)?;
                self.emit(Canon::Stop { optional: false }, code.span)
            }
            number => {
                self.end = Some(number);
                self.emit(Canon::End(number), code.span)
            }
        }
    }

    /// An error about a word that a code of this block needs.
    pub(super) fn word_missing(&self, code: super::super::GCode, letter: u8, span: Span) -> GcodeError {
        self.error(CycleError::WordMissing { code, letter }.into(), span)
    }
}
