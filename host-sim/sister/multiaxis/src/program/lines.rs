//! The lines of a program of any size, one at a time, with their ends as they are.
//!
//! Memory is one line and one buffer. CR, LF and CR LF end a line, as they do for the interpreter of the core; the last
//! line may have no end. Limit: a line has at most [`LONGEST`] bytes.

use std::io::{self, BufRead};

/// Bytes of the longest line.
pub const LONGEST: usize = 65_536;

/// One line.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// Counted from 1.
    pub number: u32,
    /// Its bytes without its end.
    pub text: Vec<u8>,
    /// Its end: nothing, `\n`, `\r` or `\r\n`.
    pub end: &'static [u8],
}

/// Why there is no next line.
#[derive(Debug)]
pub enum LineError {
    /// The file cannot be read.
    Io(io::Error),
    /// The line is longer than [`LONGEST`].
    TooLong,
}

impl From<io::Error> for LineError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Reads lines.
#[derive(Debug)]
pub struct LineReader<R> {
    input: R,
    number: u32,
    bytes: u64,
}

impl<R: BufRead> LineReader<R> {
    /// From the first line.
    pub fn new(input: R) -> Self {
        Self { input, number: 0, bytes: 0 }
    }
    /// Bytes read.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
    /// Number of the line read last.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Reads the next line into `line`; `false` when there is none.
    ///
    /// # Errors
    /// The file cannot be read, or the line is too long; its number is then [`LineReader::number`].
    pub fn next(&mut self, line: &mut Line) -> Result<bool, LineError> {
        line.text.clear();
        line.end = b"";
        self.number = self.number.saturating_add(1);
        line.number = self.number;
        loop {
            let held = self.input.fill_buf()?;
            if held.is_empty() {
                return Ok(!line.text.is_empty());
            }
            let length = held.iter().position(|b| matches!(b, b'\n' | b'\r'));
            let taken = length.unwrap_or(held.len());
            if line.text.len() + taken > LONGEST {
                return Err(LineError::TooLong);
            }
            line.text.extend_from_slice(&held[..taken]);
            let ending = length.map(|at| held[at]);
            self.take(taken + usize::from(ending.is_some()));
            match ending {
                None => {}
                Some(b'\n') => line.end = b"\n",
                Some(_) if self.input.fill_buf()?.first() == Some(&b'\n') => {
                    self.take(1);
                    line.end = b"\r\n";
                }
                Some(_) => line.end = b"\r",
            }
            if ending.is_some() {
                return Ok(true);
            }
        }
    }

    fn take(&mut self, bytes: usize) {
        self.input.consume(bytes);
        self.bytes += bytes as u64;
    }
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    fn read(text: &[u8], buffer: usize) -> Vec<(u32, Vec<u8>, &'static [u8])> {
        let mut reader = LineReader::new(BufReader::with_capacity(buffer, text));
        let (mut line, mut lines) = (Line::default(), Vec::new());
        while reader.next(&mut line).unwrap() {
            lines.push((line.number, line.text.clone(), line.end));
        }
        assert_eq!(reader.bytes(), text.len() as u64);
        lines
    }

    #[test]
    fn every_line_end_is_kept_whatever_the_buffer_holds() {
        for buffer in 1..9 {
            let lines = read(b"a\r\nb\rc\n\nd", buffer);
            let expected: [(u32, &[u8], &[u8]); 5] =
                [(1, b"a", b"\r\n"), (2, b"b", b"\r"), (3, b"c", b"\n"), (4, b"", b"\n"), (5, b"d", b"")];
            assert_eq!(lines.len(), expected.len());
            for ((number, text, end), (n, t, e)) in lines.iter().zip(expected) {
                assert_eq!((*number, text.as_slice(), *end), (n, t, e), "buffer {buffer}");
            }
        }
    }

    #[test]
    fn a_line_beyond_the_limit_is_refused_before_it_is_held() {
        let text = vec![b'X'; 10 * LONGEST];
        let mut reader = LineReader::new(BufReader::new(&text[..]));
        assert!(matches!(reader.next(&mut Line::default()), Err(LineError::TooLong)));
        assert!(reader.bytes() <= LONGEST as u64);
    }
}
