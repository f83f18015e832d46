//! The schema and its versions: migrations go forward only, each in a transaction of its own.

use truepath_ground::diagnostics::{Failure, InputError};

use crate::backend::{Backend, whole};
use crate::clock::now;
use crate::codes::{O002, O003};
use crate::place::Place;
use crate::value::{Value, values};

/// A step from one version to the next: its version and its statements.
pub(crate) type Migration = (i64, &'static str);

/// All of them in their order.
pub(crate) const MIGRATIONS: &[Migration] = &[
    (1, include_str!("../migrations/0001_tables.sql")),
    (2, include_str!("../migrations/0002_said.sql")),
    (3, include_str!("../migrations/0003_cutter_serial.sql")),
];

/// The version this program works with.
pub const VERSION: i64 = 3;

/// The statements that make the roles of PostgreSQL; may be given again and again.
pub(crate) const ROLES: &str = include_str!("../migrations/roles.sql");

/// The version of a store, `None` where there is none yet.
pub(crate) fn version(on: &mut dyn Backend) -> Result<Option<i64>, Failure> {
    if !on.has_table("schema_version")? {
        return Ok(None);
    }
    let rows = on.rows("SELECT max(version) FROM schema_version", &[])?;
    rows.first().map_or(Ok(None), |row| row.some_integer(0))
}

/// Brings a store up to the last of the migrations; gives the versions before and after.
///
/// # Errors
/// `O003` for a store that is newer than this program.
pub(crate) fn migrate(
    on: &mut dyn Backend,
    place: &Place,
    migrations: &[Migration],
) -> Result<(Option<i64>, i64), Failure> {
    whole(on, |on| {
        on.script("CREATE TABLE IF NOT EXISTS schema_version (version BIGINT PRIMARY KEY, applied BIGINT NOT NULL)")
    })?;
    let before = version(on)?;
    let last = migrations.last().map_or(0, |(version, _)| *version);
    if before.is_some_and(|before| before > last) {
        return Err(other(place, before.unwrap_or_default(), last).into());
    }
    for (number, statements) in migrations {
        whole(on, |on| {
            // Somebody else may have been here since.
            if version(on)?.is_some_and(|version| version >= *number) {
                return Ok(());
            }
            let statements = on.in_its_words(statements);
            on.script(&statements)?;
            on.change("INSERT INTO schema_version (version, applied) VALUES ($1, $2)", &values![*number, now()])?;
            Ok(())
        })?;
    }
    Ok((before, last))
}

/// Refuses a store of another version.
///
/// # Errors
/// `O002` where there is none, `O003` for another version.
pub(crate) fn refuse_other(on: &mut dyn Backend, place: &Place) -> Result<(), Failure> {
    match version(on)? {
        Some(VERSION) => Ok(()),
        None => Err(O002.error(format!("{place} holds no store"), "what truepath store init made").into()),
        Some(found) => Err(other(place, found, VERSION).into()),
    }
}

fn other(place: &Place, found: i64, own: i64) -> InputError {
    let expected = format!("version {own}");
    let found_words = format!("{place} is a store of schema version {found}");
    if found > own {
        let help = "use a newer truepath: this one does not know what is in it";
        return InputError::new(O003, found_words, expected, help);
    }
    InputError::new(O003, found_words, expected, "bring it up with truepath store migrate, after a backup")
}

/// Adds to a counter.
pub(crate) fn count(on: &mut dyn Backend, name: &str, more: i64) -> Result<(), Failure> {
    on.change("UPDATE counter SET value = value + $1 WHERE name = $2", &[Value::from(more), Value::from(name)])?;
    Ok(())
}
