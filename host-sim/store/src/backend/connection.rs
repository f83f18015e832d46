//! What every back end does.

use truepath_ground::diagnostics::{Failure, InputError};

use crate::codes::O004;
use crate::value::{Row, Value};

/// Whether a store may be made where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Make {
    /// It may.
    New,
    /// It has to be there.
    Nothing,
}

/// A connection.
pub(crate) trait Backend: Send {
    /// Statements without parameters and answers.
    fn script(&mut self, statements: &str) -> Result<(), Failure>;
    /// A statement with parameters; its rows.
    fn rows(&mut self, statement: &str, values: &[Value]) -> Result<Vec<Row>, Failure>;
    /// A statement that has no rows; how many it has changed.
    fn change(&mut self, statement: &str, values: &[Value]) -> Result<u64, Failure>;
    /// Begins a transaction that is the only one which writes.
    fn begin(&mut self) -> Result<(), Failure>;
    /// A migration in the words of this back end.
    fn in_its_words(&self, statements: &str) -> String;
    /// Whether there is a table.
    fn has_table(&mut self, name: &str) -> Result<bool, Failure>;
    /// What is wrong with the pages of the file, where the back end can tell.
    fn damage(&mut self) -> Result<Option<String>, Failure>;
}

/// The error of a store that takes nothing.
pub(super) fn refuses(place: &str, why: &str) -> InputError {
    O004.error(format!("{place} takes nothing ({why})"), "a store that can be written to")
}
