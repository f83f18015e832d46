//! A model of the flash in lent RAM, with the rules of the part and power that can fail.
//!
//! Beside the bytes it keeps the state of every word, because a programmed word of ones looks like an erased one and
//! a torn one like any other. Each program of a word and each erase of a sector is one operation; they are counted,
//! as they are slow on the part (DS12110: some 0.1 ms a word, 1 s and more a sector).

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

use super::bank::{BLANK, SECTOR_BYTES, WORD_BYTES};

/// State of a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum WordState {
    /// Erased, not programmed since.
    #[default]
    Blank,
    /// Programmed once.
    Programmed,
    /// Its programming or erase was interrupted.
    Torn,
}

/// Why the flash refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NorError {
    /// An offset or a length is not that of whole words or sectors.
    NotAligned,
    /// Beyond the end of the flash.
    OutOfBounds,
    /// The word at this offset is torn: its error-correcting code does not agree.
    Ecc {
        /// Offset of the word.
        offset: u32,
    },
    /// The word at this offset was programmed before and not erased since.
    Programmed {
        /// Offset of the word.
        offset: u32,
    },
    /// There is no power.
    NoPower,
}

impl NorFlashError for NorError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            _ => NorFlashErrorKind::Other,
        }
    }
}

/// Operations carried out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wear {
    /// Sectors erased.
    pub erased_sectors: u32,
    /// Words programmed.
    pub programmed_words: u32,
}

impl Wear {
    /// Both together: the count a [`Cut`] refers to.
    pub const fn operations(self) -> u32 {
        self.erased_sectors.wrapping_add(self.programmed_words)
    }
}

/// Where in an operation the power fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Nothing of the operation has happened.
    Before,
    /// A word is torn: it reads as an ECC error until it is erased. Of a sector some words are erased, some are torn
    /// and some are as they were; which, follows from this number.
    Within(u32),
    /// The operation is complete, but nobody learns of it.
    After,
}

/// A power cut at one erase of a sector or one program of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Operations that still succeed before it.
    pub after_operations: u32,
    /// Where in the next one the power fails.
    pub moment: Moment,
}

/// What an interrupted erase leaves of one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remains {
    Erased,
    Torn,
    Old,
}

impl Remains {
    /// The fate of a word, from the number of the cut and the place of the word (a multiplicative hash of 32 bits).
    fn of(seed: u32, word: usize) -> Self {
        let mixed = (seed ^ 0x9E37_79B9).wrapping_add(word as u32).wrapping_mul(0x85EB_CA6B);
        match (mixed ^ (mixed >> 15)) % 3 {
            0 => Self::Erased,
            1 => Self::Torn,
            _ => Self::Old,
        }
    }
}

/// The flash: as many sectors as bytes, and states of their words, are lent.
pub struct Nor<'a> {
    bytes: &'a mut [u8],
    words: &'a mut [WordState],
    wear: Wear,
    cut: Option<Cut>,
    powered: bool,
}

impl<'a> Nor<'a> {
    /// A flash with the contents that `bytes` and `words` hold.
    pub fn new(bytes: &'a mut [u8], words: &'a mut [WordState]) -> Self {
        Self { bytes, words, wear: Wear::default(), cut: None, powered: true }
    }
    /// A flash as it leaves the factory.
    pub fn erased(bytes: &'a mut [u8], words: &'a mut [WordState]) -> Self {
        bytes.fill(0xFF);
        words.fill(WordState::Blank);
        Self::new(bytes, words)
    }
    /// The memory it was made of.
    pub fn into_memory(self) -> (&'a mut [u8], &'a mut [WordState]) {
        (self.bytes, self.words)
    }
    /// What has been done to it since it was made.
    pub const fn wear(&self) -> Wear {
        self.wear
    }
    /// Lets the power fail at an operation from here on; none takes the cut back.
    pub fn cut(&mut self, cut: Option<Cut>) {
        self.cut = cut;
    }
    /// Whether there is power.
    pub const fn is_powered(&self) -> bool {
        self.powered
    }
    /// The power comes back, with no further cut.
    pub fn power_up(&mut self) {
        self.cut = None;
        self.powered = true;
    }
    /// Tears a word, as a power cut would. Nothing happens beyond the end.
    pub fn tear(&mut self, offset: u32) {
        if let Some(state) = self.words.get_mut(offset as usize / WORD_BYTES) {
            *state = WordState::Torn;
        }
    }
    /// State of the word an offset lies in; torn beyond the end.
    pub fn word_state(&self, offset: u32) -> WordState {
        self.words.get(offset as usize / WORD_BYTES).copied().unwrap_or(WordState::Torn)
    }

    /// Begins an operation; gives the moment at which the power fails in it, if it does.
    fn begin(&mut self) -> Result<Option<Moment>, NorError> {
        if !self.powered {
            return Err(NorError::NoPower);
        }
        let Some(cut) = &mut self.cut else { return Ok(None) };
        if cut.after_operations > 0 {
            cut.after_operations -= 1;
            return Ok(None);
        }
        let moment = cut.moment;
        self.cut = None;
        self.powered = false;
        if moment == Moment::Before { Err(NorError::NoPower) } else { Ok(Some(moment)) }
    }

    fn program(&mut self, offset: u32, data: &[u8]) -> Result<(), NorError> {
        let (Some(state), Some(bytes)) = (
            self.words.get(offset as usize / WORD_BYTES).copied(),
            self.bytes.get_mut(offset as usize..).and_then(|rest| rest.first_chunk_mut::<WORD_BYTES>()),
        ) else {
            return Err(NorError::OutOfBounds);
        };
        match state {
            WordState::Blank => bytes.copy_from_slice(data),
            WordState::Programmed => return Err(NorError::Programmed { offset }),
            WordState::Torn => return Err(NorError::Ecc { offset }),
        }
        Ok(())
    }

    fn mark(&mut self, offset: u32, state: WordState) {
        if let Some(word) = self.words.get_mut(offset as usize / WORD_BYTES) {
            *word = state;
        }
    }

    fn erase_sector(&mut self, start: usize, moment: Option<Moment>) {
        let words = start / WORD_BYTES..(start + SECTOR_BYTES) / WORD_BYTES;
        let Some(states) = self.words.get_mut(words.clone()) else { return };
        let bytes = self.bytes.get_mut(start..start + SECTOR_BYTES).unwrap_or_default();
        for ((word, state), bytes) in words.zip(states).zip(bytes.as_chunks_mut::<WORD_BYTES>().0) {
            let remains = match moment {
                Some(Moment::Within(seed)) => Remains::of(seed, word),
                _ => Remains::Erased,
            };
            match remains {
                Remains::Erased => (*state, *bytes) = (WordState::Blank, BLANK),
                Remains::Torn => *state = WordState::Torn,
                Remains::Old => {}
            }
        }
    }
}

impl ErrorType for Nor<'_> {
    type Error = NorError;
}

impl From<NorFlashErrorKind> for NorError {
    fn from(kind: NorFlashErrorKind) -> Self {
        if kind == NorFlashErrorKind::NotAligned { Self::NotAligned } else { Self::OutOfBounds }
    }
}

impl ReadNorFlash for Nor<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorError> {
        if !self.powered {
            return Err(NorError::NoPower);
        }
        check_read(self, offset, bytes.len())?;
        let (start, end) = (offset as usize, offset as usize + bytes.len());
        let words = start / WORD_BYTES..end.div_ceil(WORD_BYTES);
        let torn = |word: &usize| self.words.get(*word) == Some(&WordState::Torn);
        if let Some(word) = words.clone().find(torn) {
            return Err(NorError::Ecc { offset: (word * WORD_BYTES) as u32 });
        }
        bytes.copy_from_slice(self.bytes.get(start..end).unwrap_or(&[]));
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.bytes.len().min(self.words.len() * WORD_BYTES)
    }
}

impl NorFlash for Nor<'_> {
    const WRITE_SIZE: usize = WORD_BYTES;
    const ERASE_SIZE: usize = SECTOR_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorError> {
        check_erase(self, from, to)?;
        for start in (from as usize..to as usize).step_by(SECTOR_BYTES) {
            let moment = self.begin()?;
            self.erase_sector(start, moment);
            self.wear.erased_sectors = self.wear.erased_sectors.wrapping_add(1);
            if moment.is_some() {
                return Err(NorError::NoPower);
            }
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorError> {
        check_write(self, offset, bytes.len())?;
        for (data, at) in bytes.chunks_exact(WORD_BYTES).zip((offset..).step_by(WORD_BYTES)) {
            let moment = self.begin()?;
            self.program(at, data)?;
            let torn = matches!(moment, Some(Moment::Within(_)));
            self.mark(at, if torn { WordState::Torn } else { WordState::Programmed });
            self.wear.programmed_words = self.wear.programmed_words.wrapping_add(1);
            if moment.is_some() {
                return Err(NorError::NoPower);
            }
        }
        Ok(())
    }
}
