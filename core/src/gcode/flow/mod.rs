//! The order in which the blocks of a program are executed: its reader, and the programs it calls.

mod frame;
mod next;
mod program;
mod reader;
mod sentence;

pub(super) use next::Next;
pub use program::{Library, LibraryFile, Program};
pub(super) use reader::Reader;
pub(super) use sentence::Sentence;
pub use sentence::Word;
