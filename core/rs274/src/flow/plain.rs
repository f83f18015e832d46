//! Blocks as milling programs nearly always write them: letters with plain numbers, nothing else. They are read in one pass.
//!
//! What is read here is what [`Words`](super::super::Words) reads; whatever is unusual in a block, all of it is left to that.

use super::super::lexical::plain_number;
use super::super::{Line, Span};
use super::sentence::{Sentence, Word};
use crate::Number;

/// Reads a block of letters with numbers between blanks; `false` when it has anything else, or no word, and then the sentence
/// is as it was: without words and number.
pub(super) fn read(line: &Line<'_>, sentence: &mut Sentence<'_>) -> bool {
    let read = words(line, sentence).is_some() && !sentence.words.is_empty();
    if !read {
        sentence.words.clear();
        sentence.source.number = None;
    }
    read
}

fn words(line: &Line<'_>, sentence: &mut Sentence<'_>) -> Option<()> {
    let text = line.text;
    let mut at = 0usize;
    while let Some(&byte) = text.get(at) {
        if matches!(byte, b' ' | b'\t') {
            at = at.saturating_add(1);
            continue;
        }
        // A digit or a point here goes on with the number before it, which is for the long way; letters become capitals.
        let letter = byte & !0x20;
        if !letter.is_ascii_uppercase() || letter == b'O' {
            return None;
        }
        let (value, end) = plain_number(text, at.saturating_add(1))?;
        if letter != b'N' {
            let span = Span { start: line.start.saturating_add(at), len: end.saturating_sub(at) };
            sentence.push(Word { letter, value: Number::Exact(value), span }).ok()?;
        } else if sentence.words.is_empty() && sentence.source.number.is_none() {
            sentence.source.number = Some(value);
        } else {
            return None;
        }
        at = end;
    }
    Some(())
}

/// Inside of the comment that a line is, when it is one in parentheses without others in it, and nothing else: no carriage return,
/// of which the long way warns.
pub(super) fn remark(line: &Line<'_>) -> Option<Span> {
    let [b'(', body @ .., b')'] = line.text else { return None };
    let lone = !body.iter().any(|byte| matches!(byte, b'(' | b')' | b'\r'));
    lone.then(|| Span { start: line.start.saturating_add(1), len: body.len() })
}

#[cfg(test)]
mod tests {
    use super::super::super::{Token, Words};
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn plain(text: &[u8]) -> Option<(Option<crate::Decimal>, Vec<Word>)> {
        let mut sentence = Sentence::new(text);
        let line = Line { number: 3, start: 20, text };
        let read = read(&line, &mut sentence);
        assert!(read || (sentence.words.is_empty() && sentence.source.number.is_none()));
        read.then(|| (sentence.source.number, sentence.words.iter().copied().collect()))
    }

    /// The same by the tokens of the line, when they are words alone.
    fn by_tokens(text: &[u8]) -> Option<(Option<crate::Decimal>, Vec<Word>)> {
        let (mut number, mut words) = (None, Vec::new());
        for token in Words::new(Line { number: 3, start: 20, text }) {
            match token {
                Ok(Token::Word(word)) if word.letter == b'N' && number.is_none() && words.is_empty() => {
                    number = Some(word.value?);
                }
                Ok(Token::Word(word)) => {
                    words.push(Word { letter: word.letter, value: Number::Exact(word.value?), span: word.span });
                }
                _ => return None,
            }
        }
        Some((number, words))
    }

    #[test]
    fn a_block_of_words_is_read_and_any_other_is_not() {
        assert_eq!(plain(b"N10 g01 X-1.5Y.25\tF300"), by_tokens(b"N10 g01 X-1.5Y.25\tF300"));
        assert_eq!(plain(b"N10 g01 X-1.5Y.25\tF300").map(|(n, w)| (n.is_some(), w.len())), Some((true, 4)));
        for other in [
            &b""[..],
            b"N10",
            b"X1 (a)",
            b"X1;",
            b"X",
            b"X 1",
            b"X+1",
            b"X1 2",
            b"X1=2",
            b"X#1",
            b"O1",
            b"/X1",
            b"X1 N2",
            b"%",
            b"X1\r",
            b"X1.2.3",
            b"@1",
            b"X1234567890123456789",
            b"N1 N2 X1",
            b"GOTO1",
            b"X--1",
            b"X1 \x80",
        ] {
            assert_eq!(plain(other), None, "{other:?}");
        }
    }

    #[test]
    fn more_words_than_a_block_has_are_left_to_the_reader_that_refuses_them() {
        let text = b"X1".repeat(super::super::sentence::WORDS + 1);
        assert_eq!(plain(&text), None);
    }

    proptest! {
        #[test]
        fn what_is_read_is_what_the_tokens_say(text in "[NGXYZOF0-9. \t;(=#/-]{0,24}") {
            if let Some(read) = plain(text.as_bytes()) {
                prop_assert_eq!(Some(read), by_tokens(text.as_bytes()));
            }
        }
    }
}
