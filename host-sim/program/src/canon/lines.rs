//! Numbered lines of canonical calls, gathered in memory and written in large pieces.

use std::io::{self, Write};

use super::number::{Count, Short, push_ratio, push_real, push_separated, push_whole, short_ratio};

/// Bytes gathered before they are written.
const PIECE: usize = 1 << 16;

/// Of a block without an N word.
const NO_LABEL: &[u8; 7] = b"N..... ";

/// The text being written.
pub(super) struct Lines<W> {
    out: W,
    text: Vec<u8>,
    /// Of the last line.
    count: Count,
    /// `N10   ` or `N..... `.
    label: Vec<u8>,
    /// Whether it names a block.
    labelled: bool,
    /// The last place of each axis.
    places: [Place; 3],
    /// What the writer answered when it failed; nothing is written after that.
    failed: Option<io::Error>,
}

/// Where an axis stands: it often stays there for many lines.
#[derive(Clone, Copy, Default)]
struct Place {
    value: i64,
    unit: i64,
    /// `None` when it is too long, or not written yet.
    text: Option<Short>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(out: W) -> Self {
        let text = Vec::with_capacity(PIECE * 2);
        let places = [Place::default(); 3];
        Self { out, text, count: Count::new(), label: NO_LABEL.to_vec(), labelled: false, places, failed: None }
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

    /// Begins a line with the name of a call: everything up to its opening parenthesis.
    pub(super) fn open(&mut self, name: &str) {
        self.begin();
        self.text.extend_from_slice(name.as_bytes());
        self.text.push(b'(');
    }

    /// The same of a call that moves, whose name brings its parenthesis along.
    #[inline]
    pub(super) fn open_move<const N: usize>(&mut self, name: &[u8; N]) {
        self.begin();
        self.text.extend_from_slice(name);
    }

    /// The number and the label.
    #[inline]
    fn begin(&mut self) {
        self.count.push_next(&mut self.text);
        match self.label.first_chunk::<7>() {
            Some(label) if self.label.len() == 7 => self.text.extend_from_slice(label),
            _ => self.text.extend_from_slice(&self.label),
        }
    }

    /// Ends it.
    #[inline]
    pub(super) fn close(&mut self) {
        self.text.extend_from_slice(b")\n");
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
        self.text.extend_from_slice(text);
        self.text.push(b'\n');
    }

    pub(super) fn push(&mut self, text: &str) {
        self.text.extend_from_slice(text.as_bytes());
    }
    pub(super) fn push_whole(&mut self, number: u64) {
        push_whole(&mut self.text, number);
    }
    pub(super) fn push_real(&mut self, value: f64) {
        push_real(&mut self.text, value);
    }

    /// Lengths, each with the separator behind it.
    #[inline]
    pub(super) fn push_lengths<const N: usize>(&mut self, values: [i64; N], unit: i64) {
        for value in values {
            push_separated(&mut self.text, value, unit);
        }
    }

    /// The place of an axis, with the separator behind it.
    #[inline]
    pub(super) fn push_place(&mut self, axis: usize, value: i64, unit: i64) {
        let place = &mut self.places[axis];
        if (place.value, place.unit) != (value, unit) {
            *place = Place { value, unit, text: short_ratio(value, unit) };
        }
        match place.text {
            Some(text) => text.push(&mut self.text),
            None => push_separated(&mut self.text, value, unit),
        }
    }

    /// The axes that turn, and the end of the line.
    #[inline]
    pub(super) fn close_turned(&mut self, turned: [i64; 3], unit: i64) {
        if turned == [0; 3] {
            self.text.extend_from_slice(b"0.0000, 0.0000, 0.0000");
        } else {
            self.push_values(&turned.map(|value| (value, unit)), ", ");
        }
        self.close();
    }

    /// Values in their units, separated.
    pub(super) fn push_values(&mut self, values: &[(i64, i64)], separator: &str) {
        for (index, (value, unit)) in values.iter().enumerate() {
            if index > 0 {
                self.text.extend_from_slice(separator.as_bytes());
            }
            push_ratio(&mut self.text, *value, *unit);
        }
    }

    #[cold]
    fn pass_on(&mut self) {
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
}
