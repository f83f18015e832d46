//! Errors of a five-axis program, with file, line and column.
//!
//! A program may be larger than memory, so the text an error points into is its line alone, with as many empty lines
//! in front as the file has.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use truepath_core::gcode::GcodeError;
use truepath_ground::diagnostics::{InputError, Source};

use super::lines::{LONGEST, Line, LineReader};
use super::quantity::FARTHEST;
use super::step::Trouble;

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

    /// An error at a span of the line.
    pub fn error(&self, code: &str, found: String, expected: &str, help: &str, span: Range<usize>) -> InputError {
        let (source, before) = self.source();
        InputError::new(code, found, expected, help).at(&source, before + span.start..before + span.end)
    }

    /// The same for a whole line of a file, which is read once more; without its text when that is no longer there.
    pub fn error_in(path: &Path, number: u32, code: &str, [found, expected, help]: [&str; 3]) -> InputError {
        let mut line = Line::default();
        let file = File::open(path).map(BufReader::new);
        if let Ok(mut reader) = file.map(LineReader::new) {
            while reader.number() < number && matches!(reader.next(&mut line), Ok(true)) {}
        }
        if line.number != number || line.text.is_empty() {
            return InputError::new(code, format!("line {number}: {found}"), expected, help).in_file(path);
        }
        let blanks = line.text.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let name = path.display().to_string();
        let at = At { name: &name, number, text: &line.text };
        at.error(code, found.to_owned(), expected, help, blanks..line.text.len())
    }

    /// What the lexer does not understand.
    pub fn unread(&self, error: &GcodeError) -> InputError {
        let (source, before) = self.source();
        InputError::of_program(&source, &GcodeError { start: error.start + before, ..*error })
    }

    /// A line that is too long.
    pub fn too_long(&self) -> InputError {
        self.error(
            "A001",
            format!("line {} is longer than {LONGEST} bytes", self.number),
            "a line as controls read them",
            "check that this is a program, and that its lines end",
            0..0,
        )
    }

    /// What the control would refuse.
    pub fn trouble(&self, trouble: Trouble) -> InputError {
        let letter = |word: &super::block::Word| char::from(word.letter);
        match trouble {
            Trouble::Twice(word) => self.error(
                "A002",
                format!("{} stands twice in one block", letter(&word)),
                "every axis once",
                "remove one of them, or write two blocks",
                word.span(),
            ),
            Trouble::NoAxis(word) => self.error(
                "A003",
                format!("the machine file has no axis {}", letter(&word)),
                "X, Y, Z and the two rotary axes of the machine file",
                "name the axis in the machine file, or take the file of the machine the program is for",
                word.span(),
            ),
            Trouble::NoMotion(word) => self.error(
                "A004",
                "axis words without a motion".to_owned(),
                "G0, G1, G2 or G3 before them, or in their block",
                "write the motion that the control has at power-up into the program",
                word.span(),
            ),
            Trouble::TooFar(word) => self.error(
                "A005",
                format!("{} leads beyond the farthest place", letter(&word)),
                &format!("a place within ±{FARTHEST} mm, or a hundred times as many degrees"),
                "correct the number",
                word.span(),
            ),
            Trouble::FeedMissing => self.error(
                "A006",
                "a cutting block without F while G93 is in force".to_owned(),
                "an F in every block that cuts under G93",
                "add the F, or G94 where the inverse time ends",
                0..self.text.len(),
            ),
        }
    }
}
