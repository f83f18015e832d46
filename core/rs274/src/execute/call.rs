//! Codes that leave the sequence of blocks: G65, M97, M98, M99. They are followed by the reader.

use super::super::block::BlockWords;
use super::super::flow::{Next, Target};
use super::super::group::Group;
use super::super::mcode::MCodes;
use super::super::{CycleError, Dialect, GcodeError, Number, PointlessLength, SettingError, WarningKind, Word};
use super::Execution;

/// Repetitions of a call in one block.
const REPETITIONS: u32 = 9_999;

impl Execution<'_, '_, '_> {
    /// G65: every other word of the block is an argument.
    /// Where numbers without a point are in least increments, a length among the arguments must have one.
    pub(super) fn macro_call(&self, block: &BlockWords<'_>) -> Result<Option<Next>, GcodeError> {
        let Some((code, span)) = block.code(Group::OneShot).filter(|(code, _)| code.tenths() == 650) else {
            return Ok(None);
        };
        let Some(word) = block.word(b'P') else {
            return Err(self.error(CycleError::WordMissing { code, letter: b'P' }.into(), span));
        };
        if self.options.decimal == PointlessLength::Least {
            let open = |word: &Word| match word.value {
                Number::Exact(number) => number.mantissa() != 0 && !word.has_point(self.text),
                Number::Computed(_) => false,
            };
            if let Some(word) = b"ABCIJKQRUVWXYZ".iter().find_map(|&letter| block.word(letter).filter(open)) {
                return Err(self.error(SettingError::ArgumentWithoutPoint { letter: word.letter }.into(), word.span));
            }
        }
        let times = block.word(b'L').map(|word| self.between(word, 1, REPETITIONS)).transpose()?.unwrap_or(1);
        let target = Target::Program(self.whole(word)?);
        Ok(Some(Next::Call { target, times, arguments: true, span }))
    }

    /// M97, M98, M99.
    pub(super) fn subprogram(&mut self, block: &mut BlockWords<'_>, m: &MCodes) -> Result<Option<Next>, GcodeError> {
        let Some(code) = m.call else { return Ok(None) };
        let (p, l) = (block.use_word(b'P'), block.use_word(b'L'));
        if code.number == 99 {
            let to = p.map(|word| self.whole(word)).transpose()?;
            if to.is_none() && self.source.depth == 0 {
                self.repeats = true;
                self.warn(WarningKind::Repeats, code.span);
            }
            return Ok(Some(Next::Return { to, span: code.span }));
        }
        let Some(word) = p else {
            return Err(self.error(SettingError::MWordMissing { m: code.number, letter: b'P' }.into(), code.span));
        };
        let times = l.map(|word| self.between(word, 0, REPETITIONS)).transpose()?;
        // LinuxCNC passes over it; the manuals of others do not say.
        if let (Some(word), Some(0)) = (l, times)
            && !self.options.dialect.has_o_words()
        {
            self.warn(WarningKind::CallOfNoTimes, word.span);
        }
        let number = self.whole(word)?;
        let (number, packed) = self.unpacked(word, number);
        let target = if code.number == 97 { Target::Block(number) } else { Target::Program(number) };
        let times = times.or(packed).unwrap_or(1);
        Ok(Some(Next::Call { target, times, arguments: false, span: code.span }))
    }

    /// Fanuc's `P0031000`: program 1000 three times, when more than four digits are written.
    fn unpacked(&self, word: Word, number: u32) -> (u32, Option<u32>) {
        let digits = word.span.of(self.text).iter().filter(|b| b.is_ascii_digit()).count();
        let fanuc = matches!(self.options.dialect, Dialect::Fanuc);
        if fanuc && digits > 4 && number >= 10_000 { (number % 10_000, Some(number / 10_000)) } else { (number, None) }
    }
}
