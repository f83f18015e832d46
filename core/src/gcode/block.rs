//! The words of one block, gathered and checked for what may stand together.

use super::code::Group;
use super::flow::Sentence;
use super::mcode::{M_LIMIT, MCode};
use super::{Foreign, GCode, GcodeError, GcodeErrorKind, Span, Word};

/// The words of one block.
#[derive(Debug)]
pub(super) struct BlockWords {
    /// Words other than G, M, N and O; each letter once, so the capacity is never exceeded.
    words: heapless::Vec<Word, 26>,
    /// Letters that some code of the block has used.
    used: u32,
    codes: [Option<(GCode, Span)>; Group::COUNT],
    pub(super) m: heapless::Vec<MCode, M_LIMIT>,
    pub(super) program: Option<(u32, Span)>,
}

impl BlockWords {
    /// Takes the words of a block.
    pub(super) fn gather(sentence: &Sentence<'_>) -> Result<Self, GcodeError> {
        let mut block = Self {
            words: heapless::Vec::new(),
            used: 0,
            codes: [None; Group::COUNT],
            m: heapless::Vec::new(),
            program: None,
        };
        for &word in &sentence.words {
            let refused = |kind| GcodeError::new(kind, &sentence.line, word.span).in_file(sentence.source.file);
            block.take(word).map_err(refused)?;
        }
        Ok(block)
    }

    fn has_words(&self) -> bool {
        !self.words.is_empty() || !self.m.is_empty() || self.program.is_some() || self.codes.iter().any(Option::is_some)
    }

    fn take(&mut self, word: Word) -> Result<(), GcodeErrorKind> {
        let letter = word.letter;
        if self.program.is_some() {
            return Err(GcodeErrorKind::OutOfPlace { letter: b'O' });
        }
        match letter {
            b'G' => self.take_g(word),
            b'M' => {
                let code = MCode { number: whole(word)?, span: word.span };
                self.m.push(code).map_err(|_| GcodeErrorKind::TooManyM { limit: M_LIMIT as u8 })
            }
            b'O' if self.has_words() => Err(GcodeErrorKind::OutOfPlace { letter }),
            b'O' => {
                self.program = Some((whole(word)?, word.span));
                Ok(())
            }
            b'r' | b'c' => Err(GcodeErrorKind::CornerRounding),
            b'E' => Err(GcodeErrorKind::ForeignDialect(Foreign::Printer)),
            b'A' | b'B' | b'C' | b'U' | b'V' | b'W' => Err(GcodeErrorKind::UnsupportedAxis { letter }),
            _ if self.word(letter).is_some() => Err(GcodeErrorKind::DuplicateWord { letter }),
            _ => self.words.push(word).map_err(|_| GcodeErrorKind::DuplicateWord { letter }),
        }
    }

    fn take_g(&mut self, word: Word) -> Result<(), GcodeErrorKind> {
        let second = GCode::new(word.value).ok_or(GcodeErrorKind::NotAGCode)?;
        let Some(place) = self.codes.get_mut(second.group()?.index()) else {
            return Ok(());
        };
        if let Some((first, _)) = *place {
            return Err(GcodeErrorKind::Conflict { first, second });
        }
        *place = Some((second, word.span));
        Ok(())
    }

    /// The code of a group, in tenths, with its place.
    pub(super) fn code(&self, group: Group) -> Option<(GCode, Span)> {
        *self.codes.get(group.index())?
    }

    /// A word, without using it.
    pub(super) fn word(&self, letter: u8) -> Option<Word> {
        self.words.iter().find(|w| w.letter == letter).copied()
    }

    /// A word not used yet; it counts as used from now on.
    pub(super) fn use_word(&mut self, letter: u8) -> Option<Word> {
        let word = self.word(letter).filter(|_| self.used & bit(letter) == 0)?;
        self.used |= bit(letter);
        Some(word)
    }

    /// Whether any of these letters stands here unused.
    pub(super) fn has_unused(&self, letters: &[u8]) -> bool {
        letters.iter().any(|&l| self.used & bit(l) == 0 && self.word(l).is_some())
    }

    /// The first word that nothing has used.
    pub(super) fn first_unused(&self) -> Option<Word> {
        self.words.iter().find(|w| self.used & bit(w.letter) == 0).copied()
    }
}

const fn bit(letter: u8) -> u32 {
    1u32.wrapping_shl(letter as u32)
}

/// The number of a word that must be whole, 0…2³²−1.
pub(super) fn whole(word: Word) -> Result<u32, GcodeErrorKind> {
    let letter = word.letter;
    if word.value.is_negative() {
        return Err(GcodeErrorKind::Negative { letter });
    }
    let whole = word.value.exactly_times(1).ok_or(GcodeErrorKind::NotWhole { letter })?;
    u32::try_from(whole).map_err(|_| GcodeErrorKind::OutOfRange { letter })
}
