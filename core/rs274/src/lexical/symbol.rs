//! The names of functions and operators in expressions.

use super::decimal::trimmed;

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
        let is_here = |name: &[u8]| {
            text.split_at_checked(name.len())
                .is_some_and(|(here, rest)| here.eq_ignore_ascii_case(name) && trimmed(rest).first() == Some(&b'['))
        };
        NAMES.iter().find(|(name, _)| is_here(name)).map(|(name, function)| (*function, name.len()))
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
            [b'*', b'*', ..] => Some((Self::Power, 2)),
            [b'*', ..] => Some((Self::Times, 1)),
            [b'/', ..] => Some((Self::Over, 1)),
            [b'+', ..] => Some((Self::Plus, 1)),
            [b'-', ..] => Some((Self::Minus, 1)),
            [first, ..] if first.is_ascii_alphabetic() => {
                let is_here = |name: &[u8]| text.get(..name.len()).is_some_and(|t| t.eq_ignore_ascii_case(name));
                WORDS.iter().find(|(name, _)| is_here(name)).map(|(name, operator)| (*operator, name.len()))
            }
            _ => None,
        }
    }
}
