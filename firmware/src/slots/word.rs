//! Head and commit word of a slot.

use truepath_core::image::crc32;

use crate::flash::WORD_BYTES;

/// What a head or commit word says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// Bytes of the image.
    pub length: u32,
    /// Its checksum.
    pub crc: u32,
    /// Number of the upload.
    pub generation: u32,
}

/// Which word it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An upload was begun.
    Head,
    /// The image is complete and was checked.
    Commit,
    /// The upload was complete and no usable image.
    Rejected,
}

impl Kind {
    const fn magic(self) -> [u8; 4] {
        match self {
            Self::Head => *b"TPH1",
            Self::Commit => *b"TPC1",
            Self::Rejected => *b"TPX1",
        }
    }
}

impl Label {
    /// The word.
    pub fn encode(self, kind: Kind) -> [u8; WORD_BYTES] {
        let mut word = [0; WORD_BYTES];
        let fields = [u32::from_le_bytes(kind.magic()), self.length, self.crc, self.generation];
        for (to, field) in word.as_chunks_mut::<4>().0.iter_mut().zip(fields) {
            *to = field.to_le_bytes();
        }
        let sum = crc32(&word[..28]);
        word[28..].copy_from_slice(&sum.to_le_bytes());
        word
    }
    /// What a word says, if it is an undamaged one of this kind.
    pub fn decode(kind: Kind, word: &[u8; WORD_BYTES]) -> Option<Self> {
        let field = |at: usize| u32::from_le_bytes([word[at], word[at + 1], word[at + 2], word[at + 3]]);
        let sound = word.starts_with(&kind.magic()) && field(28) == crc32(&word[..28]);
        sound.then(|| Self { length: field(4), crc: field(8), generation: field(12) })
    }
}
