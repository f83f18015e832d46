//! How far a value, a parameter or a statement reaches, without computing it.

use super::decimal::{is_blank, number, trimmed};
use super::symbol::{Function, Operator};

/// Bytes of the value at the start of a text, blanks before it included: a number, a parameter, a function, an
/// expression in brackets, with signs before it. `None` when none of them stands there. A bracket or a name that is not
/// closed reaches to the end of the text.
pub(super) fn value(text: &[u8]) -> Option<usize> {
    let mut rest = text;
    let mut hash = false;
    loop {
        rest = trimmed(rest);
        let (&byte, behind) = rest.split_first()?;
        match byte {
            b'#' => hash = true,
            b'+' | b'-' => {}
            b'<' if hash => return Some(length(text, after(behind, b'>'))),
            b'[' => return Some(length(text, bracket(rest))),
            b'0'..=b'9' | b'.' => return Some(length(text, number(rest).0)),
            _ => {
                let (function, len) = Function::at(rest)?;
                let mut end = bracket(trimmed(rest.get(len..)?));
                if function == Function::Atan
                    && let Some(second) = trimmed(end).strip_prefix(b"/").map(trimmed)
                    && second.first() == Some(&b'[')
                {
                    end = bracket(second);
                }
                return Some(length(text, end));
            }
        }
        rest = behind;
    }
}

/// The same with operators behind it.
pub(super) fn expression(text: &[u8]) -> Option<usize> {
    let mut end = value(text)?;
    loop {
        let rest = trimmed(text.get(end..)?);
        let Some((_, len)) = Operator::at(rest) else { return Some(end) };
        let behind = rest.get(len..)?;
        let to = value(behind).and_then(|n| behind.get(n..)).unwrap_or(behind);
        end = length(text, to);
    }
}

/// Bytes of an assignment at the start of a text (`#… = …`); `None` when it is none.
pub(super) fn assignment(text: &[u8]) -> Option<usize> {
    let rest = text.get(value(text)?..)?;
    let right = trimmed(rest).strip_prefix(b"=")?;
    let to = expression(right).and_then(|n| right.get(n..)).unwrap_or(right);
    Some(length(text, to))
}

/// Whether a statement of custom macro B begins here.
pub(super) fn is_statement(text: &[u8]) -> bool {
    let is_here = |word: &[u8]| text.get(..word.len()).is_some_and(|t| t.eq_ignore_ascii_case(word));
    let followed = |word: &[u8], by: fn(u8) -> bool| {
        is_here(word) && text.get(word.len()..).map(trimmed).and_then(|r| r.first()).is_some_and(|&b| by(b))
    };
    let bracket = |b| b == b'[';
    let digit = |b: u8| b.is_ascii_digit() || matches!(b, b'#' | b'[');
    followed(b"IF", bracket)
        || followed(b"WHILE", bracket)
        || followed(b"GOTO", digit)
        || followed(b"DO", digit)
        || followed(b"END", digit)
        || followed(b"DPRNT", bracket)
        || followed(b"BPRNT", bracket)
        || is_here(b"POPEN")
        || is_here(b"PCLOS")
}

/// Bytes of a statement: up to the comments and blanks at the end of the line, which are no part of it.
pub(super) fn statement(text: &[u8]) -> usize {
    let mut rest = text;
    let mut end = text;
    while let Some((&byte, behind)) = rest.split_first() {
        rest = match byte {
            b';' => break,
            b'(' => match comment(rest).and_then(|len| rest.get(len..)) {
                Some(behind) => behind,
                None => break,
            },
            _ => {
                let behind = if byte == b'<' { after(behind, b'>') } else { behind };
                if !is_blank(byte) {
                    end = behind;
                }
                behind
            }
        };
    }
    length(text, end)
}

/// Bytes of the comment that opens at the start of a text, its parentheses included: up to the one that closes it where
/// comments stand inside each other, or up to the first `)` where they do not match. `None` when nothing closes it.
#[inline(never)]
pub(super) fn comment(text: &[u8]) -> Option<usize> {
    let mut depth = 0u32;
    let matching = text.iter().position(|&byte| {
        match byte {
            b'(' => depth = depth.saturating_add(1),
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    });
    matching.or_else(|| text.iter().position(|&b| b == b')')).map(|n| n.saturating_add(1))
}

/// What follows the blanks and comments at the start of a text.
#[inline(never)]
pub(in super::super) fn behind_comments(text: &[u8]) -> &[u8] {
    let mut rest = trimmed(text);
    while let Some(b'(') = rest.first()
        && let Some(behind) = comment(rest).and_then(|len| rest.get(len..))
    {
        rest = trimmed(behind);
    }
    rest
}

fn length(text: &[u8], rest: &[u8]) -> usize {
    text.len().saturating_sub(rest.len())
}

/// What stands behind the next `byte`, or nothing.
fn after(text: &[u8], byte: u8) -> &[u8] {
    let end = text.iter().position(|&b| b == byte).map_or(text.len(), |n| n.saturating_add(1));
    text.get(end..).unwrap_or(&[])
}

/// What stands behind the bracket that opens here, or nothing.
fn bracket(text: &[u8]) -> &[u8] {
    let (mut depth, mut name) = (0u32, false);
    let close = text.iter().position(|&byte| {
        match byte {
            b'<' => name = true,
            b'>' => name = false,
            b'[' if !name => depth = depth.saturating_add(1),
            b']' if !name => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    });
    text.get(close.map_or(text.len(), |n| n.saturating_add(1))..).unwrap_or(&[])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_reaches_as_far_as_it_is_computed() {
        for (text, bytes) in [
            ("#1X2", 2),
            ("##1 ", 3),
            (" [1+[2]]Y", 8),
            ("-#<a b> Y", 7),
            ("abs[-1]Z", 7),
            ("ATAN[1]/[2]Z", 11),
            ("atan[1] F", 7),
            ("#[#<_ini[a]b>]X", 14),
            ("[1", 2),
        ] {
            assert_eq!(value(text.as_bytes()), Some(bytes), "{text}");
        }
        assert_eq!(value(b"X1"), None);
    }

    #[test]
    fn an_assignment_takes_its_operators_but_not_the_next_word() {
        assert_eq!(assignment(b"#1=#2+1*[3] X5"), Some(11));
        assert_eq!(assignment(b"#<a> = 5 #2=3"), Some(8));
        assert_eq!(assignment(b"#1 = 2 A3"), Some(6));
        assert_eq!(assignment(b"#1 X2"), None);
    }
}
