//! A flash that goes back to what it held: of its pages, only those that were written to are copied.

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use truepath_fw::flash::{Cut, Nor, NorError, WORD_BYTES, WordState};

/// Bytes of a page.
const PAGE: usize = 1_024;

/// The model of the flash, and which of its pages were written to or erased since it was taken up.
pub struct KeptFlash {
    nor: Nor<'static>,
    touched: Vec<bool>,
}

/// What a flash held.
pub struct Contents {
    bytes: Vec<u8>,
    words: Vec<WordState>,
}

impl KeptFlash {
    /// One as it leaves the factory. Its memory stays allocated until the process ends.
    pub fn erased(capacity: usize) -> Self {
        let bytes = vec![0; capacity].leak();
        let words = vec![WordState::Blank; capacity / WORD_BYTES].leak();
        Self { nor: Nor::erased(bytes, words), touched: vec![false; capacity.div_ceil(PAGE)] }
    }
    /// What it holds now, to come back to.
    pub fn contents(self) -> (Self, Contents) {
        let (bytes, words) = self.nor.into_memory();
        let contents = Contents { bytes: bytes.to_vec(), words: words.to_vec() };
        let touched = vec![false; self.touched.len()];
        (Self { nor: Nor::new(bytes, words), touched }, contents)
    }
    /// Holds again what it held when it gave its contents, with power.
    #[must_use]
    pub fn restored(self, contents: &Contents) -> Self {
        let Self { nor, mut touched } = self;
        let (bytes, words) = nor.into_memory();
        for (page, _) in touched.iter_mut().enumerate().filter_map(|(k, t)| std::mem::take(t).then_some((k, ()))) {
            copy(bytes, &contents.bytes, page, PAGE);
            copy(words, &contents.words, page, PAGE / WORD_BYTES);
        }
        Self { nor: Nor::new(bytes, words), touched }
    }
    /// Lets the power fail at an operation from here on.
    pub fn cut(&mut self, cut: Cut) {
        self.nor.cut(Some(cut));
    }
    /// The power comes back.
    pub fn power_up(&mut self) {
        self.nor.power_up();
    }

    fn touch(&mut self, from: usize, to: usize) {
        if let Some(pages) = self.touched.get_mut(from / PAGE..to.div_ceil(PAGE)) {
            pages.fill(true);
        }
    }
}

fn copy<T: Copy>(to: &mut [T], from: &[T], page: usize, each: usize) {
    let range = page * each..(page + 1) * each;
    if let (Some(to), Some(from)) = (to.get_mut(range.clone()), from.get(range)) {
        to.copy_from_slice(from);
    }
}

impl ErrorType for KeptFlash {
    type Error = NorError;
}

impl ReadNorFlash for KeptFlash {
    const READ_SIZE: usize = Nor::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorError> {
        self.nor.read(offset, bytes)
    }
    fn capacity(&self) -> usize {
        self.nor.capacity()
    }
}

impl NorFlash for KeptFlash {
    const WRITE_SIZE: usize = Nor::WRITE_SIZE;
    const ERASE_SIZE: usize = Nor::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorError> {
        self.touch(from as usize, to as usize);
        self.nor.erase(from, to)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorError> {
        self.touch(offset as usize, offset as usize + bytes.len());
        self.nor.write(offset, bytes)
    }
}
