//! What a store is kept in: SQLite or PostgreSQL, behind one trait.
//!
//! Everything above is written once, in statements that both understand. Parameters are `$1`, `$2` and so on.

mod connection;
mod encryption;
mod passwords;
mod postgres;
mod sqlite;

use truepath_ground::diagnostics::Failure;

use crate::place::Place;

pub(crate) use connection::{Backend, Make};

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
