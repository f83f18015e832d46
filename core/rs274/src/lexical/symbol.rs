//! The names of functions and operators in expressions.

use super::decimal::{is_blank, trimmed};

/// The length of a word of letters or signs at the start of a text, in any case and with blanks inside it, as LinuxCNC
/// reads it.
#[inline(never)]
pub(in super::super) fn spelled(text: &[u8], word: &[u8]) -> Option<usize> {
    let mut left = word.iter();
    let mut expected = left.next()?;
    for (index, byte) in text.iter().enumerate() {
        if index > 0 && is_blank(*byte) {
            continue;
        }
        if byte.to_ascii_uppercase() != *expected {
            return None;
        }
        match left.next() {
            Some(next) => expected = next,
            None => return Some(index.saturating_add(1)),
        }
    }
    None
}

/// A function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Function {
    Abs,
    Acos,
    Asin,
    Atan,
    Cos,
    Exists,
    Exp,
    Fix,
    Fup,
    Ln,
    Round,
    Sin,
    Sqrt,
    Tan,
}

const NAMES: [(&[u8], Function); 14] = [
    (b"ABS", Function::Abs),
    (b"ACOS", Function::Acos),
    (b"ASIN", Function::Asin),
    (b"ATAN", Function::Atan),
    (b"COS", Function::Cos),
    (b"EXISTS", Function::Exists),
    (b"EXP", Function::Exp),
    (b"FIX", Function::Fix),
    (b"FUP", Function::Fup),
    (b"LN", Function::Ln),
    (b"ROUND", Function::Round),
    (b"SIN", Function::Sin),
    (b"SQRT", Function::Sqrt),
    (b"TAN", Function::Tan),
];

impl Function {
    /// The function at the start of a text, and the length of its name. A bracket must follow.
    pub(in super::super) fn at(text: &[u8]) -> Option<(Self, usize)> {
        let before_bracket = |len: &usize| text.get(*len..).map(trimmed).and_then(|r| r.first()) == Some(&b'[');
        NAMES.iter().find_map(|(name, function)| Some((*function, spelled(text, name).filter(before_bracket)?)))
    }
}

/// An operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterEqual,
    Less,
    LessEqual,
    And,
    Or,
    Xor,
}

/// The operators that are words.
const WORDS: [(&[u8], Operator); 10] = [
    (b"MOD", Operator::Modulo),
    (b"EQ", Operator::Equal),
    (b"NE", Operator::NotEqual),
    (b"GT", Operator::Greater),
    (b"GE", Operator::GreaterEqual),
    (b"LT", Operator::Less),
    (b"LE", Operator::LessEqual),
    (b"AND", Operator::And),
    (b"OR", Operator::Or),
    (b"XOR", Operator::Xor),
];

impl Operator {
    /// The operator at the start of a text, and its length.
    pub(in super::super) fn at(text: &[u8]) -> Option<(Self, usize)> {
        match text {
            [b'*', ..] => Some(spelled(text, b"**").map_or((Self::Times, 1), |len| (Self::Power, len))),
            [b'/', ..] => Some((Self::Over, 1)),
            [b'+', ..] => Some((Self::Plus, 1)),
            [b'-', ..] => Some((Self::Minus, 1)),
            [first, ..] if first.is_ascii_alphabetic() => {
                WORDS.iter().find_map(|(name, operator)| Some((*operator, spelled(text, name)?)))
            }
            _ => None,
        }
    }
}
