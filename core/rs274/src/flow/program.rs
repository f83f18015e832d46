//! A program and the other programs it may call.

/// A program with what it needs.
#[derive(Clone, Copy)]
pub struct Program<'p> {
    /// Its bytes.
    pub text: &'p [u8],
    /// Other files it may call; without a library a subprogram must stand in the same text.
    pub library: Option<&'p dyn Library>,
}

/// Files that a program may call.
pub trait Library {
    /// The file of a subprogram, by its name in lower case (`pocket`) or its number as digits (`1234`).
    fn find(&self, name: &[u8]) -> Option<LibraryFile<'_>>;
}

/// A file of a library.
#[derive(Clone, Copy, Debug)]
pub struct LibraryFile<'p> {
    /// The number by which events and errors name it, from 1; 0 is the program itself.
    pub number: u16,
    /// Its bytes.
    pub text: &'p [u8],
}

impl<'p> Program<'p> {
    /// A program on its own.
    pub const fn new(text: &'p [u8]) -> Self {
        Self { text, library: None }
    }

    /// A file of its library. Never inlined, so that a search of the call graph finds the one call whose target it
    /// cannot see, in a function of its own.
    #[inline(never)]
    pub(super) fn file(&self, name: &[u8]) -> Option<LibraryFile<'p>> {
        self.library?.find(name)
    }
}

impl<'p> From<&'p [u8]> for Program<'p> {
    fn from(text: &'p [u8]) -> Self {
        Self::new(text)
    }
}

impl<'p, const N: usize> From<&'p [u8; N]> for Program<'p> {
    fn from(text: &'p [u8; N]) -> Self {
        Self::new(text)
    }
}

impl core::fmt::Debug for Program<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (bytes, library) = (self.text.len(), self.library.is_some());
        f.debug_struct("Program").field("bytes", &bytes).field("library", &library).finish()
    }
}
