//! Numbered lines of canonical calls, gathered in memory and written in large pieces.

use std::io::{self, Write};

use super::number::{push_ratio, push_real, push_whole};

/// Bytes gathered before they are written.
const PIECE: usize = 1 << 16;

/// The text being written.
pub(super) struct Lines<W> {
    out: W,
    text: Vec<u8>,
    /// The running number of the last line.
    number: u64,
    /// `N10   ` or `N..... `.
    label: Vec<u8>,
    /// What the writer answered when it failed; nothing is written after that.
    failed: Option<io::Error>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(out: W) -> Self {
        let mut lines = Self { out, text: Vec::with_capacity(PIECE * 2), number: 0, label: Vec::new(), failed: None };
        lines.set_label(None);
        lines
    }

    /// The N word of the block the next lines belong to, its digits before the point.
    pub(super) fn set_label(&mut self, digits: Option<&[u8]>) {
        self.label.clear();
        match digits {
            Some(digits) => {
                self.label.push(b'N');
                self.label.extend_from_slice(digits);
            }
            None => self.label.extend_from_slice(b"N....."),
        }
        while self.label.len() < 6 {
            self.label.push(b' ');
        }
        self.label.push(b' ');
    }

    /// Begins a line with the name of a call: everything up to its opening parenthesis.
    pub(super) fn open(&mut self, name: &str) {
        self.number += 1;
        let mut limit = 10_000;
        while self.number < limit && limit > 1 {
            self.text.push(b' ');
            limit /= 10;
        }
        push_whole(&mut self.text, self.number);
        self.text.push(b' ');
        self.text.extend_from_slice(&self.label);
        self.text.extend_from_slice(name.as_bytes());
        self.text.push(b'(');
    }

    /// Ends it.
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

    /// Values in their units, separated.
    pub(super) fn push_values(&mut self, values: &[(i64, i64)], separator: &str) {
        for (index, (value, unit)) in values.iter().enumerate() {
            if index > 0 {
                self.text.extend_from_slice(separator.as_bytes());
            }
            push_ratio(&mut self.text, *value, *unit);
        }
    }

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
