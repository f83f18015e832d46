//! The shop store: the parts of all jobs of a shop, with their readings and corrections, in one place.
//!
//! | concern | where |
//! |---|---|
//! | a file, or a database of a server | [`Place`] |
//! | both behind one trait | `backend` |
//! | tables, and their versions | `schema`, `migrations/*.sql` |
//! | what a folder holds | [`PartFolder`] |
//! | a history as rows, and as its file again | `rows` |
//! | a part goes in, once, whole or not at all | `add` |
//! | `history.json` comes out, byte for byte | `export` |
//! | what other jobs let a job expect | `members` |
//! | what is in it, without counting | `status` |
//!
//! `docs/store.md` is for whoever sets one up or audits it.

mod add;
mod backend;
mod clock;
pub mod codes;
mod export;
mod folder;
mod members;
mod names;
mod place;
mod rows;
mod schema;
mod status;
mod store;
mod value;

pub use add::{Added, Setup};
pub use export::Choice;
pub use folder::{Found, PartFolder};
pub use members::setting;
pub use place::{Place, VARIABLE};
pub use schema::VERSION;
pub use status::{LastPart, Status};
pub use store::{Migrated, Store};
