//! Errors as the user meets them: what was found and where, what was expected, what to do.
//!
//! Two kinds exist. An [`InputError`] is the user's to mend (exit code 1) and always says all three; an internal
//! [`Failure`] is ours (exit code 2). On a terminal an input error is drawn with the offending text underlined, in a
//! pipe it is the same without colour or box characters, and with `--json` it is one object on standard error:
//! `{"error":{"code","message","file","line","column","found","expected","help"}}`. In every form the place reads
//! `file:line:column`, lines and columns counted from 1, columns in characters. Control characters, wherever they come
//! from, are shown ([`visible`]), never sent.

mod source;
mod visible;

use std::ops::Range;
use std::path::Path;
use std::{fmt, io};

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan};
use truepath_core::gcode::GcodeError;

use crate::codes::{C001, F001, F002, Row, X001};
use crate::files;
use crate::length::Unit;

pub use source::Source;
pub use visible::{visible, visible_lines};

impl Source {
    /// Reads a file; `-` is standard input.
    ///
    /// # Errors
    /// `F001` when it cannot be read.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        if path == Path::new("-") {
            let bytes = files::standard_input().map_err(|e| InputError::unreadable(path, &e))?;
            return Ok(Self::new("standard input", bytes));
        }
        let bytes = files::read(path).map_err(|e| InputError::unreadable(path, &e))?;
        Ok(Self::new(path.display().to_string(), bytes))
    }
}

/// An error in what the user gave.
#[derive(Clone, Debug)]
pub struct InputError(Box<Body>);

#[derive(Clone, Debug)]
struct Body {
    code: String,
    found: String,
    expected: String,
    help: String,
    file: Option<String>,
    place: Option<(Source, Range<usize>)>,
    label: Option<String>,
    /// The exit code it ends with.
    exit: u8,
}

impl Row {
    /// An error of this row with its remedy; the texts are those of [`InputError::new`].
    pub fn error(self, found: impl Into<String>, expected: impl Into<String>) -> InputError {
        InputError::new(self, found, expected, self.remedy)
    }
}

impl InputError {
    /// `found` is a clause naming what is there, `expected` a noun phrase (empty when `found` says it), `help` an
    /// instruction.
    pub fn new(row: Row, found: impl Into<String>, expected: impl Into<String>, help: impl Into<String>) -> Self {
        Self::of_core(row.code, found, expected, help)
    }
    /// The same with a code of the core, which has rows of its own.
    pub fn of_core(
        code: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        let code = code.into();
        Self(Box::new(Body {
            // What is wrong with a command line is the same whoever finds it.
            exit: if code == C001.code { 2 } else { 1 },
            code,
            found: visible_lines(&found.into()).into_owned(),
            expected: visible(&expected.into()).into_owned(),
            help: visible(&help.into()).into_owned(),
            file: None,
            place: None,
            label: None,
        }))
    }
    /// The same, pointing at a byte span of a text.
    #[must_use]
    pub fn at(mut self, source: &Source, span: Range<usize>) -> Self {
        self.0.file = Some(visible(source.name()).into_owned());
        self.0.place = Some((source.clone(), span));
        self
    }
    /// The same, naming a file it has no place in.
    #[must_use]
    pub fn in_file(mut self, path: &Path) -> Self {
        self.0.file = Some(visible(&path.display().to_string()).into_owned());
        self
    }
    /// The same of a file that was copied below `folder` to be read: it is named from there on, in the texts as well.
    #[must_use]
    pub fn without_folder(mut self, folder: &Path) -> Self {
        let own = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
        let bare = |text: &str| text.replace(&own, "");
        let Body { found, expected, help, file, place, .. } = &mut *self.0;
        [found, expected, help].into_iter().chain(file).for_each(|text| *text = bare(text));
        if let Some((source, _)) = place {
            *source = Source::new(bare(source.name()), source.bytes().to_vec());
        }
        self
    }
    /// The same with its lengths, which are in millimetres (`25.4 mm`), in a unit.
    #[must_use]
    pub fn told_in(mut self, unit: Unit) -> Self {
        let Body { found, expected, help, .. } = &mut *self.0;
        [found, expected, help].into_iter().for_each(|text| *text = unit.retold(text).into_owned());
        self
    }
    /// The same with the names of keys, which are in millimetres (`tool.diameter_mm`), as a file in a unit has them.
    #[must_use]
    pub fn with_keys_in(mut self, unit: Unit) -> Self {
        let Body { found, expected, help, .. } = &mut *self.0;
        [found, expected, help].into_iter().for_each(|text| *text = unit.keys(text).into_owned());
        self
    }
    /// The same as a refusal by judgement: every file could be read, together they do not do.
    #[must_use]
    pub fn by_judgement(mut self) -> Self {
        self.0.exit = 3;
        self
    }
    /// The words written beside the underlined text.
    #[must_use]
    pub fn labelled(mut self, label: impl Into<String>) -> Self {
        self.0.label = Some(visible(&label.into()).into_owned());
        self
    }
    /// A file that cannot be read (`F001`).
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        let found = format!("{} cannot be read ({})", path.display(), plain_reason(error));
        F001.error(found, "a readable file").in_file(path)
    }
    /// A file that cannot be written (`F002`).
    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        let found = format!("{} cannot be written ({})", path.display(), plain_reason(error));
        F002.error(found, "a writable place").in_file(path)
    }
    /// The clause naming what was found.
    pub fn found(&self) -> &str {
        &self.0.found
    }
    /// The stable code.
    pub fn code(&self) -> &str {
        &self.0.code
    }
    /// An error of a program, with the place the core names, in the unit that holds there.
    pub fn of_program(source: &Source, error: &GcodeError) -> Self {
        let sentence = error.kind.to_string();
        let (found, help) = sentence.split_once("; ").unwrap_or((&sentence, "correct the program"));
        let span = error.span();
        let unit = Unit::at(source.bytes(), span.start);
        Self::of_core(error.kind.code(), found, "", help).told_in(unit).at(source, span.start..span.end())
    }
    /// Line and column, both from 1, when the error has a place.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        self.0.place.as_ref().map(|(source, span)| source.line_column(span.start))
    }
    /// The object printed with `--json`.
    pub fn to_json(&self) -> serde_json::Value {
        let place = self.line_column();
        serde_json::json!({"error": {
            "code": self.0.code,
            "message": self.to_string(),
            "file": self.0.file,
            "line": place.map(|p| p.0),
            "column": place.map(|p| p.1),
            "found": self.0.found,
            "expected": (!self.0.expected.is_empty()).then_some(&self.0.expected),
            "help": self.0.help,
        }})
    }
}

/// The sentence without its place and without the help: what was found; what was expected.
impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.found)?;
        if self.0.expected.is_empty() { Ok(()) } else { write!(f, "; expected {}", self.0.expected) }
    }
}

impl std::error::Error for InputError {}

impl miette::Diagnostic for InputError {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(format!("error[{}]", self.0.code)))
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.0.help))
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (source, span) = self.0.place.as_ref()?;
        let span = source.readable_span(span);
        Some(Box::new(std::iter::once(LabeledSpan::new(self.0.label.clone(), span.start, span.len()))))
    }
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.0.place.as_ref().map(|(source, _)| source as &dyn miette::SourceCode)
    }
}

/// Why a command did not do its work.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The user's to mend: exit code 1; 2 where it is the command line, 3 where
    /// everything could be read and was judged not to do.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A wrong command line, with the text that explains it: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// A fault of the program: exit code 2.
    #[error("internal error: {0}")]
    Internal(String),
}

impl Failure {
    /// 1 for wrong input, 2 for a wrong command line or an internal error, 3 for a refusal by judgement.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(error) => error.0.exit,
            Self::Usage(_) | Self::Internal(_) => 2,
        }
    }

    /// What is printed on standard error, ending in a line feed.
    pub fn render(&self, form: Form) -> String {
        match (self, form) {
            (Self::Input(error), Form::Json) => format!("{}\n", error.to_json()),
            (Self::Internal(message), Form::Json) => {
                let error = serde_json::json!({"error": {
                    "code": X001.code, "message": self.to_string(), "file": null, "line": null, "column": null,
                    "found": message, "expected": null, "help": X001.remedy}});
                format!("{error}\n")
            }
            (Self::Usage(text), _) => visible_lines(text).into_owned(),
            (Self::Internal(_), _) => {
                format!("error[{}]: {}\n  help: {}\n", X001.code, visible_lines(&self.to_string()), X001.remedy)
            }
            (Self::Input(error), Form::Colour) => drawn(error, GraphicalTheme::unicode(), 120),
            (Self::Input(error), Form::Plain) => drawn(error, GraphicalTheme::none(), 1000),
        }
    }
}

/// How an error is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Drawn, for a terminal.
    Colour,
    /// The same without colour and without box characters.
    Plain,
    /// One JSON object on one line.
    Json,
}

fn drawn(error: &InputError, theme: GraphicalTheme, width: usize) -> String {
    let mut text = String::new();
    let handler = GraphicalReportHandler::new_themed(theme).with_links(false).with_width(width);
    // Formatting into a String cannot fail; a report that did would still leave the sentence.
    if handler.render_report(&mut text, error).is_err() {
        text = format!("{error}\n");
    }
    text
}

/// The operating system's reason without its number.
fn plain_reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_copied_to_be_read_is_named_as_the_user_knows_it() {
        let copy = Path::new("/tmp/copied/then/part/probe.txt");
        let source = Source::new(copy.display().to_string(), b"1 2".to_vec());
        let error = F001.error(format!("{} is short", copy.display()), "three numbers").at(&source, 0..3);
        let shown = error.without_folder(Path::new("/tmp/copied/then"));
        assert_eq!(shown.to_json()["error"]["file"], "part/probe.txt");
        assert_eq!(shown.found(), "part/probe.txt is short");
        let drawn = Failure::Input(shown).render(Form::Plain);
        assert!(drawn.contains("part/probe.txt:1:1") && !drawn.contains("copied"), "{drawn}");
    }
}
