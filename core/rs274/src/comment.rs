//! Comments that speak: LinuxCNC's (MSG,…), (DEBUG,…), (PRINT,…), (LOG,…) and their files.
//!
//! In DEBUG, PRINT and LOG `#5` and `#<name>` stand for the values at that moment, six decimals unless `%d`, `%f` (four)
//! or `%.2f` before them says otherwise for the rest of the comment; a name without a value is `######`.

use core::fmt;

use super::MachineParameters;
use super::expression::name;
use super::lexical::{is_blank, trimmed};

/// What a comment is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentKind {
    /// For the reader of the program.
    Plain,
    /// A message as it stands.
    Message,
    /// A message with values.
    Debug,
    /// Text with values, to the console.
    Print,
    /// Text with values, to the log file.
    Log,
    /// Opens a log file, emptied.
    LogOpen,
    /// Opens a log file at its end.
    LogAppend,
    /// Closes it.
    LogClose,
    /// Opens a file for the results of probing.
    ProbeOpen,
    /// Closes it.
    ProbeClose,
}

const KINDS: [(&[u8], CommentKind); 9] = [
    (b"MSG", CommentKind::Message),
    (b"DEBUG", CommentKind::Debug),
    (b"PRINT", CommentKind::Print),
    (b"LOG", CommentKind::Log),
    (b"LOGOPEN", CommentKind::LogOpen),
    (b"LOGAPPEND", CommentKind::LogAppend),
    (b"LOGCLOSE", CommentKind::LogClose),
    (b"PROBEOPEN", CommentKind::ProbeOpen),
    (b"PROBECLOSE", CommentKind::ProbeClose),
];

/// A comment, taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Comment<'t> {
    /// What it is for.
    pub kind: CommentKind,
    /// Its text, without the word that tells the kind.
    pub text: &'t [u8],
}

impl<'t> Comment<'t> {
    /// From what stands between the parentheses.
    pub fn of(body: &'t [u8]) -> Self {
        let comma = body.iter().position(|&b| b == b',');
        let (word, text) = match comma.and_then(|n| body.split_at_checked(n)) {
            Some((word, rest)) => (word, rest.get(1..).unwrap_or(&[])),
            None => split_word(body),
        };
        let kind = KINDS.iter().find(|(name, _)| trimmed(word).eq_ignore_ascii_case(name));
        match kind {
            Some(&(_, kind)) if kind.has_comma() == comma.is_some() => Self { kind, text },
            _ => Self { kind: CommentKind::Plain, text: body },
        }
    }

    /// Writes its text, with the values of its parameters where its kind has them.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write(&self, parameters: &dyn MachineParameters, out: &mut impl fmt::Write) -> fmt::Result {
        let mut rest = self.text;
        let speaks = matches!(self.kind, CommentKind::Debug | CommentKind::Print | CommentKind::Log);
        let mut decimals = 6usize;
        while let Some((&byte, behind)) = rest.split_first() {
            rest = behind;
            match byte {
                b'#' if speaks => {
                    if let Some((value, end)) = parameter(behind, parameters) {
                        rest = end;
                        match value {
                            Some(value) => write!(out, "{value:.decimals$}")?,
                            None => out.write_str("######")?,
                        }
                        continue;
                    }
                }
                b'%' if speaks => {
                    if let Some((given, end)) = format(behind) {
                        (decimals, rest) = (given, end);
                        continue;
                    }
                }
                _ => {}
            }
            out.write_char(char::from(byte))?;
        }
        Ok(())
    }
}

impl CommentKind {
    /// Whether a comma stands behind its word.
    const fn has_comma(self) -> bool {
        !matches!(self, Self::LogClose | Self::ProbeOpen | Self::ProbeClose)
    }
}

/// The first word and what follows it.
fn split_word(body: &[u8]) -> (&[u8], &[u8]) {
    let body = trimmed(body);
    let end = body.iter().position(|&b| is_blank(b)).unwrap_or(body.len());
    let (word, rest) = body.split_at_checked(end).unwrap_or((body, &[]));
    (word, trimmed(rest))
}

/// The value of the parameter whose number or name stands here; inside `None` when it has none.
fn parameter<'t>(text: &'t [u8], parameters: &dyn MachineParameters) -> Option<(Option<f64>, &'t [u8])> {
    if text.first() == Some(&b'<') {
        let (name, len) = name(text).ok()?;
        let value = parameters.named(&name).or_else(|| parameters.memory().named(&name));
        return Some((value, text.get(len..)?));
    }
    let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
    let (number, rest) = text.split_at_checked(digits)?;
    let number = core::str::from_utf8(number).ok()?.parse::<u16>().ok()?;
    let value = parameters.number(u32::from(number)).unwrap_or_else(|| parameters.memory().get(number));
    Some((Some(value), rest))
}

/// Decimals that `%d`, `%f`, `%.3f` ask for.
fn format(text: &[u8]) -> Option<(usize, &[u8])> {
    match text {
        [b'd', rest @ ..] => Some((0, rest)),
        [b'f', rest @ ..] => Some((4, rest)),
        [b'.', digit @ b'0'..=b'9', b'f', rest @ ..] => Some((usize::from(digit.saturating_sub(b'0')), rest)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::{HostMemory, Memory};
    use super::*;
    use std::boxed::Box;
    use std::string::String;

    struct Plain<'a>(Memory<'a>);

    impl MachineParameters for Plain<'_> {
        fn number(&self, number: u32) -> Option<f64> {
            (number == 5420).then_some(-1.25)
        }
        fn named(&self, _: &[u8]) -> Option<f64> {
            None
        }
        fn memory(&self) -> &Memory<'_> {
            &self.0
        }
    }

    fn written(body: &str) -> (CommentKind, String) {
        let mut buffers = Box::new(HostMemory::new());
        let mut memory = buffers.lend();
        memory.set(1, 2.6).unwrap();
        memory.set(2, 1.239).unwrap();
        memory.set_named(b"_a", 7.0).unwrap();
        let comment = Comment::of(body.as_bytes());
        let mut text = String::new();
        comment.write(&Plain(memory), &mut text).unwrap();
        (comment.kind, text)
    }

    /// The right column is what `rs274` of LinuxCNC 2.9 shows.
    #[test]
    fn values_are_written_as_the_reference_does() {
        for (body, text) in [
            ("debug,a=#1", "a=2.600000"),
            ("DEBUG,%d#1 %.2f#2 %f#2 #2", "3 1.24 1.2390 1.2390"),
            ("print,#1abc ## #[1+1] #<x> x#3y %x", "2.600000abc ## #[1+1] ###### x0.000000y %x"),
            ("LOG,%.3f#5420,#<_A>,%%", "-1.250,7.000,%%"),
            ("msg,#1 is", "#1 is"),
        ] {
            assert_eq!(written(body).1, text, "{body}");
        }
    }

    #[test]
    fn a_comment_is_known_by_its_first_word() {
        assert_eq!(Comment::of(b" probeopen a.txt"), Comment { kind: CommentKind::ProbeOpen, text: b"a.txt" });
        assert_eq!(Comment::of(b"logclose").kind, CommentKind::LogClose);
        assert_eq!(Comment::of(b"LOGOPEN,b.txt"), Comment { kind: CommentKind::LogOpen, text: b"b.txt" });
        assert_eq!(Comment::of(b"debug #1"), Comment { kind: CommentKind::Plain, text: b"debug #1" });
        assert_eq!(Comment::of(b"TRUEPATH BEGIN a, b").kind, CommentKind::Plain);
    }
}
