//! One word of flash, as a reader finds it after any history.

use embedded_storage::nor_flash::ReadNorFlash;

use super::{BLANK, WORD_BYTES};

/// What a word holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// Ones: erased, or programmed with ones, which nobody can tell apart. Words of ones are therefore never
    /// programmed.
    Blank,
    /// Something else.
    Written([u8; WORD_BYTES]),
    /// It cannot be read.
    Torn,
}

impl Word {
    /// The word at an offset, a multiple of 32.
    pub fn read<F: ReadNorFlash>(flash: &mut F, offset: u32) -> Self {
        let mut bytes = BLANK;
        match flash.read(offset, &mut bytes) {
            Ok(()) if bytes == BLANK => Self::Blank,
            Ok(()) => Self::Written(bytes),
            Err(_) => Self::Torn,
        }
    }
    /// Its bytes, if it holds some.
    pub fn written(self) -> Option<[u8; WORD_BYTES]> {
        match self {
            Self::Written(bytes) => Some(bytes),
            _ => None,
        }
    }
    /// Whether it can be programmed.
    pub fn is_blank(self) -> bool {
        self == Self::Blank
    }
}
