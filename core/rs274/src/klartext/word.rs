//! The words of a conversational block: a name with a number or a Q parameter, `X+10`, `IY-Q5`, `RL`, `FMAX`, `DR+`.

use super::super::lexical::{NumberError, is_blank, trimmed};
use super::super::{Decimal, GcodeError, GcodeErrorKind, KlartextError, Line, Span};
use super::kind::Statement;
use super::text::{behind, named, number, parameter};

/// Letters of words as [`Word`](crate::Word) keeps them. Axes have their own (`X` … `W`); what is counted from the present
/// place (`IX`) has the small one.
pub mod letter {
    /// `R0`, `RL`, `RR`: 0, 1, 2.
    pub const SIDE: u8 = b'o';
    /// `R`: radius.
    pub const RADIUS: u8 = b'R';
    /// `DR+`, `DR-`: 1, −1.
    pub const TURN: u8 = b'D';
    /// `PR`, `IPR`: distance from the pole.
    pub const POLAR_RADIUS: u8 = b'P';
    /// `IPR`.
    pub const POLAR_RADIUS_STEP: u8 = b'p';
    /// `PA`: angle at the pole.
    pub const POLAR_ANGLE: u8 = b'H';
    /// `IPA`.
    pub const POLAR_ANGLE_STEP: u8 = b'h';
    /// `F` with a number.
    pub const FEED: u8 = b'F';
    /// `FU`: feed per revolution.
    pub const FEED_PER_TURN: u8 = b'f';
    /// `FMAX`.
    pub const RAPID: u8 = b'm';
    /// `FAUTO`: the feed of TOOL CALL.
    pub const FEED_OF_TOOL: u8 = b't';
    /// `M`.
    pub const FUNCTION: u8 = b'M';
    /// `S`.
    pub const SPEED: u8 = b'S';
    /// Number of the tool of TOOL CALL.
    pub const TOOL: u8 = b'T';
    /// Name of the tool of TOOL CALL.
    pub const TOOL_NAME: u8 = b'n';
    /// Its axis: X 0, Y 1, Z 2.
    pub const TOOL_AXIS: u8 = b'j';
    /// `DL`: how much longer it is.
    pub const LONGER: u8 = b'l';
    /// `DR`: how much larger its radius is.
    pub const LARGER: u8 = b'E';
    /// `DR2`: how much larger the radius of its edge is.
    pub const LARGER_EDGE: u8 = b'e';
    /// `LEN`: length of a lead.
    pub const LENGTH: u8 = b'L';
    /// `CCA`: angle of a lead.
    pub const ANGLE: u8 = b'G';
    /// `MB`: how far M140 lifts; without a value to the end of the axis.
    pub const LIFT: u8 = b'k';
    /// RND of the block behind a line.
    pub const ROUNDING: u8 = b'r';
    /// CHF of the block behind a line.
    pub const CHAMFER: u8 = b'd';
    /// What belongs to an M function that changes no path, as `LA` of M120.
    pub const OTHER: u8 = b'q';
}

/// The value of a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KlartextValue {
    /// None is written: `FMAX`, a bare `F`.
    None,
    /// As written.
    Number(Decimal),
    /// A Q parameter, with its sign.
    Parameter {
        /// `-Q1`.
        negative: bool,
        /// Its place in the memory.
        number: u16,
    },
}

/// A word of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KlartextWord {
    /// One of [`letter`].
    pub letter: u8,
    /// Its value.
    pub value: KlartextValue,
    /// All of it.
    pub span: Span,
    /// Its value with the sign; empty where there is none.
    pub value_span: Span,
}

/// How a word gets its value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Takes {
    /// It is one already.
    Nothing(i8),
    /// A number must follow.
    Number,
    /// A number may follow.
    Perhaps,
}

/// Names of words, longer ones before those they begin with.
const NAMES: [(&[u8], u8, Takes); 32] = [
    (b"CCA", letter::ANGLE, Takes::Number),
    (b"LEN", letter::LENGTH, Takes::Number),
    (b"LIN_", 0, Takes::Number),
    (b"LA", letter::OTHER, Takes::Number),
    (b"IPR", letter::POLAR_RADIUS_STEP, Takes::Number),
    (b"IPA", letter::POLAR_ANGLE_STEP, Takes::Number),
    (b"PR", letter::POLAR_RADIUS, Takes::Number),
    (b"PA", letter::POLAR_ANGLE, Takes::Number),
    (b"IX", b'x', Takes::Number),
    (b"IY", b'y', Takes::Number),
    (b"IZ", b'z', Takes::Number),
    (b"IA", b'a', Takes::Number),
    (b"IB", b'b', Takes::Number),
    (b"IC", b'c', Takes::Number),
    (b"IU", b'u', Takes::Number),
    (b"IV", b'v', Takes::Number),
    (b"IW", b'w', Takes::Number),
    (b"RL", letter::SIDE, Takes::Nothing(1)),
    (b"RR", letter::SIDE, Takes::Nothing(2)),
    (b"FU", letter::FEED_PER_TURN, Takes::Number),
    (b"MB", letter::LIFT, Takes::Perhaps),
    (b"M", letter::FUNCTION, Takes::Perhaps),
    (b"S", letter::SPEED, Takes::Number),
    (b"X", b'X', Takes::Number),
    (b"Y", b'Y', Takes::Number),
    (b"Z", b'Z', Takes::Number),
    (b"A", b'A', Takes::Number),
    (b"B", b'B', Takes::Number),
    (b"C", b'C', Takes::Number),
    (b"U", b'U', Takes::Number),
    (b"V", b'V', Takes::Number),
    (b"W", b'W', Takes::Number),
];

/// The words of a block, from behind its statement to its comment.
#[derive(Clone, Debug)]
pub struct KlartextWords<'a> {
    line: Line<'a>,
    statement: Statement,
    rest: &'a [u8],
    /// Where that ends in the file.
    end: usize,
    begun: bool,
    failed: bool,
}

impl<'a> KlartextWords<'a> {
    pub(super) const fn new(line: Line<'a>, statement: Statement, rest: &'a [u8], end: usize) -> Self {
        Self { line, statement, rest, end, begun: false, failed: false }
    }

    fn at(&self, rest: &[u8]) -> usize {
        self.end.saturating_sub(rest.len())
    }

    fn span(&self, from: &[u8], to: &[u8]) -> Span {
        Span { start: self.at(from), len: from.len().saturating_sub(to.len()) }
    }

    fn error(&self, kind: impl Into<GcodeErrorKind>, from: &[u8]) -> GcodeError {
        let len = from.iter().take_while(|b| !is_blank(**b)).count().max(1);
        GcodeError::new(kind.into(), &self.line, Span { start: self.at(from), len })
    }

    /// A word of a name whose value follows at `rest`.
    fn valued(&mut self, from: &'a [u8], letter: u8, takes: Takes, rest: &'a [u8]) -> Result<KlartextWord, GcodeError> {
        if let Takes::Nothing(value) = takes {
            self.rest = rest;
            let value = Decimal::new(i64::from(value), 0).map_or(KlartextValue::None, KlartextValue::Number);
            let span = self.span(from, rest);
            return Ok(KlartextWord { letter, value, span, value_span: Span { len: 0, ..span } });
        }
        let start = trimmed(rest);
        match value(start) {
            Ok(Some((value, end))) => {
                self.rest = end;
                let (span, value_span) = (self.span(from, end), self.span(start, end));
                Ok(KlartextWord { letter, value, span, value_span })
            }
            Ok(None) if takes == Takes::Perhaps => {
                self.rest = rest;
                let span = self.span(from, rest);
                Ok(KlartextWord { letter, value: KlartextValue::None, span, value_span: Span { len: 0, ..span } })
            }
            Ok(None) => Err(self.error(KlartextError::NumberMissing, from)),
            Err(()) => Err(self.error(KlartextError::NumberTooLarge, from)),
        }
    }

    fn word(&mut self) -> Result<KlartextWord, GcodeError> {
        let from = self.rest;
        let first = !core::mem::replace(&mut self.begun, true);
        if self.statement == Statement::ToolCall {
            if let Some(word) = self.of_tool(from, first)? {
                return Ok(word);
            }
        } else if first && matches!(self.statement, Statement::Chamfer) {
            return self.valued(from, letter::RADIUS, Takes::Number, from);
        }
        if let Some(rest) = named(from, b"DR") {
            return match rest.first() {
                Some(b'+') => self.valued(from, letter::TURN, Takes::Nothing(1), behind(rest)),
                Some(b'-') => self.valued(from, letter::TURN, Takes::Nothing(-1), behind(rest)),
                _ => Err(self.error(KlartextError::Rotation, from)),
            };
        }
        // `R0` is a radius of nothing; `R0.5` is one.
        if let Some(rest) = named(from, b"R0").filter(|r| !matches!(r.first(), Some(b'0'..=b'9' | b'.' | b','))) {
            return self.valued(from, letter::SIDE, Takes::Nothing(0), rest);
        }
        if let Some(rest) = named(from, b"F") {
            for (word, letter) in [(&b"MAX"[..], letter::RAPID), (b"AUTO", letter::FEED_OF_TOOL)] {
                if let Some(rest) = named(trimmed(rest), word) {
                    return self.valued(from, letter, Takes::Nothing(0), rest);
                }
            }
            if named(rest, b"Z").is_some() || named(rest, b"T").is_some() {
                return Err(self.error(KlartextError::OtherFeed, from));
            }
            if named(rest, b"U").is_none() {
                return self.valued(from, letter::FEED, Takes::Perhaps, rest);
            }
        }
        for (name, letter, takes) in NAMES {
            let Some(rest) = named(from, name) else { continue };
            // `LIN_Z-5`: the line to which an arc rises.
            if letter == 0 {
                self.rest = rest;
                return self.word();
            }
            // `RL`, `RR`: not the beginning of something else.
            if matches!(takes, Takes::Nothing(_)) && rest.first().is_some_and(u8::is_ascii_alphanumeric) {
                continue;
            }
            if let (letter::LIFT, Some(rest)) = (letter, named(trimmed(rest), b"MAX")) {
                return self.valued(from, letter, Takes::Perhaps, rest);
            }
            return self.valued(from, letter, takes, rest);
        }
        // Old controls write R without anything where nothing changes.
        if let Some(rest) = named(from, b"R") {
            return self.valued(from, letter::RADIUS, Takes::Perhaps, rest);
        }
        Err(self.error(KlartextError::Word, from))
    }

    /// What only TOOL CALL has.
    fn of_tool(&mut self, from: &'a [u8], first: bool) -> Result<Option<KlartextWord>, GcodeError> {
        if first && from.first() == Some(&b'"') {
            let name = behind(from);
            let Some(end) = name.iter().position(|b| *b == b'"') else {
                return Err(self.error(KlartextError::QuoteOpen, from));
            };
            let rest = behind(name.get(end..).unwrap_or(&[]));
            return self.valued(from, letter::TOOL_NAME, Takes::Nothing(0), rest).map(Some);
        }
        if first && named(from, b"QS").is_some() {
            let end = from.iter().position(|b| is_blank(*b)).unwrap_or(from.len());
            let rest = from.get(end..).unwrap_or(&[]);
            return self.valued(from, letter::TOOL_NAME, Takes::Nothing(0), rest).map(Some);
        }
        if first && matches!(from.first(), Some(b'0'..=b'9' | b'Q' | b'q')) {
            return self.valued(from, letter::TOOL, Takes::Number, from).map(Some);
        }
        for (name, letter) in [(&b"DR2"[..], letter::LARGER_EDGE), (b"DR", letter::LARGER), (b"DL", letter::LONGER)] {
            if let Some(rest) = named(from, name) {
                return self.valued(from, letter, Takes::Number, rest).map(Some);
            }
        }
        for (name, axis) in [(&b"X"[..], 0), (b"Y", 1), (b"Z", 2), (b"U", 3), (b"V", 3), (b"W", 3)] {
            if let Some(rest) = named(from, name) {
                return self.valued(from, letter::TOOL_AXIS, Takes::Nothing(axis), rest).map(Some);
            }
        }
        Ok(None)
    }
}

impl Iterator for KlartextWords<'_> {
    type Item = Result<KlartextWord, GcodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        self.rest = trimmed(self.rest);
        self.rest.first()?;
        let word = self.word();
        self.failed = word.is_err();
        Some(word)
    }
}

/// A number or a Q parameter at the start of a text, and what follows it; `None` where neither stands.
fn value(text: &[u8]) -> Result<Option<(KlartextValue, &[u8])>, ()> {
    let negative = text.first() == Some(&b'-');
    let unsigned = if matches!(text.first(), Some(b'+' | b'-')) { trimmed(behind(text)) } else { text };
    if let Some((number, rest)) = parameter(unsigned) {
        return Ok(Some((KlartextValue::Parameter { negative, number }, rest)));
    }
    if !matches!(unsigned.first(), Some(b'0'..=b'9' | b'.' | b',')) {
        return Ok(None);
    }
    match number(unsigned) {
        (rest, Ok(number)) => {
            let number = if negative { number.negated() } else { number };
            Ok(Some((KlartextValue::Number(number), rest)))
        }
        (_, Err(NumberError::Missing)) => Ok(None),
        (_, Err(NumberError::TooLarge)) => Err(()),
    }
}
