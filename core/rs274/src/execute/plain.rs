//! The commonest blocks: G0 or G1, X, Y, Z and F, or some of them.
//!
//! The steps are those of [`execute`](Execution::execute) that such a block comes to, in the same order; all others are left out
//! without a look at each.

use super::super::flow::Sentence;
use super::super::{GcodeError, Motion, Word};
use super::Execution;

impl<'p> Execution<'p, '_, '_> {
    /// Executes a block that has nothing but these words, each once; `false`, and nothing done, for any other.
    pub(super) fn plain_move(&mut self, sentence: &Sentence<'p>) -> Result<bool, GcodeError> {
        if !sentence.is_plain || self.returning.is_some() {
            return Ok(false);
        }
        let (mut axes, mut feed, mut code) = ([None; 3], None, None);
        let [x, y, z] = &mut axes;
        for word in &sentence.words {
            let place = match word.letter {
                b'X' => &mut *x,
                b'Y' => &mut *y,
                b'Z' => &mut *z,
                b'F' => &mut feed,
                b'G' => &mut code,
                _ => return Ok(false),
            };
            if place.replace(word).is_some() {
                return Ok(false);
            }
        }
        let motion = match code {
            Some(word) => straight(word),
            None => self.modal.motion,
        };
        let Some(motion @ (Motion::Traverse | Motion::Feed)) = motion else { return Ok(false) };
        self.feed_given = feed.is_some();
        if let Some(word) = feed {
            self.set_feed(*word)?;
        }
        if let Some(word) = code {
            self.set_motion(motion.code(), word.span)?;
        }
        let named = axes.iter().any(Option::is_some);
        if named || (code.is_some() && self.options.machine.is_some()) {
            let span = self.block_span();
            let mut to = self.at;
            for (axis, word) in axes.into_iter().enumerate() {
                if let Some(word) = word {
                    self.lead(&mut to, axis, word)?;
                }
            }
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
}

/// G0 or G1.
fn straight(word: &Word) -> Option<Motion> {
    match word.value.exactly_times(10) {
        Some(0) => Some(Motion::Traverse),
        Some(10) => Some(Motion::Feed),
        _ => None,
    }
}
