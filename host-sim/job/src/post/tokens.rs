//! A comment as words, numbers and signs.

/// A piece of a comment.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    /// Letters, in upper case.
    Word(String),
    /// A number; `true` when it is a plain whole one.
    Number(f64, bool),
    /// Anything else but blanks.
    Sign(char),
}

impl Token {
    pub(super) fn is(&self, words: &[&str]) -> bool {
        matches!(self, Self::Word(word) if words.contains(&word.as_str()))
    }
    pub(super) fn is_sign(&self, signs: &str) -> bool {
        matches!(self, Self::Sign(sign) if signs.contains(*sign))
    }
    pub(super) const fn number(&self) -> Option<f64> {
        match self {
            Self::Number(value, _) => Some(*value),
            _ => None,
        }
    }
    pub(super) fn whole(&self) -> Option<u32> {
        match self {
            Self::Number(value, true) if (0.0..1e9).contains(value) => Some(*value as u32),
            _ => None,
        }
    }
}

/// Splits a text in upper case. A fraction is one number, `1/2`, also behind a whole one, `1 1/2`; a comma between digits is
/// a decimal sign.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let letters: Vec<char> = text.chars().collect();
    let mut out = Vec::new();
    let mut at = 0;
    while at < letters.len() {
        let letter = letters[at];
        let digit_at = |at: usize| letters.get(at).is_some_and(char::is_ascii_digit);
        if letter.is_alphabetic() {
            let end = (at..letters.len()).find(|&i| !letters[i].is_alphabetic()).unwrap_or(letters.len());
            out.push(Token::Word(letters[at..end].iter().collect()));
            at = end;
        } else if letter.is_ascii_digit() || (letter == '.' && digit_at(at + 1)) {
            let (value, whole, end) = number(&letters, at);
            out.push(Token::Number(value, whole));
            at = end;
        } else {
            if !letter.is_whitespace() {
                out.push(Token::Sign(letter));
            }
            at += 1;
        }
    }
    fractions(out)
}

fn number(letters: &[char], start: usize) -> (f64, bool, usize) {
    let digit_at = |at: usize| letters.get(at).is_some_and(char::is_ascii_digit);
    let mut text = String::new();
    let (mut at, mut whole) = (start, true);
    while let Some(&letter) = letters.get(at) {
        match letter {
            '0'..='9' => text.push(letter),
            '.' if whole => {
                whole = false;
                text.push('.');
            }
            ',' if whole && digit_at(at + 1) => {
                whole = false;
                text.push('.');
            }
            _ => break,
        }
        at += 1;
    }
    (text.parse().unwrap_or(0.0), whole, at)
}

fn fractions(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut rest = tokens.as_slice();
    while let Some((first, behind)) = rest.split_first() {
        let fraction = match rest {
            [above, Token::Sign('/'), below, ..] => above.whole().zip(below.whole()).filter(|(_, below)| *below > 1),
            _ => None,
        };
        let Some((above, below)) = fraction else {
            out.push(first.clone());
            rest = behind;
            continue;
        };
        let part = f64::from(above) / f64::from(below);
        let before = out.last().and_then(Token::whole).filter(|_| part < 1.0);
        if let Some(before) = before {
            out.pop();
            out.push(Token::Number(f64::from(before) + part, false));
        } else {
            out.push(Token::Number(part, false));
        }
        rest = rest.get(3..).unwrap_or_default();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let values = |text: &str| tokens(text).iter().filter_map(Token::number).collect::<Vec<_>>();
        assert_eq!(values("1/2 FLAT"), [0.5]);
        assert_eq!(values("1 1/2 FLAT"), [1.5]);
        assert_eq!(values("D=9,525 CR0.5 .5"), [9.525, 0.5, 0.5]);
        assert_eq!(values("12.10.2024"), [12.1, 0.2024]);
        assert_eq!(tokens("D10."), [Token::Word("D".into()), Token::Number(10.0, false)]);
    }
}
