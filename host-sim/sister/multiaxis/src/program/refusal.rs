//! Errors of a five-axis program, with file, line and column.
//!
//! A program may be larger than memory, so the text an error points into is its line alone, with as many empty lines
//! in front as the file has.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use truepath_core::gcode::GcodeError;
use truepath_ground::codes::Row;
use truepath_ground::diagnostics::{InputError, Source};

use super::lines::{LONGEST, Line, LineReader};
use super::quantity::FARTHEST;
use super::step::Trouble;
use crate::codes::{A001, A002, A003, A004, A005, A006};

/// A line of a program, for errors.
#[derive(Clone, Copy, Debug)]
pub struct At<'l> {
    /// The file, as the user wrote it.
    pub name: &'l str,
    /// The line, counted from 1.
    pub number: u32,
    /// Its bytes.
    pub text: &'l [u8],
}

impl At<'_> {
    fn source(&self) -> (Source, usize) {
        let before = self.number.saturating_sub(1) as usize;
        let mut bytes = vec![b'\n'; before];
        bytes.extend_from_slice(self.text);
        (Source::new(self.name, bytes), before)
    }

    /// An error with the remedy of its row, at a span of the line.
    pub fn error(&self, row: Row, found: &str, expected: &str, span: Range<usize>) -> InputError {
        self.place(row.error(found, expected), span)
    }

    fn place(&self, error: InputError, span: Range<usize>) -> InputError {
        let (source, before) = self.source();
        error.at(&source, before + span.start..before + span.end)
    }

    /// An error of a whole line of a file, which is read once more; without its text when that is no longer there.
    pub fn error_in(path: &Path, number: u32, row: Row, [found, expected, help]: [&str; 3]) -> InputError {
        let mut line = Line::default();
        let file = File::open(path).map(BufReader::new);
        if let Ok(mut reader) = file.map(LineReader::new) {
            while reader.number() < number && matches!(reader.next(&mut line), Ok(true)) {}
        }
        if line.number != number || line.text.is_empty() {
            return InputError::new(row, format!("line {number}: {found}"), expected, help).in_file(path);
        }
        let blanks = line.text.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let name = path.display().to_string();
        let at = At { name: &name, number, text: &line.text };
        at.place(InputError::new(row, found, expected, help), blanks..line.text.len())
    }

    /// What the lexer does not understand.
    pub fn unread(&self, error: &GcodeError) -> InputError {
        let (source, before) = self.source();
        InputError::of_program(&source, &GcodeError { start: error.start + before, ..*error })
    }

    /// A line that is too long.
    pub fn too_long(&self) -> InputError {
        let found = format!("line {} is longer than {LONGEST} bytes", self.number);
        self.error(A001, &found, "a line as controls read them", 0..0)
    }

    /// What the control would refuse.
    pub fn trouble(&self, trouble: Trouble) -> InputError {
        let letter = |word: &super::block::Word| char::from(word.letter);
        let (row, found, expected, span) = match trouble {
            Trouble::Twice(word) => {
                (A002, format!("{} stands twice in one block", letter(&word)), "every axis once", word.span())
            }
            Trouble::NoAxis(word) => (
                A003,
                format!("the machine file has no axis {}", letter(&word)),
                "X, Y, Z and the two rotary axes of the machine file",
                word.span(),
            ),
            Trouble::NoMotion(word) => (
                A004,
                "axis words without a motion".to_owned(),
                "G0, G1, G2 or G3 before them, or in their block",
                word.span(),
            ),
            Trouble::TooFar(word) => (
                A005,
                format!("{} leads beyond the farthest place", letter(&word)),
                &*format!("a place within ±{FARTHEST} mm, or a hundred times as many degrees"),
                word.span(),
            ),
            Trouble::FeedMissing => (
                A006,
                "a cutting block without F while G93 is in force".to_owned(),
                "an F in every block that cuts under G93",
                0..self.text.len(),
            ),
        };
        self.error(row, &found, expected, span)
    }
}
