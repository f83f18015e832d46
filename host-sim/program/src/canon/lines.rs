//! Numbered lines of canonical calls, gathered in memory and written in large pieces.

use std::io::{self, Write};

use super::argument::Argument;
use super::number::{Count, MILLION, SHORT, Short, push_ratio, push_real, push_whole};

/// Bytes gathered before they are written.
const PIECE: usize = 1 << 16;

/// Of a block without an N word.
const NO_LABEL: &[u8; 7] = b"N..... ";

/// Room for a line of a move whose numbers are short: more than its number, label, name, six arguments and end.
const ROOM: usize = 12 * SHORT;

/// Bytes made ready behind the text at a time, for some lines.
const AHEAD: usize = 8 * ROOM;

/// The axes that turn while they stand at zero, and the end of the line.
const NOT_TURNED: &[u8; 24] = b"0.0000, 0.0000, 0.0000)\n";

/// The text being written.
pub(super) struct Lines<W> {
    out: W,
    text: Vec<u8>,
    /// Where the text ends, when there is room made ready behind it.
    end: Option<usize>,
    /// Of the last line.
    count: Count,
    /// `N10   ` or `N..... `.
    label: Vec<u8>,
    /// Whether it names a block.
    labelled: bool,
    /// What the writer answered when it failed; nothing is written after that.
    failed: Option<io::Error>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(out: W) -> Self {
        let text = Vec::with_capacity(PIECE * 2);
        Self { out, text, end: None, count: Count::new(), label: NO_LABEL.to_vec(), labelled: false, failed: None }
    }

    /// The N word of the block the next lines belong to, its digits before the point.
    #[inline]
    pub(super) fn set_label(&mut self, digits: Option<&[u8]>) {
        if digits.is_some() || self.labelled {
            self.change_label(digits);
        }
    }

    fn change_label(&mut self, digits: Option<&[u8]>) {
        self.labelled = digits.is_some();
        self.label.clear();
        let Some(digits) = digits else { return self.label.extend_from_slice(NO_LABEL) };
        self.label.push(b'N');
        self.label.extend_from_slice(digits);
        while self.label.len() < 6 {
            self.label.push(b' ');
        }
        self.label.push(b' ');
    }

    /// The text, to be gone on with.
    #[inline]
    fn text(&mut self) -> &mut Vec<u8> {
        if let Some(end) = self.end.take() {
            self.text.truncate(end);
        }
        &mut self.text
    }

    /// Begins a line with the name of a call: everything up to its opening parenthesis.
    pub(super) fn open(&mut self, name: &str) {
        self.count.next();
        self.begin(name.as_bytes());
        self.text.push(b'(');
    }

    /// The number of the line, its label and a name.
    fn begin(&mut self, name: &[u8]) {
        self.text();
        self.count.push(&mut self.text);
        self.text.extend_from_slice(&self.label);
        self.text.extend_from_slice(name);
    }

    /// Ends it.
    pub(super) fn close(&mut self) {
        self.text().extend_from_slice(b")\n");
        if self.text.len() >= PIECE {
            self.pass_on();
        }
    }

    /// A call whose arguments are text.
    pub(super) fn call(&mut self, name: &str, arguments: &str) {
        self.open(name);
        self.push(arguments);
        self.close();
    }

    /// A comment of the interpreter.
    pub(super) fn remark(&mut self, text: &str) {
        self.open("COMMENT");
        self.push("\"interpreter: ");
        self.push(text);
        self.push("\"");
        self.close();
    }

    /// A line that is no call: what a program prints.
    pub(super) fn bare(&mut self, text: &[u8]) {
        self.text().extend_from_slice(text);
        self.text.push(b'\n');
    }

    pub(super) fn push(&mut self, text: &str) {
        self.text().extend_from_slice(text.as_bytes());
    }
    pub(super) fn push_whole(&mut self, number: u64) {
        push_whole(self.text(), number);
    }
    pub(super) fn push_real(&mut self, value: f64) {
        push_real(self.text(), value);
    }

    /// A call that moves: its name with the parenthesis, its arguments, and where the axes that turn stand.
    #[inline]
    pub(super) fn call_move<const N: usize, const A: usize>(
        &mut self,
        name: &[u8; N],
        arguments: &[Argument; A],
        unit: i64,
        turned: [i64; 3],
    ) {
        let count = self.count.next();
        let start = self.end.unwrap_or(self.text.len());
        if self.text.len() < start + ROOM {
            self.text.resize(start + AHEAD, 0);
        }
        self.end = Some(start);
        let room = self.text.get_mut(start..).and_then(|rest| rest.first_chunk_mut());
        let written = match (room, count, self.label.as_array()) {
            (Some(line), Some(count), Some(label)) if turned == [0; 3] => {
                write_move(line, count, label, name, arguments)
            }
            _ => None,
        };
        let Some(length) = written else { return self.call_long_move(name, arguments, unit, turned) };
        self.end = Some(start + length);
        if start + length >= PIECE {
            self.pass_on();
        }
    }

    /// The same of long numbers, piece by piece.
    #[cold]
    fn call_long_move(&mut self, name: &[u8], arguments: &[Argument], unit: i64, turned: [i64; 3]) {
        self.begin(name);
        let text = self.text();
        for argument in arguments {
            argument.push(text, unit);
        }
        self.push_values(&turned.map(|value| (value, MILLION)), ", ");
        self.close();
    }

    /// Values in their units, separated.
    pub(super) fn push_values(&mut self, values: &[(i64, i64)], separator: &str) {
        let text = self.text();
        for (index, (value, unit)) in values.iter().enumerate() {
            if index > 0 {
                text.extend_from_slice(separator.as_bytes());
            }
            push_ratio(text, *value, *unit);
        }
    }

    #[cold]
    fn pass_on(&mut self) {
        self.text();
        if self.failed.is_none()
            && let Err(error) = self.out.write_all(&self.text)
        {
            self.failed = Some(error);
        }
        self.text.clear();
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// The first answer of the writer that was one.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.pass_on();
        match self.failed {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}

/// Writes the line of a move into room for it; gives its length, `None` when a number is long.
#[inline]
fn write_move<const N: usize, const A: usize>(
    line: &mut [u8; ROOM],
    count: Short,
    label: &[u8; 7],
    name: &[u8; N],
    arguments: &[Argument; A],
) -> Option<usize> {
    let mut at = count.put(line, 0);
    at = put(line, at, label);
    at = put(line, at, name);
    for argument in arguments {
        at = argument.short()?.put(line, at);
    }
    Some(put(line, at, NOT_TURNED))
}

/// Puts bytes down at a place; gives the place behind them.
#[inline]
fn put<const N: usize>(line: &mut [u8], at: usize, bytes: &[u8; N]) -> usize {
    if let Some(place) = line.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
        *place = *bytes;
    }
    at.wrapping_add(N)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_right_in_five_places_and_labels_left_in_six() {
        let mut out = Vec::new();
        let mut lines = Lines::new(&mut out);
        lines.call("A", "");
        lines.set_label(Some(b"10"));
        (0..9).for_each(|_| lines.call("B", "1"));
        lines.set_label(Some(b"1234567"));
        lines.call("C", "");
        lines.finish().expect("memory");
        let text = String::from_utf8(out).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines[0], lines[9], lines[10]), ("    1 N..... A()", "   10 N10    B(1)", "   11 N1234567 C()"));
    }

    #[test]
    fn a_move_is_written_whole_as_it_is_piece_by_piece() {
        let (mut whole, mut pieces) = (Vec::new(), Vec::new());
        let (mut one, mut other) = (Lines::new(&mut whole), Lines::new(&mut pieces));
        let values = [0, -1, 50, 123_456_789, -999_999_949, 9_999_999_950, -9_999_999_951, 1 << 60];
        for (unit, value) in [1_000_000, 25_400_000].into_iter().flat_map(|unit| values.map(|value| (unit, value))) {
            let arguments = [
                Argument::length(value, unit),
                Argument::turns(value < 0, value >> 40),
                Argument::length(-value, unit),
            ];
            for (label, turned) in [(None, [0; 3]), (Some(&b"1234567"[..]), [0; 3]), (Some(b"20"), [0, value, 0])] {
                one.set_label(label);
                one.call_move(b"M(", &arguments, unit, turned);
                other.set_label(label);
                other.count.next();
                other.call_long_move(b"M(", &arguments, unit, turned);
            }
            one.remark("between");
            other.remark("between");
        }
        (0..2000).for_each(|_| one.call_move(b"M(", &[Argument::length(5, 1_000_000)], 1_000_000, [0; 3]));
        one.finish().expect("memory");
        other.finish().expect("memory");
        assert!(whole.starts_with(&pieces));
        assert!(
            whole.ends_with(b"\n 2064 N20    M(0.0000, 0.0000, 0.0000, 0.0000)\n"),
            "{}",
            String::from_utf8_lossy(&whole[whole.len() - 60..])
        );
    }
}
