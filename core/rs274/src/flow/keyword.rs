//! The O words of LinuxCNC: their labels and keywords.

use super::super::expression::name;
use super::super::lexical::{behind_comments, is_blank, number, spelled, trimmed};
use super::super::{FlowError, Line};
use super::place::statement;

/// What an O word does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Sub,
    EndSub,
    Call,
    Return,
    If,
    ElseIf,
    Else,
    EndIf,
    While,
    EndWhile,
    Do,
    Repeat,
    EndRepeat,
    Break,
    Continue,
}

const WORDS: [(&[u8], Keyword); 15] = [
    (b"SUB", Keyword::Sub),
    (b"ENDSUB", Keyword::EndSub),
    (b"CALL", Keyword::Call),
    (b"RETURN", Keyword::Return),
    (b"IF", Keyword::If),
    (b"ELSEIF", Keyword::ElseIf),
    (b"ELSE", Keyword::Else),
    (b"ENDIF", Keyword::EndIf),
    (b"WHILE", Keyword::While),
    (b"ENDWHILE", Keyword::EndWhile),
    (b"DO", Keyword::Do),
    (b"REPEAT", Keyword::Repeat),
    (b"ENDREPEAT", Keyword::EndRepeat),
    (b"BREAK", Keyword::Break),
    (b"CONTINUE", Keyword::Continue),
];

impl Keyword {
    /// The keyword at the start of a text, blanks inside it allowed, and what follows it. The longest one wins.
    fn at(text: &[u8]) -> Option<(Self, &[u8])> {
        let text = trimmed(text);
        let word = |(word, keyword): &(&[u8], Self)| Some((*keyword, text.get(spelled(text, word)?..)?));
        WORDS.iter().filter_map(word).min_by_key(|(_, rest)| rest.len())
    }
}

/// The name of a label: its letters or digits, mixed to 64 bits (FNV-1a).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Label(u64);

impl Label {
    /// From a name in lower case without blanks.
    pub(in super::super) fn new(name: &[u8]) -> Self {
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3);
        Self(name.iter().fold(0xCBF2_9CE4_8422_2325, step))
    }

    /// From a number.
    pub(in super::super) fn numbered(number: u32) -> Self {
        Self::new(&digits(number))
    }
}

/// A number as digits.
pub(super) fn digits(number: u32) -> heapless::Vec<u8, 10> {
    let mut digits = heapless::Vec::new();
    let mut power = 1_000_000_000u32;
    while power > 0 {
        let digit = (number.checked_div(power).unwrap_or(0) % 10) as u8;
        if digit > 0 || !digits.is_empty() || power == 1 {
            // Ten places for ten powers.
            let _ = digits.push(digit.saturating_add(b'0'));
        }
        power /= 10;
    }
    digits
}

/// A line that begins with an O word whose label is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct OLine<'t> {
    pub(super) label: Label,
    pub(super) keyword: Keyword,
    /// What follows the keyword, comments included.
    pub(super) rest: &'t [u8],
}

impl<'t> OLine<'t> {
    /// Of a line; `None` when it is no such line.
    pub(super) fn of(line: &Line<'t>) -> Option<Self> {
        Self::checked(line).ok().flatten()
    }

    /// Of a line that is passed over.
    ///
    /// # Errors
    /// It begins with an O word that is neither such a line nor the number of a program.
    pub(super) fn checked(line: &Line<'t>) -> Result<Option<Self>, FlowError> {
        let first = line.text.iter().find(|b| !is_blank(**b));
        if !matches!(first, Some(b'o' | b'O' | b'n' | b'N' | b'/')) {
            return Ok(None);
        }
        let Some((b'o' | b'O', behind)) = statement(line).split_first() else { return Ok(None) };
        let behind = trimmed(behind);
        match (label(behind), behind.first()) {
            (Some((label, rest)), _) => match Keyword::at(rest) {
                Some((keyword, rest)) => Ok(Some(Self { label, keyword, rest })),
                None if behind_comments(rest).is_empty() => Ok(None),
                None => Err(FlowError::Keyword),
            },
            // Its label is computed when it is executed.
            (None, Some(b'[' | b'#')) => Ok(None),
            (None, _) => Err(FlowError::Label),
        }
    }
}

/// A written label, and what follows it.
pub(super) fn label(text: &[u8]) -> Option<(Label, &[u8])> {
    if text.first() == Some(&b'<') {
        let (name, len) = name(text).ok()?;
        return Some((Label::new(&name), text.get(len..)?));
    }
    let (rest, value) = number(text);
    let number = u32::try_from(value.ok()?.exactly_times(1)?).ok()?;
    Some((Label::numbered(number), rest))
}

/// The keyword at the start of a text, and what follows it.
pub(super) fn keyword(text: &[u8]) -> Option<(Keyword, &[u8])> {
    Keyword::at(text)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn read(text: &str) -> Option<(Label, Keyword, &[u8])> {
        let line = Line { number: 1, start: 0, text: text.as_bytes() };
        OLine::of(&line).map(|l| (l.label, l.keyword, l.rest))
    }

    #[test]
    fn a_label_may_be_a_name_or_a_number_in_any_spelling() {
        let hundred = Label::numbered(100);
        assert_eq!(read("N5 o 1 00 else if [1]"), Some((hundred, Keyword::ElseIf, &b" [1]"[..])));
        assert_eq!(read("O<100>sub"), Some((hundred, Keyword::Sub, &b""[..])));
        assert_eq!(read("/ o<A b> ENDSUB").unwrap().0, read("o<ab> sub").unwrap().0);
        assert_eq!(read("(o100 sub)").is_none(), read("G0 X1").is_none());
    }

    #[test]
    fn numbers_are_written_without_zeros_in_front() {
        assert_eq!((&digits(0)[..], &digits(4_294_967_295)[..]), (&b"0"[..], &b"4294967295"[..]));
    }
}
