//! The commonest blocks: G0 or G1 with X, Y, Z and F, or some of them; G2 or G3 with I and J beside these; one comment.
//!
//! The steps are those of [`execute`](Execution::execute) that such a block comes to, in the same order; all others are left out
//! without a look at each. Where the words of a block have more to say than where it leads (a warning, an error), it takes the long way.

use super::super::block::bit;
use super::super::flow::Sentence;
use super::super::{Axes, Canon, GcodeError, Motion, Number, Plane, Word};
use super::Execution;
use super::arc::{absolute_centre, centre_from_offsets};
use super::axes::FARTHEST_NM;
use truepath_units::{Offset, Position};

/// What the words of such a block say, each written once.
struct Said<'w> {
    to: Axes,
    /// I and J.
    centre: [Option<Offset>; 2],
    feed: Option<&'w Word>,
    code: Option<&'w Word>,
    /// The letters that stand here.
    letters: u64,
}

impl<'p> Execution<'p, '_, '_> {
    /// Executes a block that has nothing else; `false`, and nothing done, for any other.
    #[inline]
    pub(super) fn plain_block(&mut self, sentence: &Sentence<'p>) -> Result<bool, GcodeError> {
        if self.returning.is_some() {
            return Ok(false);
        }
        if let Some(body) = sentence.remark {
            self.feed_given = false;
            self.emit(Canon::Comment(body), sentence.line.span())?;
            return Ok(true);
        }
        if !sentence.is_plain || !self.units_given {
            return Ok(false);
        }
        let Some(said) = self.said(&sentence.words) else { return Ok(false) };
        let motion = match said.code {
            Some(word) => path(word),
            None => self.modal.motion,
        };
        let has_centre = said.letters & (bit(b'I') | bit(b'J')) != 0;
        let Some(motion) = motion else { return Ok(false) };
        match motion {
            Motion::Traverse | Motion::Feed if !has_centre => {}
            Motion::Arc { .. } if has_centre && self.modal.plane == Plane::Xy && !self.modal.absolute_centres => {}
            _ => return Ok(false),
        }
        self.feed_given = said.feed.is_some();
        if let Some(word) = said.feed {
            self.set_feed(*word)?;
        }
        if let Some(word) = said.code {
            self.set_motion(motion.code(), word.span)?;
        }
        if let Motion::Arc { counter_clockwise } = motion {
            let (start, _) = self.arc_ends(said.to)?;
            let [i, j] = said.centre;
            let centre = (centre_from_offsets(start, i, j), absolute_centre(i, j, *b"IJ").ok());
            self.arc_about(centre, said.to, 0, counter_clockwise, &sentence.words)?;
        } else if said.letters & (bit(b'X') | bit(b'Y') | bit(b'Z')) != 0
            || (said.code.is_some() && self.options.machine.is_some())
        {
            let span = self.block_span();
            if motion == Motion::Traverse {
                self.traverse_to(said.to, span)?;
            } else {
                self.check_feed()?;
                self.check_revolutions()?;
                self.feed_to(said.to, span)?;
            }
        }
        Ok(true)
    }

    /// `None` when there is any other word, or one twice, or one that the long way has to judge.
    #[inline]
    fn said<'w>(&self, words: &'w [Word]) -> Option<Said<'w>> {
        let mut said = Said { to: self.at, centre: [None; 2], feed: None, code: None, letters: 0 };
        for word in words {
            if said.letters & bit(word.letter) != 0 {
                return None;
            }
            said.letters |= bit(word.letter);
            match word.letter {
                b'X' => said.to.x = Some(self.leads(word, said.to.x)?),
                b'Y' => said.to.y = Some(self.leads(word, said.to.y)?),
                b'Z' => said.to.z = Some(self.leads(word, said.to.z)?),
                b'I' => said.centre[0] = Some(self.plain_length(word)?),
                b'J' => said.centre[1] = Some(self.plain_length(word)?),
                b'F' => said.feed = Some(word),
                b'G' => said.code = Some(word),
                _ => return None,
            }
        }
        Some(said)
    }

    /// Where an axis at a place is led by a word.
    #[inline]
    fn leads(&self, word: &Word, at: Option<Position>) -> Option<Position> {
        let by = self.plain_length(word)?;
        let from = if self.modal.absolute { Position::ZERO } else { at? };
        Some(from + by).filter(|to| to.nm().unsigned_abs() <= FARTHEST_NM)
    }

    /// A written length within reach, of which nothing is to be said.
    #[inline]
    fn plain_length(&self, word: &Word) -> Option<Offset> {
        let Number::Exact(number) = word.value else { return None };
        if self.reads_points && number.mantissa() != 0 && !word.has_point(self.text) {
            return None;
        }
        let nm = number.in_64(self.modal.units.nanometres())?;
        if nm.unsigned_abs() <= FARTHEST_NM { Some(Offset::from_nm(nm)) } else { None }
    }
}

/// G0, G1, G2 or G3.
fn path(word: &Word) -> Option<Motion> {
    match word.value.exactly_times(10) {
        Some(0) => Some(Motion::Traverse),
        Some(10) => Some(Motion::Feed),
        Some(20) => Some(Motion::Arc { counter_clockwise: false }),
        Some(30) => Some(Motion::Arc { counter_clockwise: true }),
        _ => None,
    }
}
