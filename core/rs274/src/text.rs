//! Where things stand in a program: lines and spans of bytes.
//!
//! A program is bytes, not characters: comments may be in any code page. Lines end with LF or CR LF; with CR only in a
//! file without any LF, elsewhere a CR is a blank (LinuxCNC reads it so, and a tape in ISO code has LF alone as the end
//! of a block). Columns are bytes, counted from 1.

use core::fmt;

/// A run of bytes of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// Offset of its first byte from the start of the program.
    pub start: usize,
    /// Number of bytes.
    pub len: usize,
}

impl Span {
    /// Offset of the byte behind it.
    pub const fn end(self) -> usize {
        self.start.saturating_add(self.len)
    }
    /// Its bytes; empty when the program is not the one it was taken from.
    pub fn of(self, program: &[u8]) -> &[u8] {
        program.get(self.start..self.end()).unwrap_or(&[])
    }
}

/// Lines of a program from the first to the last, both included, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LineRange {
    /// The first line.
    pub first: u32,
    /// The last line.
    pub last: u32,
}

impl LineRange {
    /// Whether a line is one of them.
    pub const fn contains(self, line: u32) -> bool {
        self.first <= line && line <= self.last
    }
}

impl fmt::Display for LineRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.first == self.last {
            write!(f, "line {}", self.first)
        } else {
            write!(f, "lines {}-{}", self.first, self.last)
        }
    }
}

/// A byte as a reader can find it in the text.
pub(super) struct Byte(pub(super) u8);

impl fmt::Display for Byte {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_ascii_graphic() {
            write!(f, "`{}`", char::from(self.0))
        } else {
            write!(f, "byte 0x{:02X}", self.0)
        }
    }
}

/// A letter.
pub(super) struct Letter(pub(super) u8);

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", char::from(self.0))
    }
}

/// One line of the program, without its line end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// Counted from 1.
    pub number: u32,
    /// Offset of its first byte from the start of the program.
    pub start: usize,
    /// Its bytes.
    pub text: &'a [u8],
}

impl Line<'_> {
    /// Its bytes as a span.
    pub const fn span(&self) -> Span {
        Span { start: self.start, len: self.text.len() }
    }
}

/// The lines of a program, in order. A UTF-8 byte order mark at the start belongs to no line.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    program: &'a [u8],
    at: usize,
    number: u32,
    /// What ends a line.
    end: u8,
}

impl<'a> Lines<'a> {
    /// From the first line.
    pub fn new(program: &'a [u8]) -> Self {
        let at = if program.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        let end = if memchr::memchr(b'\n', program).is_some() { b'\n' } else { b'\r' };
        Self { program, at, number: 0, end }
    }
    /// Whether none of them has been taken.
    pub(super) const fn is_at_start(&self) -> bool {
        self.number == 0
    }
    /// Where a byte stands next in them.
    pub(super) fn ahead(&self, byte: u8) -> Option<usize> {
        let ahead = memchr::memchr(byte, self.program.get(self.at..)?)?;
        Some(self.at.saturating_add(ahead))
    }
    /// Goes on with the line that holds a place further on.
    pub(super) fn go_on_at(&mut self, place: usize) {
        let passed = self.program.get(self.at..place).unwrap_or(&[]);
        if let Some(last) = memchr::memrchr(self.end, passed) {
            let ends = memchr::memchr_iter(self.end, passed).count();
            self.number = self.number.saturating_add(u32::try_from(ends).unwrap_or(u32::MAX));
            self.at = self.at.saturating_add(last).saturating_add(1);
        }
    }
    /// From a line of them on.
    pub(super) const fn again(&self, line: &Line<'a>) -> Self {
        Self { program: self.program, at: line.start, number: line.number.saturating_sub(1), end: self.end }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    // One copy in the flash of a board.
    #[inline(never)]
    fn next(&mut self) -> Option<Line<'a>> {
        let rest = self.program.get(self.at..).filter(|r| !r.is_empty())?;
        let len = length_to(self.end, rest);
        let mut text = rest.get(..len)?;
        while let [before @ .., b'\r'] = text {
            text = before;
        }
        self.number = self.number.saturating_add(1);
        let line = Line { number: self.number, start: self.at, text };
        self.at = self.at.saturating_add(len).saturating_add(1);
        Some(line)
    }
}

/// Bytes up to the next `end`, or all. Most lines end in their first words, which are looked at here; a search of its own costs more
/// to begin.
#[inline]
fn length_to(end: u8, text: &[u8]) -> usize {
    const EACH: u64 = 0x0101_0101_0101_0101;
    const WORDS: usize = 5;
    let sought = u64::from(end).wrapping_mul(EACH);
    let mut passed = 0usize;
    for word in text.as_chunks().0.iter().take(WORDS) {
        let apart = u64::from_le_bytes(*word) ^ sought;
        // The highest bit of the first byte that is `end`; those behind it may be wrong.
        let found = apart.wrapping_sub(EACH) & !apart & (EACH * 0x80);
        if found != 0 {
            return passed.saturating_add(found.trailing_zeros() as usize / 8);
        }
        passed = passed.saturating_add(8);
    }
    let rest = text.get(passed..).unwrap_or(&[]);
    memchr::memchr(end, rest).map_or(text.len(), |more| passed.saturating_add(more))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn every_line_end_counts_once() {
        let lines = |text: &'static [u8]| Lines::new(text).map(|l| (l.number, l.start, l.text)).collect::<Vec<_>>();
        let expected = [(1, 3, &b"a"[..]), (2, 6, b"b\rc"), (3, 10, b""), (4, 11, b"d")];
        assert_eq!(lines(b"\xEF\xBB\xBFa\r\nb\rc\n\nd"), expected);
        assert_eq!(lines(b"a\r\rb"), [(1, 0, &b"a"[..]), (2, 2, b""), (3, 3, b"b")]);
        assert_eq!(lines(b"a\r\r\nb\r"), [(1, 0, &b"a"[..]), (2, 4, b"b")]);
    }

    #[test]
    fn the_end_of_a_line_is_found_wherever_it_stands() {
        for at in 0..90usize {
            let text: Vec<u8> =
                (0..90u8).map(|n| if usize::from(n) >= at && n % 3 == 0 { b'\n' } else { 0x8A ^ (n % 2) }).collect();
            assert_eq!(Some(length_to(b'\n', &text)), memchr::memchr(b'\n', &text).or(Some(90)));
            assert_eq!(length_to(b'\r', text.get(..at).unwrap_or(&[])), at);
        }
    }

    #[test]
    fn a_span_of_another_program_is_empty() {
        assert_eq!(Span { start: 3, len: 9 }.of(b"short"), b"");
    }
}
