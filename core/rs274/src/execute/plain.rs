//! The commonest blocks: G0 or G1 with X, Y, Z and F, or some of them; G2 or G3 with I and J beside these; one comment.
//!
//! The steps are those of [`execute`](Execution::execute) that such a block comes to, in the same order; all others are left out
//! without a look at each.

use super::super::flow::Sentence;
use super::super::{Axes, Canon, GcodeError, Motion, Plane, Word};
use super::Execution;
use super::arc::{absolute_centre, centre_from_offsets};

/// The words of such a block, each once.
#[derive(Default)]
struct Words<'w> {
    axes: [Option<&'w Word>; 3],
    /// I and J.
    centre: [Option<&'w Word>; 2],
    feed: Option<&'w Word>,
    code: Option<&'w Word>,
}

impl<'w> Words<'w> {
    /// `None` when there is any other, or one twice.
    fn of(words: &'w [Word]) -> Option<Self> {
        let mut found = Self::default();
        let ([x, y, z], [i, j]) = (&mut found.axes, &mut found.centre);
        for word in words {
            let place = match word.letter {
                b'X' => &mut *x,
                b'Y' => &mut *y,
                b'Z' => &mut *z,
                b'I' => &mut *i,
                b'J' => &mut *j,
                b'F' => &mut found.feed,
                b'G' => &mut found.code,
                _ => return None,
            };
            if place.replace(word).is_some() {
                return None;
            }
        }
        Some(found)
    }
}

impl<'p> Execution<'p, '_, '_> {
    /// Executes a block that has nothing else; `false`, and nothing done, for any other.
    pub(super) fn plain_block(&mut self, sentence: &Sentence<'p>) -> Result<bool, GcodeError> {
        if self.returning.is_some() {
            return Ok(false);
        }
        if let Some(body) = sentence.remark {
            self.feed_given = false;
            self.emit(Canon::Comment(body), sentence.line.span())?;
            return Ok(true);
        }
        if !sentence.is_plain {
            return Ok(false);
        }
        let Some(words) = Words::of(&sentence.words) else { return Ok(false) };
        let motion = match words.code {
            Some(word) => path(word),
            None => self.modal.motion,
        };
        let has_centre = words.centre.iter().any(Option::is_some);
        match motion {
            Some(Motion::Traverse | Motion::Feed) if !has_centre => {}
            Some(Motion::Arc { .. })
                if has_centre && self.modal.plane == Plane::Xy && !self.modal.absolute_centres => {}
            _ => return Ok(false),
        }
        let Some(motion) = motion else { return Ok(false) };
        self.feed_given = words.feed.is_some();
        if let Some(word) = words.feed {
            self.set_feed(*word)?;
        }
        if let Some(word) = words.code {
            self.set_motion(motion.code(), word.span)?;
        }
        if let Motion::Arc { counter_clockwise } = motion {
            self.plain_arc(&words, counter_clockwise, &sentence.words)?;
        } else if words.axes.iter().any(Option::is_some) || (words.code.is_some() && self.options.machine.is_some()) {
            let to = self.plain_place(&words)?;
            let span = self.block_span();
            if motion == Motion::Traverse {
                self.traverse_to(to, span)?;
            } else {
                self.check_feed()?;
                self.check_revolutions()?;
                self.feed_to(to, span)?;
            }
        }
        Ok(true)
    }

    /// Where the axes lead.
    #[inline]
    fn plain_place(&mut self, words: &Words<'_>) -> Result<Axes, GcodeError> {
        let mut to = self.at;
        for (axis, word) in words.axes.into_iter().enumerate() {
            let Some(word) = word else { continue };
            match self.silent_target(word, axis) {
                Some(place) => to.set(axis, Some(place)),
                None => self.lead(&mut to, axis, word)?,
            }
        }
        Ok(to)
    }

    fn plain_arc(&mut self, found: &Words<'_>, counter_clockwise: bool, words: &[Word]) -> Result<(), GcodeError> {
        let to = self.plain_place(found)?;
        let (start, _) = self.arc_ends(to)?;
        let [i, j] = found.centre;
        let i = i.map(|word| self.length(*word)).transpose()?;
        let j = j.map(|word| self.length(*word)).transpose()?;
        let absolute = absolute_centre(i, j, *b"IJ").ok();
        self.arc_about((centre_from_offsets(start, i, j), absolute), to, 0, counter_clockwise, words)
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
