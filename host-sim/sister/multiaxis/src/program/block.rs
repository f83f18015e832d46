//! One line of a program as words with their places, found with the lexer of the core.

use std::ops::Range;

use truepath_core::gcode::{Decimal, GCode, GcodeError, Line, Number, Token, Words};

/// The letters of the axes a five-axis program moves, in the order in which they are kept.
pub const AXES: [u8; 6] = *b"XYZABC";

/// A letter with what stands behind it.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// Upper case.
    pub letter: u8,
    /// Its number; `None` when it is an expression or a parameter.
    pub value: Option<Decimal>,
    /// Its first byte in the line.
    pub start: usize,
    /// The byte behind it.
    pub end: usize,
}

impl Word {
    /// Its bytes.
    pub fn span(&self) -> Range<usize> {
        self.start..self.end
    }
    /// Tenths of the number of a G code.
    pub fn tenths(&self) -> Option<u16> {
        (self.letter == b'G').then_some(self.value?).and_then(|v| GCode::new(Number::Exact(v))).map(GCode::tenths)
    }
    /// The whole number of an M code, a tool, a P.
    pub fn whole(&self) -> Option<i64> {
        self.value?.exactly_times(1)
    }
}

/// The pieces of one line.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Its words in the order of the text.
    pub words: Vec<Word>,
    /// The place of each axis in `words`.
    pub axes: [Option<usize>; 6],
    /// `/`, with its switch.
    pub block_delete: Option<Range<usize>>,
    /// `%`.
    pub percent: bool,
    /// A statement that steers the program (`O100 sub`, `IF [..] GOTO 10`).
    pub control: Option<Range<usize>>,
    /// The first assignment of a parameter.
    pub assignment: Option<Range<usize>>,
    /// The first axis letter given twice.
    pub twice: Option<Word>,
    /// A corner word `,R` or `,C`.
    pub corner: Option<Range<usize>>,
}

impl Block {
    /// Reads a line; a byte order mark in front of the first one is skipped.
    ///
    /// # Errors
    /// A byte that belongs to nothing, with its place in the line.
    pub fn read(&mut self, number: u32, text: &[u8]) -> Result<(), GcodeError> {
        self.clear();
        let mark = if number == 1 && text.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        for token in Words::new(Line { number, start: mark, text: &text[mark..] }) {
            let token = token?;
            let span = token.span();
            let range = span.start..span.end();
            match token {
                Token::Word(word) => {
                    self.push(Word { letter: word.letter, value: word.value, start: span.start, end: span.end() })
                }
                Token::BlockDelete { .. } => self.block_delete = Some(range),
                Token::Percent(_) => self.percent = true,
                Token::Control(_) => self.control = Some(range),
                Token::Assignment(_) => {
                    self.assignment.get_or_insert(range);
                }
                Token::Corner(_) => self.corner = Some(range),
                Token::Comment { .. } => {}
            }
        }
        Ok(())
    }

    fn clear(&mut self) {
        let mut words = std::mem::take(&mut self.words);
        words.clear();
        *self = Self { words, ..Self::default() };
    }

    fn push(&mut self, word: Word) {
        if let Some(axis) = AXES.iter().position(|&letter| letter == word.letter)
            && self.axes[axis].replace(self.words.len()).is_some()
        {
            self.twice.get_or_insert(word);
        }
        self.words.push(word);
    }

    /// The word of an axis.
    pub fn axis(&self, axis: usize) -> Option<&Word> {
        self.axes[axis].and_then(|at| self.words.get(at))
    }
    /// The last word with a letter.
    pub fn word(&self, letter: u8) -> Option<&Word> {
        self.words.iter().rev().find(|w| w.letter == letter)
    }
    /// Whether X, Y, Z, A, B or C is named.
    pub fn names_axes(&self) -> bool {
        self.axes.iter().any(Option::is_some)
    }
}
