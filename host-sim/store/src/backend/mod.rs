//! What a store is kept in: SQLite or PostgreSQL, behind one trait.
//!
//! Everything above is written once, in statements that both understand. Parameters are `$1`, `$2` and so on.

mod passwords;
mod postgres;
mod sqlite;

use truepath_ground::diagnostics::{Failure, InputError};

use crate::codes::O004;
use crate::place::Place;
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
    /// Whether it has roles.
    fn has_roles(&self) -> bool;
}

/// Opens one.
pub(crate) fn open(place: &Place, make: Make) -> Result<Box<dyn Backend>, Failure> {
    Ok(match place {
        Place::File(path) => Box::new(sqlite::Sqlite::open(path, make)?),
        Place::Server(url) => Box::new(postgres::Postgres::open(url)?),
    })
}

/// Does a work in one transaction: all of it is kept, or nothing.
pub(crate) fn whole<T>(
    on: &mut dyn Backend,
    work: impl FnOnce(&mut dyn Backend) -> Result<T, Failure>,
) -> Result<T, Failure> {
    on.begin()?;
    let done = work(on).and_then(|done| on.script("COMMIT").map(|()| done));
    if done.is_err() {
        // What failed may have ended the transaction, and what remains of it ends with the connection.
        let _ = on.script("ROLLBACK");
    }
    done
}

/// The error of a store that takes nothing.
fn refuses(place: &str, why: &str) -> InputError {
    O004.error(format!("{place} takes nothing ({why})"), "a store that can be written to")
}
