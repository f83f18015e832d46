//! The words of canned cycles: those of a block, and those that stay while the cycle stays.
//!
//! LinuxCNC's rule: R, the depth, Q, P, I, J, K stay from hole to hole of one cycle; another code needs them again.
//! Fanuc's: they stay until G80 or another motion.

use super::super::block::BlockWords;
use super::super::{CycleError, GCode, GcodeError, GcodeErrorKind, Span, WarningKind};
use super::Execution;
use super::memory::CycleMemory;

/// Repetitions of one block; more are an error.
const REPETITIONS: u32 = 10_000;

impl Execution<'_, '_, '_> {
    /// The words of this block, and those that stay from the last hole of the same cycle.
    pub(super) fn cycle_words(
        &mut self,
        block: &mut BlockWords<'_>,
        code: GCode,
        span: Span,
    ) -> Result<CycleMemory, GcodeError> {
        let keeps = self.options.dialect.keeps_words_of_cycles();
        let before = self.cycle.filter(|memory| memory.code == code || keeps);
        if let Some(memory) = self.cycle.filter(|memory| memory.code != code) {
            let kept = [b'R', self.letter(self.modal.plane.axes()[2])].into_iter().find(|&l| block.word(l).is_none());
            if let Some(letter) = kept.filter(|_| keeps && memory.code.tenths() != 870) {
                self.warn(WarningKind::CycleWordKept { letter }, span);
            }
        }
        let [_, _, third] = self.modal.plane.axes();
        let depth_letter = self.letter(third);
        let missing = |letter| GcodeErrorKind::from(CycleError::WordMissing { code, letter });
        let clearance = match self.use_length(block, b'R')? {
            Some(r) => r,
            None => before.map(|m| m.clearance).ok_or_else(|| self.error(missing(b'R'), span))?,
        };
        let depth = match self.use_length(block, depth_letter)? {
            Some(depth) => depth,
            None => before.map(|m| m.depth).ok_or_else(|| self.error(missing(depth_letter), span))?,
        };
        let pecking = matches!(code.tenths(), 730 | 830);
        let mut peck = before.and_then(|m| m.peck);
        if pecking || code.tenths() == 760 {
            peck = self.use_length(block, b'Q')?.or(peck);
        }
        if pecking && peck.is_none_or(|q| q <= 0) {
            return Err(self.error(missing(b'Q'), span));
        }
        let mut dwell = before.and_then(|m| m.dwell);
        if let Some(word) = block.use_word(b'P') {
            if word.value.is_negative() {
                return Err(self.error(GcodeErrorKind::Negative { letter: b'P' }, word.span));
            }
            dwell = Some(word.value);
        }
        if matches!(code.tenths(), 820 | 860 | 880 | 890) && dwell.is_none() {
            return Err(self.error(missing(b'P'), span));
        }
        let mut aside = before.map_or([None; 3], |m| m.aside);
        if code.tenths() == 870 {
            for (slot, letter) in aside.iter_mut().zip([b'I', b'J', b'K']) {
                *slot = self.use_length(block, letter)?.or(*slot);
            }
        }
        Ok(CycleMemory { code, clearance, depth, peck, dwell, aside })
    }

    pub(super) fn repetitions(&mut self, block: &mut BlockWords<'_>) -> Result<u32, GcodeError> {
        let Some(word) = block.use_word(b'L') else { return Ok(1) };
        match self.whole(word)? {
            0 => Err(self.error(CycleError::NoRepetition.into(), word.span)),
            n if n > REPETITIONS => Err(self.error(GcodeErrorKind::OutOfRange { letter: b'L' }, word.span)),
            n => Ok(n),
        }
    }
}
