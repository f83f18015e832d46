//! The order in which the blocks of a program are executed: its reader, and the programs it calls.

mod assignment;
mod call;
mod control;
mod frame;
mod keyword;
#[cfg(feature = "klartext")]
mod klartext;
mod next;
mod open;
mod place;
mod plain;
mod program;
mod reader;
mod sentence;
mod statement;

pub(super) use next::{Next, Target};
pub use program::{Library, LibraryFile, Program};
pub(super) use reader::Reader;
pub(super) use sentence::Sentence;
pub use sentence::Word;
