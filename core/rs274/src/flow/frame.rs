//! Which lines of a file are the program: what stands between the two `%`.
//!
//! `%` as the first character of a line begins and ends a program (ISO 6983); text outside is a leader or a trailer.
//! A program may do without both and end with M2 or M30 alone, as LinuxCNC's do; one of the two by itself is noted, because a
//! file that was cut off looks the same.

use super::super::lexical::is_blank;
use super::super::{Line, Lines, Span, WarningKind, Warnings};

/// The lines of the program in its file.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Frame<'a> {
    /// Line of the opening `%`, 0 when there is none.
    open: u32,
    /// Line of the closing `%`, the largest number when there is none.
    close: u32,
    /// The first line with text outside.
    outside: Option<Line<'a>>,
    /// Where a missing `%` of the two is reported.
    last: Line<'a>,
}

impl<'a> Frame<'a> {
    /// Of a file in a language without `%`.
    pub(in super::super) const WHOLE: Self =
        Self { open: 1, close: u32::MAX - 1, outside: None, last: Line { number: 1, start: 0, text: &[] } };

    /// Of a file.
    pub(in super::super) fn of(program: &'a [u8]) -> Self {
        let mut last = Line { number: 1, start: 0, text: &[] };
        let (mut first, mut second) = (None, None);
        // The first text of the file, and behind each of the two.
        let (mut text, mut behind_first, mut behind_second) = (None, None, None);
        let mut only_remarks_before = true;
        let mut lines = Lines::new(program);
        loop {
            // From here to the next `%` nothing more is to be learnt.
            let settled = match (first, second) {
                (None, _) => text.is_some() && !only_remarks_before,
                (_, None) => behind_first.is_some(),
                _ => behind_second.is_some(),
            };
            if settled && second.is_some() {
                break;
            }
            if settled || lines.is_at_start() {
                match (lines.ahead(b'%'), first) {
                    (Some(at), _) if settled => lines.go_on_at(at),
                    (Some(_), _) => {}
                    (None, None) => break,
                    // The last line with text is where the second is missed.
                    (None, _) => {
                        last = lines.filter(|line| first_byte(line).is_some()).last().unwrap_or(last);
                        break;
                    }
                }
            }
            let Some(line) = lines.next() else { break };
            let Some(byte) = first_byte(&line) else { continue };
            last = line;
            let place = match (first, second) {
                (None, _) => &mut text,
                (_, None) => &mut behind_first,
                _ => &mut behind_second,
            };
            let is_percent = byte == b'%';
            if !(is_percent && second.is_none()) {
                place.get_or_insert(line);
            }
            if !is_percent {
                only_remarks_before &= first.is_some() || matches!(byte, b'(' | b';');
            } else if first.is_none() {
                first = Some(line.number);
            } else if second.is_none() {
                second = Some(line.number);
            }
        }
        let (open, close, outside) = match (first, second) {
            (Some(a), Some(b)) => (a, b, text.or(behind_second)),
            (Some(a), None) if only_remarks_before => (a, u32::MAX, text),
            (Some(a), None) => (0, a, behind_first),
            (None, _) => (0, u32::MAX, None),
        };
        Self { open, close, outside, last }
    }

    /// Whether a line belongs to the program, its `%` included.
    pub(in super::super) const fn holds(&self, line: u32) -> bool {
        self.open <= line && line <= self.close
    }

    /// Whether a line of the program has anything but a `%`.
    pub(in super::super) fn is_text(&self, line: &Line<'_>) -> bool {
        first_byte(line).is_some_and(|b| b != b'%')
    }

    /// Notes what is missing and what is outside.
    pub(in super::super) fn warn(&self, warnings: &mut Warnings) {
        if (self.open == 0) != (self.close == u32::MAX) {
            warnings.note(WarningKind::PercentMissing, &self.last, self.last.span());
        }
        if let Some(line) = self.outside {
            warnings.note(WarningKind::OutsidePercent, &line, Span { start: line.start, len: line.text.len() });
        }
    }
}

/// The first byte that is not a blank.
fn first_byte(line: &Line<'_>) -> Option<u8> {
    line.text.iter().copied().find(|&b| !is_blank(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn held(program: &str) -> (Vec<u32>, bool) {
        let frame = Frame::of(program.as_bytes());
        let lines = Lines::new(program.as_bytes()).filter(|l| frame.holds(l.number)).map(|l| l.number).collect();
        (lines, frame.outside.is_some())
    }

    #[test]
    fn the_program_lies_between_the_percents() {
        assert_eq!(held("%\nA\n%\n"), (std::vec![1, 2, 3], false));
        assert_eq!(held("leader\n%\nA\n%\ntrailer"), (std::vec![2, 3, 4], true));
    }

    #[test]
    fn what_lies_between_two_percents_is_not_looked_at() {
        let of = |text: &'static str| {
            let frame = Frame::of(text.as_bytes());
            (frame.open, frame.close, frame.outside.map(|line| line.number), frame.last.number)
        };
        assert_eq!(of("%\nA\nB (50 %)\n\n %\nC\nD\n%"), (1, 5, Some(6), 6));
        assert_eq!(of("A\nB (50 %)\n\n  %\nC\n\n"), (0, 4, Some(5), 5));
        assert_eq!(of("(a)\n%\nA\n(50 %)\nB\n\n"), (2, u32::MAX, Some(1), 5));
        assert_eq!(of("A\r%\rB\r%\rC").0, 2);
        assert_eq!(of("(a)\nA % \nB"), (0, u32::MAX, None, 2));
    }

    #[test]
    fn a_single_percent_opens_after_remarks_and_closes_after_blocks() {
        assert_eq!(held("(remark)\n%\nA\n"), (std::vec![2, 3], true));
        assert_eq!(held("A\n%\n\x1a\n"), (std::vec![1, 2], false));
        assert_eq!(held("A\nB"), (std::vec![1, 2], false));
    }
}
