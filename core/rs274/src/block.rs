//! The words of one block, gathered and checked for what may stand together.
//!
//! The words stay where the reader has put them; what is kept here is which letters are present, which of them some
//! code has used, and the codes of each group.

use super::flow::Sentence;
use super::group::Group;
use super::mcode::{M_LIMIT, MCode};
use super::{Dialect, GCode, GcodeError, GcodeErrorKind, Span, Word};

/// G codes kept per block: one of each group.
const G_LIMIT: usize = Group::COUNT;

/// The words of one block.
#[derive(Debug)]
pub(super) struct BlockWords<'s> {
    words: &'s [Word],
    /// Letters other than G, M and O that stand here.
    present: u64,
    /// Letters that some code of the block has used.
    used: u64,
    /// Groups of which a code stands here.
    groups: u32,
    codes: heapless::Vec<(Group, GCode, Span), G_LIMIT>,
    pub(super) m: heapless::Vec<MCode, M_LIMIT>,
    pub(super) program: Option<(u32, Span)>,
}

impl<'s> BlockWords<'s> {
    /// Of a block, nothing taken.
    pub(super) const fn of(words: &'s [Word]) -> Self {
        Self {
            words,
            present: 0,
            used: 0,
            groups: 0,
            codes: heapless::Vec::new(),
            m: heapless::Vec::new(),
            program: None,
        }
    }

    /// Takes the words of the block, whose codes mean what they do in a dialect.
    pub(super) fn gather(&mut self, sentence: &Sentence<'_>, dialect: Dialect) -> Result<(), GcodeError> {
        let refused = |kind, span| GcodeError::new(kind, &sentence.line, span).in_file(sentence.source.file);
        let mut twice = None;
        for word in self.words {
            let again = self.take(word, dialect).map_err(|kind| refused(kind, word.span))?;
            twice = twice.or(again.then_some(word));
        }
        // The arguments of a macro may come in several sets of I J K; Mazak names the next tool beside the one that M6 takes.
        let of_macro = self.code(Group::OneShot).is_some_and(|(code, _)| code.tenths() == 650);
        let changes = dialect == Dialect::Fanuc && self.m.iter().any(|m| m.number == 6);
        if let Some(word) = twice.filter(|word| !(of_macro || changes && word.letter == b'T')) {
            return Err(refused(GcodeErrorKind::DuplicateWord { letter: word.letter.to_ascii_uppercase() }, word.span));
        }
        Ok(())
    }

    /// All of them, in the order of the text.
    pub(super) const fn words(&self) -> &'s [Word] {
        self.words
    }

    const fn has_words(&self) -> bool {
        self.present != 0 || self.groups != 0
    }

    /// Takes one; `true` when its letter has stood here before.
    fn take(&mut self, word: &Word, dialect: Dialect) -> Result<bool, GcodeErrorKind> {
        let letter = word.letter;
        if self.program.is_some() {
            return Err(GcodeErrorKind::OutOfPlace { letter: b'O' });
        }
        match letter {
            b'G' => self.take_g(word, dialect)?,
            b'M' => {
                let code = MCode { number: whole(*word)?, span: word.span };
                self.m.push(code).map_err(|_| GcodeErrorKind::TooManyM { limit: M_LIMIT as u8 })?;
            }
            b'O' if self.has_words() || !self.m.is_empty() => return Err(GcodeErrorKind::OutOfPlace { letter }),
            b'O' => self.program = Some((whole(*word)?, word.span)),
            _ => {
                let again = self.present & bit(letter) != 0;
                self.present |= bit(letter);
                return Ok(again);
            }
        }
        Ok(false)
    }

    fn take_g(&mut self, word: &Word, dialect: Dialect) -> Result<(), GcodeErrorKind> {
        let second = GCode::new(word.value).ok_or(GcodeErrorKind::NotAGCode)?.in_dialect(dialect);
        let group = second.group_in(dialect)?;
        if self.groups & group.bit() == 0 {
            self.groups |= group.bit();
            // There is room for one code of each group.
            return self.codes.push((group, second, word.span)).map_err(|_| GcodeErrorKind::NotAGCode);
        }
        let Some(known) = self.codes.iter_mut().find(|(g, ..)| *g == group) else {
            return Ok(());
        };
        let first = known.1;
        match (group, first.tenths(), second.tenths()) {
            // G80 beside another motion only ends the one before.
            (Group::Motion, a, 800) if a != 800 => {}
            (Group::Motion, 800, b) if b != 800 => (known.1, known.2) = (second, word.span),
            // G50 is asked for its words.
            (Group::Cancel, a, 500) if a != 500 => (known.1, known.2) = (second, word.span),
            (Group::Cancel | Group::Smoothness, a, b) if a != b => {}
            _ => return Err(GcodeErrorKind::Conflict { first, second }),
        }
        Ok(())
    }

    /// The code of a group with its place.
    pub(super) fn code(&self, group: Group) -> Option<(GCode, Span)> {
        if self.groups & group.bit() == 0 {
            return None;
        }
        self.codes.iter().find(|(g, ..)| *g == group).map(|(_, code, span)| (*code, *span))
    }

    /// Whether there is any code but of a motion.
    pub(super) const fn has_modes(&self) -> bool {
        self.groups & !Group::Motion.bit() != 0
    }

    /// A word, without using it.
    pub(super) fn word(&self, letter: u8) -> Option<Word> {
        if self.present & bit(letter) == 0 {
            return None;
        }
        self.words.iter().find(|w| w.letter == letter).copied()
    }

    /// The last word of a letter.
    pub(super) fn last_word(&self, letter: u8) -> Option<Word> {
        self.words.iter().rev().find(|w| w.letter == letter).copied()
    }

    /// A word not used yet; it counts as used from now on.
    pub(super) fn use_word(&mut self, letter: u8) -> Option<Word> {
        if self.used & bit(letter) != 0 {
            return None;
        }
        let word = self.word(letter)?;
        self.used |= bit(letter);
        Some(word)
    }

    /// The same on a condition.
    pub(super) fn use_word_if(&mut self, letter: u8, wanted: bool) -> Option<Word> {
        if wanted { self.use_word(letter) } else { None }
    }

    /// Whether any of these letters stands here unused.
    pub(super) fn has_unused(&self, letters: &[u8]) -> bool {
        let mask = letters.iter().fold(0, |mask, &letter| mask | bit(letter));
        self.present & !self.used & mask != 0
    }

    /// The first word that nothing has used.
    pub(super) fn first_unused(&self) -> Option<Word> {
        if self.present & !self.used == 0 {
            return None;
        }
        let open = |w: &&Word| !matches!(w.letter, b'G' | b'M' | b'O') && self.used & bit(w.letter) == 0;
        self.words.iter().find(open).copied()
    }
}

/// The place of a letter in a set: `@` and the capital letters, `^`, and `r` and `c` for the corner words.
pub(super) const fn bit(letter: u8) -> u64 {
    1u64.wrapping_shl((letter as u32).wrapping_sub(64))
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
