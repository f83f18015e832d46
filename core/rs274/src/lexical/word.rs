//! Bytes → words: the lexical layer, one line at a time.
//!
//! A line is an optional `/`, words of one letter and one number in any case and with blanks anywhere, assignments of
//! parameters, comments in `( )` (one inside another belongs to it) and a comment after `;`; or a statement that steers the program.
//! `:1234` is the program name `O1234`. Sources: RS274/NGC interpreter version 3 (Kramer, Proctor, Messina, NIST 6556)
//! §3.3, and the Fanuc and Haas spellings of the same. Nothing is skipped: a byte that belongs to none of these is an
//! error with its place. Expressions are measured here, not computed.

use super::super::{CornerError, Foreign, GcodeError, GcodeErrorKind, Line, Span};
use super::decimal::{Decimal, NumberError, is_blank, number, trimmed};
use super::extent;
use super::symbol::spelled;
use super::{Token, WrittenWord};

/// The tokens of one line in the order of the text.
///
/// After an error there is nothing more: what follows an unreadable byte means nothing.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    line: Line<'a>,
    rest: &'a [u8],
    first: bool,
    percent: bool,
    /// Whether a word or an assignment has been read: statements stand before all others.
    begun: bool,
    failed: bool,
}

impl<'a> Words<'a> {
    /// Of this line.
    pub const fn new(line: Line<'a>) -> Self {
        Self { line, rest: line.text, first: true, percent: false, begun: false, failed: false }
    }

    fn offset(&self, rest: &[u8]) -> usize {
        self.line.start.saturating_add(self.line.text.len().saturating_sub(rest.len()))
    }

    /// From `from` (a rest of the line) to the rest now held.
    fn span_from(&self, from: &[u8]) -> Span {
        Span { start: self.offset(from), len: from.len().saturating_sub(self.rest.len()) }
    }

    fn advance(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or(&[]);
    }

    fn error(&self, from: &[u8], kind: GcodeErrorKind) -> GcodeError {
        let len = from.len().saturating_sub(self.rest.len()).max(1);
        GcodeError::new(kind, &self.line, Span { start: self.offset(from), len })
    }

    fn token(&mut self, byte: u8) -> Result<Token, GcodeError> {
        let from = self.rest;
        let first = core::mem::replace(&mut self.first, false);
        if first && is_heidenhain(from) {
            self.rest = &[];
            return Err(self.error(from, GcodeErrorKind::ForeignDialect(Foreign::Heidenhain)));
        }
        self.advance(1);
        if self.percent && matches!(byte, b'O' | b'o' | b':') {
            self.percent = false;
        }
        if self.percent && !matches!(byte, b'(' | b';') {
            self.rest = &[];
            return Err(self.error(from, GcodeErrorKind::TextAfterPercent));
        }
        match byte {
            b'(' => self.comment(from),
            b';' => {
                self.rest = &[];
                let span = self.span_from(from);
                let body = Span { start: span.start.saturating_add(1), len: span.len.saturating_sub(1) };
                Ok(Token::Comment { span, body })
            }
            b'/' => Ok(self.block_delete(from)),
            b'%' | b'$' if first && is_header(from) => {
                self.rest = &[];
                Ok(Token::Percent(self.span_from(from)))
            }
            b'%' if first => {
                self.percent = true;
                Ok(Token::Percent(self.span_from(from)))
            }
            b':' => self.word(from, b'O'),
            b'A'..=b'Z' | b'a'..=b'z' => {
                let letter = byte.to_ascii_uppercase();
                if let Some(token) = self.siemens(from) {
                    return token;
                }
                if !self.begun {
                    let next_is_letter = self.rest.first().is_some_and(u8::is_ascii_alphabetic);
                    if (next_is_letter && extent::is_statement(from)) || (letter == b'O' && is_control(self.rest)) {
                        self.rest = from.get(extent::statement(from)..).unwrap_or(&[]);
                        return Ok(Token::Control(self.span_from(from)));
                    }
                    self.begun = letter != b'N';
                }
                self.word(from, letter)
            }
            // LinuxCNC's polar words.
            b'@' | b'^' => {
                self.begun = true;
                self.word(from, byte)
            }
            b'#' => {
                let Some(len) = extent::assignment(from) else {
                    return Err(self.error(from, GcodeErrorKind::Stray(byte)));
                };
                self.begun = true;
                self.rest = from.get(len..).unwrap_or(&[]);
                Ok(Token::Assignment(self.span_from(from)))
            }
            b')' => Err(self.error(from, GcodeErrorKind::StrayParenthesis)),
            b',' => self.corner(from),
            b'[' | b']' | b'=' | b'*' => Err(self.error(from, GcodeErrorKind::Stray(byte))),
            _ => Err(self.error(from, GcodeErrorKind::UnexpectedByte(byte))),
        }
    }

    /// A word of Siemens' own language that has a meaning here: `CR=5` is R, `SUPA` is G53, `TRANS` and `ATRANS` are G52,
    /// `T="MILL"` is `t`, a tool without a number, `RND=` and `CHR=` are `,R` and `,C`. What `MSG("…")` shows, how `CYCLE832(…)` smooths, the blank that
    /// `WORKPIECE(…)` draws and how the drives follow (`FFWON`, `SOFT` …) are comments. Its first letter tells it from the
    /// word that it stands for, so that a reader of another dialect can refuse it.
    fn siemens(&mut self, from: &'a [u8]) -> Option<Result<Token, GcodeError>> {
        if !trimmed(self.rest).first().is_some_and(|&byte| byte.is_ascii_alphabetic() || byte == b'=') {
            return None;
        }
        let behind = |word: &[u8]| spelled(from, word).and_then(|len| from.get(len..)).map(trimmed);
        if let Some(value) = behind(b"CR").and_then(|rest| rest.strip_prefix(b"=")) {
            self.rest = value;
            self.begun = true;
            return Some(self.word(from, b'R'));
        }
        for (word, letter) in [(&b"RND"[..], b'R'), (b"CHR", b'C')] {
            if let Some(value) = behind(word).and_then(|rest| rest.strip_prefix(b"=")).filter(|v| number(v).1.is_ok()) {
                self.rest = value;
                self.begun = true;
                return Some(self.value(from, letter).map(Token::Corner));
            }
        }
        let codes: [(&[u8], i64); 3] = [(b"SUPA", 53), (b"TRANS", 52), (b"ATRANS", 52)];
        if let Some((rest, code)) = codes.iter().find_map(|(word, code)| behind(word).map(|rest| (rest, *code))) {
            return Some(Ok(self.stands_for(from, rest, b'G', code)));
        }
        if let Some(name) = behind(b"T").and_then(|rest| rest.strip_prefix(b"=")).map(trimmed)
            && let Some(open) = name.strip_prefix(b"\"")
            && let Some(close) = open.iter().position(|&b| b == b'"')
        {
            let rest = open.get(close.saturating_add(1)..).unwrap_or(&[]);
            return Some(Ok(self.stands_for(from, rest, b't', 0)));
        }
        if let Some(rest) = DYNAMICS.iter().find_map(|word| behind(word))
            && !rest.first().is_some_and(|&b| b.is_ascii_alphanumeric() || matches!(b, b'=' | b'(' | b'['))
        {
            self.rest = rest;
            let span = self.span_from(from);
            return Some(Ok(Token::Comment { span, body: Span { len: 0, ..span } }));
        }
        let called = |word: &[u8]| behind(word).filter(|rest| rest.first() == Some(&b'('));
        // A swivel that is taken back.
        let rest = [&b"MSG"[..], b"CYCLE832", b"WORKPIECE"].into_iter().find_map(called);
        let rest = rest.or_else(|| called(b"CYCLE800").filter(|rest| rest.starts_with(b"()")))?;
        let len = extent::comment(rest)?;
        let body = Span { start: self.offset(rest).saturating_add(1), len: len.saturating_sub(2) };
        self.rest = rest.get(len..).unwrap_or(&[]);
        Some(Ok(Token::Comment { span: self.span_from(from), body }))
    }

    /// A word that is written otherwise: from `from` to before `rest`.
    fn stands_for(&mut self, from: &'a [u8], rest: &'a [u8], letter: u8, value: i64) -> Token {
        self.rest = rest;
        self.begun = true;
        let end = from.len().saturating_sub(rest.len());
        let len = from.get(..end).unwrap_or(from).trim_ascii_end().len();
        Token::Word(WrittenWord { letter, value: Decimal::new(value, 0), span: Span { start: self.offset(from), len } })
    }

    fn comment(&mut self, from: &'a [u8]) -> Result<Token, GcodeError> {
        let Some(len) = extent::comment(from) else {
            self.rest = &[];
            return Err(self.error(from, GcodeErrorKind::UnclosedComment));
        };
        let body = Span { start: self.offset(self.rest), len: len.saturating_sub(2) };
        self.rest = from.get(len..).unwrap_or(&[]);
        Ok(Token::Comment { span: self.span_from(from), body })
    }

    fn block_delete(&mut self, from: &'a [u8]) -> Token {
        let mut switch = 1;
        if let Some(&digit @ b'1'..=b'9') = self.rest.first() {
            switch = digit.saturating_sub(b'0');
            self.advance(1);
        }
        Token::BlockDelete { span: self.span_from(from), switch }
    }

    fn word(&mut self, from: &'a [u8], letter: u8) -> Result<Token, GcodeError> {
        self.value(from, letter).map(Token::Word)
    }

    /// `,R` or `,C` behind its comma; `,A` is refused by name.
    fn corner(&mut self, from: &'a [u8]) -> Result<Token, GcodeError> {
        let rest = trimmed(self.rest);
        match rest.first().map(u8::to_ascii_uppercase) {
            Some(letter @ (b'R' | b'C')) => {
                self.rest = rest.get(1..).unwrap_or(&[]);
                self.value(from, letter).map(Token::Corner)
            }
            Some(b'A') => Err(self.error(from, CornerError::Angle.into())),
            _ => Err(self.error(from, GcodeErrorKind::UnexpectedByte(b','))),
        }
    }

    /// The number or expression of a letter that has just been read.
    fn value(&mut self, from: &'a [u8], letter: u8) -> Result<WrittenWord, GcodeError> {
        // Siemens may write `X=10`.
        let assigned = trimmed(self.rest).strip_prefix(b"=").filter(|rest| number(rest).1.is_ok());
        let (rest, value) = number(assigned.unwrap_or(self.rest));
        match value {
            Ok(value) => {
                self.rest = rest;
                Ok(WrittenWord { letter, value: Some(value), span: self.span_from(from) })
            }
            Err(NumberError::TooLarge) => {
                self.rest = rest;
                Err(self.error(from, GcodeErrorKind::NumberTooLarge { letter }))
            }
            Err(NumberError::Missing) => match extent::value(self.rest).filter(|_| letter != b'N') {
                Some(len) if !is_signs_only(self.rest) => {
                    self.advance(len);
                    Ok(WrittenWord { letter, value: None, span: self.span_from(from) })
                }
                _ => Err(self.missing(from, letter)),
            },
        }
    }

    /// Tells what stands where a number should.
    fn missing(&mut self, from: &'a [u8], letter: u8) -> GcodeError {
        let next = trimmed(self.rest).first().copied();
        let run = letters(from);
        let kind = match next {
            Some(b'=') if letter == b'T' || is_call(trimmed(self.rest)) => {
                GcodeErrorKind::ForeignDialect(Foreign::Siemens)
            }
            _ if SIEMENS.iter().any(|word| spelled(from, word).is_some()) => {
                self.advance(run.saturating_sub(1));
                GcodeErrorKind::ForeignDialect(Foreign::Siemens)
            }
            Some(byte @ (b'[' | b'#' | b'=')) => GcodeErrorKind::Stray(byte),
            // Three letters in a row are a word of a language; two are more likely a forgotten number.
            _ if run > 2 => {
                self.advance(run.saturating_sub(1));
                GcodeErrorKind::Text
            }
            _ => GcodeErrorKind::NumberMissing { letter },
        };
        self.error(from, kind)
    }
}

impl Iterator for Words<'_> {
    type Item = Result<Token, GcodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        self.rest = trimmed(self.rest);
        let byte = *self.rest.first()?;
        let token = self.token(byte);
        self.failed = token.is_err();
        Some(token)
    }
}

/// Whether the first line of a program names its file: `%_N_PART_MPF` (Siemens), `$PART.MIN%` (Okuma).
fn is_header(line: &[u8]) -> bool {
    let text = line.trim_ascii_end();
    let is_name = |name: &[u8]| name.iter().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.'));
    match (text.strip_prefix(b"%_N_"), text.strip_prefix(b"$").and_then(|name| name.strip_suffix(b"%"))) {
        (Some(name), _) | (None, Some(name)) => is_name(name),
        _ => false,
    }
}

/// Words of Siemens' own language that change where the cutter goes, or the order of the blocks.
const SIEMENS: [&[u8]; 11] =
    [b"ROT", b"AROT", b"MIRROR", b"AMIRROR", b"SCALE", b"ASCALE", b"CYCLE", b"POCKET", b"TURN=", b"REPEAT", b"MCALL"];

/// Words of Siemens' own language that say how axes follow the path, and change nothing of it.
const DYNAMICS: [&[u8]; 10] =
    [b"FFWON", b"FFWOF", b"SOFT", b"BRISK", b"COMPOF", b"COMPON", b"COMPCAD", b"STOPRE", b"CFTCP", b"TRAFOOF"];

/// Whether an assigned value is a function: `=IC(5)`.
fn is_call(text: &[u8]) -> bool {
    text.strip_prefix(b"=").map(trimmed).and_then(|rest| rest.first()).is_some_and(u8::is_ascii_alphabetic)
}

/// How many letters stand here without a blank between them.
fn letters(text: &[u8]) -> usize {
    text.iter().take_while(|b| b.is_ascii_alphabetic()).count()
}

/// Whether two letters in a row stand here, blanks between them not counted: a word of a language.
pub(in super::super) fn is_word(text: &[u8]) -> bool {
    let mut letters = text.iter().filter(|b| !is_blank(**b));
    letters.next().is_some_and(u8::is_ascii_alphabetic) && letters.next().is_some_and(u8::is_ascii_alphabetic)
}

/// Whether what stands behind an O steers the program: a name, an expression, or a number with a word of letters.
fn is_control(text: &[u8]) -> bool {
    match trimmed(text).first() {
        Some(b'<' | b'[' | b'#') => true,
        Some(b'0'..=b'9') => is_word(trimmed(number(text).0)),
        _ => false,
    }
}

/// Whether two signs stand here, which no number has.
fn is_signs_only(text: &[u8]) -> bool {
    let sign = |t: &[u8]| matches!(t.first(), Some(b'+' | b'-'));
    sign(trimmed(text)) && trimmed(text).get(1..).map(trimmed).is_some_and(sign)
}

/// `BEGIN PGM`, with or without Heidenhain's line number before it.
fn is_heidenhain(text: &[u8]) -> bool {
    if !matches!(text.first(), Some(b'0'..=b'9' | b'B' | b'b')) {
        return false;
    }
    let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
    let word = |text: &[u8], word: &[u8]| text.get(..word.len()).is_some_and(|t| t.eq_ignore_ascii_case(word));
    let begin = trimmed(text.get(digits..).unwrap_or(&[]));
    word(begin, b"BEGIN") && word(trimmed(begin.get(5..).unwrap_or(&[])), b"PGM")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::arithmetic_side_effects)]
    use super::super::super::Lines;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn tokens(text: &[u8]) -> Vec<Result<Token, GcodeError>> {
        Lines::new(text).flat_map(Words::new).collect()
    }

    #[test]
    fn blanks_case_and_comments_do_not_change_the_words() {
        let plain: Vec<_> = words(b"G1X12.5F100");
        assert_eq!(words(b" g 0 1 (r\xE9sum\xE9) x + 1 2 . 5 F1 0 0 ; rest (of line"), plain);
    }

    fn words(text: &[u8]) -> Vec<(u8, i128)> {
        let word = |t: Result<Token, GcodeError>| match t.unwrap() {
            Token::Word(w) => Some((w.letter, w.value.unwrap().times(1_000_000))),
            _ => None,
        };
        tokens(text).into_iter().filter_map(word).collect()
    }

    #[test]
    fn spans_point_at_the_bytes_of_the_word() {
        let program = b"%\r\n/2 N10.5 X -1 . 5  Y2 (a)";
        let spans: Vec<_> = tokens(program).into_iter().map(|t| t.unwrap().span().of(program)).collect();
        assert_eq!(spans, [&b"%"[..], b"/2", b"N10.5", b"X -1 . 5", b"Y2", b"(a)"]);
    }

    #[test]
    fn a_colon_names_the_program_as_o_does() {
        assert_eq!(words(b":1234"), words(b"O1234"));
    }

    #[test]
    fn nothing_follows_an_unreadable_byte() {
        let read = tokens(b"G1 X1 ? Y2");
        assert_eq!(read.len(), 3);
        let error = read[2].unwrap_err();
        assert_eq!((error.kind, error.line, error.column), (GcodeErrorKind::UnexpectedByte(b'?'), 1, 7));
    }

    proptest! {
        #[test]
        fn every_byte_of_a_readable_line_is_a_blank_or_in_one_token(text in "[GXYZ0-9. ()/;%-]{0,24}") {
            let bytes = text.as_bytes();
            let mut owner = std::vec![0u8; bytes.len()];
            for token in tokens(bytes) {
                let Ok(token) = token else { return Ok(()) };
                let span = token.span();
                for o in &mut owner[span.start..span.end()] {
                    *o += 1;
                }
            }
            for (byte, owner) in bytes.iter().zip(owner) {
                prop_assert!(owner == 1 || (owner == 0 && *byte == b' '));
            }
        }
    }
}
