//! Power cuts for the model of the flash: which operation they hit, and what they leave of it.

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
pub(super) enum Remains {
    Erased,
    Torn,
    Old,
}

impl Remains {
    /// The fate of a word, from the number of the cut and the place of the word (a multiplicative hash of 32 bits).
    pub fn of(seed: u32, word: usize) -> Self {
        let mixed = (seed ^ 0x9E37_79B9).wrapping_add(word as u32).wrapping_mul(0x85EB_CA6B);
        match (mixed ^ (mixed >> 15)) % 3 {
            0 => Self::Erased,
            1 => Self::Torn,
            _ => Self::Old,
        }
    }
}
