//! One block with the values of its words, as it is executed.

use super::super::{GcodeErrorKind, Line, Number, Source, Span};

/// A letter with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// The letter, upper case; `r` and `c` are the corner words `,R` and `,C`.
    pub letter: u8,
    /// Its value.
    pub value: Number,
    /// From the letter to the last byte of the number.
    pub span: Span,
}

impl Word {
    /// Whether a point is written in its number; `text` is the file it stands in.
    pub fn has_point(&self, text: &[u8]) -> bool {
        self.span.of(text).contains(&b'.')
    }
}

/// Words of a block; one more is an error.
pub(in super::super) const WORDS: usize = 64;

/// A block whose words have values. It is filled in place, block after block.
#[derive(Debug)]
pub(in super::super) struct Sentence<'p> {
    /// The file it stands in.
    pub(in super::super) text: &'p [u8],
    /// Its line.
    pub(in super::super) line: Line<'p>,
    /// What events say about it.
    pub(in super::super) source: Source,
    /// Its words but for the N word, in the order of the text.
    pub(in super::super) words: heapless::Vec<Word, WORDS>,
    /// `/` in front of it.
    pub(in super::super) block_delete: Option<Span>,
    /// Whether it has comments.
    pub(in super::super) has_comments: bool,
    /// Whether it is nothing but letters with written numbers, spaces and tabs.
    pub(in super::super) is_plain: bool,
    /// Inside of its comment, when it is nothing but one in parentheses.
    pub(in super::super) remark: Option<Span>,
    /// What a conversational block does, and what stands behind the words that say so.
    #[cfg(feature = "klartext")]
    pub(in super::super) statement: super::super::Statement,
    #[cfg(feature = "klartext")]
    pub(in super::super) rest: Span,
    /// Its comment, from `;` on.
    #[cfg(feature = "klartext")]
    pub(in super::super) comment: Option<Span>,
}

impl<'p> Sentence<'p> {
    /// A sentence before the first block.
    pub(in super::super) const fn new(text: &'p [u8]) -> Self {
        Self {
            text,
            line: Line { number: 1, start: 0, text: &[] },
            source: Source::NONE,
            words: heapless::Vec::new(),
            block_delete: None,
            has_comments: false,
            is_plain: false,
            remark: None,
            #[cfg(feature = "klartext")]
            statement: super::super::Statement::Empty,
            #[cfg(feature = "klartext")]
            rest: Span { start: 0, len: 0 },
            #[cfg(feature = "klartext")]
            comment: None,
        }
    }

    pub(in super::super) fn push(&mut self, word: Word) -> Result<(), GcodeErrorKind> {
        self.words.push(word).map_err(|_| GcodeErrorKind::TooManyWords { limit: WORDS as u8 })
    }
}

/// Parameters set in one block.
pub(super) const ASSIGNMENTS: usize = 32;

/// What an assignment sets.
#[derive(Clone, Copy)]
pub(super) enum Destination {
    Number(u16),
    /// A name, by its bytes from `<` to the end of the line.
    Name(usize),
}

/// The assignments of a block.
pub(super) type Assignments = heapless::Vec<(Destination, f64), ASSIGNMENTS>;
