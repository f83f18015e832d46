//! Words of a line that a control prints: a letter and a number, padded with blanks.

use super::error::{ProbeError, ProbeErrorKind};
use super::number::{Number, Signs};
use truepath_rs274::Line;

/// What a control sends around and between words: blanks, control characters (NUL, DC1 to DC4, DEL, also with the
/// eighth bit) and the percent sign.
pub(super) const fn is_filler(byte: u8) -> bool {
    matches!(byte, 0..=b' ' | b'%' | 0x7F..=0xA0)
}

/// The words of a line, each letter at most once.
pub(super) struct Words<'a> {
    line: Line<'a>,
    words: [Option<Number>; 26],
}

const fn slot(letter: u8) -> usize {
    letter.to_ascii_uppercase().wrapping_sub(b'A') as usize
}

impl<'a> Words<'a> {
    /// Reads a line from an offset to its end.
    pub(super) fn of(line: Line<'a>, start: usize) -> Result<Self, ProbeError> {
        let mut words = [None; 26];
        let mut rest = line.text.get(start..).unwrap_or_default();
        loop {
            rest = behind_filler(rest);
            let [letter, behind @ ..] = rest else { return Ok(Self { line, words }) };
            let malformed = |text: &[u8], rest: &[u8]| {
                ProbeError::before(ProbeErrorKind::Malformed { expected: "words such as X12.345" }, &line, text, rest)
            };
            let slot = words.get_mut(slot(*letter)).filter(|slot| letter.is_ascii_alphabetic() && slot.is_none());
            let slot = slot.ok_or_else(|| malformed(&[*letter], behind))?;
            let behind = behind_filler(behind);
            let (negative, behind) = match behind {
                [b'-', behind @ ..] => (true, behind_filler(behind)),
                [b'+', behind @ ..] => (false, behind_filler(behind)),
                _ => (false, behind),
            };
            let len = behind.iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
            let (digits, after) = behind.split_at_checked(len).unwrap_or((behind, b""));
            if digits.is_empty() {
                return Err(malformed(after.get(..1).unwrap_or_default(), after.get(1..).unwrap_or_default()));
            }
            let number = Number::parse(digits, Signs::POINT);
            let number = number.map_err(|kind| ProbeError::before(kind, &line, digits, after))?;
            *slot = Some(if negative { number.negated() } else { number });
            rest = after;
        }
    }

    /// The number behind a letter, if it is there; the word counts as read.
    pub(super) fn take(&mut self, letter: u8) -> Option<Number> {
        self.words.get_mut(slot(letter)).and_then(Option::take)
    }

    /// Whether a letter is there and not read yet.
    pub(super) fn has(&self, letter: u8) -> bool {
        self.words.get(slot(letter)).is_some_and(Option::is_some)
    }

    /// The number behind a letter that must be there.
    pub(super) fn need(&mut self, letter: u8) -> Result<Number, ProbeError> {
        let missing = ProbeError::of_line(ProbeErrorKind::WordMissing { letter: char::from(letter) }, &self.line);
        self.take(letter).ok_or(missing)
    }

    /// The number of the point.
    pub(super) fn number(&mut self) -> Result<Option<u32>, ProbeError> {
        let malformed = ProbeErrorKind::Malformed { expected: "N with a whole number" };
        self.take(b'N').map(|n| n.whole().ok_or(ProbeError::of_line(malformed, &self.line))).transpose()
    }

    /// Words that may be there and mean nothing.
    pub(super) fn ignore(&mut self, letters: &[u8]) {
        for letter in letters {
            let _ = self.take(*letter);
        }
    }

    /// The line, when every word was read.
    pub(super) fn finish(&self) -> Result<Line<'a>, ProbeError> {
        if self.words.iter().all(Option::is_none) {
            return Ok(self.line);
        }
        let expected = "words of G800 (N X Y Z I J K O U L) or G801 (N X Y Z R)";
        Err(ProbeError::of_line(ProbeErrorKind::Malformed { expected }, &self.line))
    }
}

fn behind_filler(text: &[u8]) -> &[u8] {
    let len = text.iter().take_while(|b| is_filler(**b)).count();
    text.get(len..).unwrap_or_default()
}
