//! F and S, and what they mean: G93, G94, G95, G96, G97.

use super::super::block::BlockWords;
use super::super::group::Group;
use super::super::{
    Canon, CycleError, Dialect, FeedMode, GCode, GcodeError, GcodeErrorKind, SettingError, Units, WarningKind, Word,
};
use super::Execution;
use truepath_units::Real;

/// The largest F (mm/min) and S (rpm).
const LARGEST_RATE: i32 = 1_000_000_000;

impl Execution<'_, '_, '_> {
    pub(super) fn units(&mut self, block: &BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::Units) else {
            return Ok(());
        };
        let units = if matches!(code.tenths(), 200 | 700) { Units::Inches } else { Units::Millimetres };
        if units != self.modal.units && block.word(b'F').is_some() {
            self.warn(WarningKind::UnitsWithFeed, span);
        }
        self.units_given = true;
        self.modal.units = units;
        self.emit(Canon::Units(units), span)
    }

    /// G93, G94, G95, then F and S.
    pub(super) fn rates(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        if let Some((code, span)) = block.code(Group::FeedMode) {
            let mode = match code.tenths() {
                930 => FeedMode::InverseTime,
                950 => FeedMode::PerRevolution,
                _ => FeedMode::PerMinute,
            };
            // LinuxCNC itself forgets the feed even where the mode stays.
            if mode != self.modal.feed_mode || self.options.is_linuxcnc_itself() {
                self.modal.feed = None;
                self.modal.feed_mode = mode;
            }
            self.emit(Canon::FeedMode(mode), span)?;
        }
        // The S, and for Siemens the F, of G4 is its time.
        let dwells = block.code(Group::OneShot).is_some_and(|(code, _)| code.tenths() == 40)
            && [b'P', b'X', b'U'].iter().all(|&letter| block.word(letter).is_none());
        let is_time = dwells && self.options.dialect == Dialect::Siemens;
        self.feed_given = block.word(b'F').is_some() && !is_time;
        if let Some(word) = block.use_word_if(b'F', !is_time) {
            self.set_feed(word)?;
        }
        if let Some(word) = block.use_word_if(b'S', !dwells) {
            let speed = self.rate(word, word.value.real())?;
            self.modal.speed = Some(speed);
            self.emit(Canon::SpindleSpeed(speed), word.span)?;
        }
        Ok(())
    }

    /// F.
    pub(super) fn set_feed(&mut self, word: Word) -> Result<(), GcodeError> {
        let feed = if self.modal.feed_mode == FeedMode::InverseTime {
            word.value.real()
        } else {
            self.note_unit(&word);
            match self.modal.units {
                Units::Millimetres => word.value.real(),
                Units::Inches => word.value.real_ratio(254, 10),
            }
        };
        self.modal.feed = Some(self.rate(word, feed)?);
        self.emit(Canon::FeedRate(feed), word.span)
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

    /// G96 needs S (and takes D, the highest speed); G97.
    pub(super) fn surface_speed(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::SpindleMode) else {
            return Ok(());
        };
        if code.tenths() == 960 {
            block.use_word(b'D');
            if block.word(b'S').is_none() {
                return Err(self.error(CycleError::WordMissing { code, letter: b'S' }.into(), span));
            }
        }
        Ok(())
    }

    /// Warns of a cutting move without a feed.
    ///
    /// # Errors
    /// In G93 every block with a cutting move needs an F of its own.
    #[inline]
    pub(super) fn check_feed(&mut self) -> Result<(), GcodeError> {
        if self.modal.feed_mode == FeedMode::InverseTime && !self.feed_given {
            return Err(self.word_missing(GCode::from_tenths(930), b'F', self.block_span()));
        }
        if self.modal.feed.is_none_or(|f| f == 0) {
            self.warn(WarningKind::FeedMissing, self.block_span());
        }
        Ok(())
    }

    /// Refuses a cutting move in G95 with the spindle's speed 0.
    #[inline]
    pub(super) fn check_revolutions(&self) -> Result<(), GcodeError> {
        if self.modal.feed_mode == FeedMode::PerRevolution && self.modal.speed.is_none_or(|s| s == 0) {
            return Err(self.error(SettingError::FeedPerRevolution.into(), self.block_span()));
        }
        Ok(())
    }
}
