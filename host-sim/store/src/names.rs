//! Rows that are known by a name: made the first time they are met.

use truepath_ground::diagnostics::Failure;

use crate::backend::Backend;
use crate::schema::count;
use crate::value::{Value, values};

/// The number of a row that is known by some columns: found, or made with them and those of `more`.
///
/// `counted` is the counter of its table. Gives whether it was made.
pub(crate) fn known(
    on: &mut dyn Backend,
    table: &str,
    by: &[(&str, Value)],
    more: &[(&str, Value)],
    counted: bool,
) -> Result<(i64, bool), Failure> {
    let all: Vec<&(&str, Value)> = by.iter().chain(more).collect();
    let columns: Vec<&str> = all.iter().map(|(column, _)| *column).collect();
    let places: Vec<String> = (1..=all.len()).map(|n| format!("${n}")).collect();
    let insert = format!(
        "INSERT INTO {table} ({}) VALUES ({}) ON CONFLICT DO NOTHING RETURNING id",
        columns.join(", "),
        places.join(", ")
    );
    let given: Vec<Value> = all.iter().map(|(_, value)| value.clone()).collect();
    // Looking first leaves no gaps in the numbers of a server.
    if let Some(id) = find(on, table, by)? {
        return Ok((id, false));
    }
    if let Some(row) = on.rows(&insert, &given)?.first() {
        if counted {
            count(on, table, 1)?;
        }
        return Ok((row.integer(0)?, true));
    }
    let id = find(on, table, by)?;
    id.map(|id| (id, false)).ok_or_else(|| Failure::Internal(format!("a row of {table} that is neither there nor new")))
}

fn find(on: &mut dyn Backend, table: &str, by: &[(&str, Value)]) -> Result<Option<i64>, Failure> {
    let wanted: Vec<String> = by.iter().enumerate().map(|(i, (column, _))| format!("{column} = ${}", i + 1)).collect();
    let select = format!("SELECT id FROM {table} WHERE {}", wanted.join(" AND "));
    let values: Vec<Value> = by.iter().map(|(_, value)| value.clone()).collect();
    on.rows(&select, &values)?.first().map(|row| row.integer(0)).transpose()
}

/// The number of a machine or a holder by its name.
pub(crate) fn named(on: &mut dyn Backend, table: &str, name: Option<&String>) -> Result<Option<i64>, Failure> {
    let id = name.map(|name| known(on, table, &[("name", name.into())], &[], true)).transpose()?;
    Ok(id.map(|(id, _)| id))
}

/// Notes that something has happened.
pub(crate) fn note(
    on: &mut dyn Backend,
    kind: &str,
    (part, history): (Option<i64>, Option<i64>),
    text: String,
) -> Result<(), Failure> {
    let values = values![crate::clock::now(), kind, part, history, text];
    on.change("INSERT INTO event (at, kind, part, history, text) VALUES ($1, $2, $3, $4, $5)", &values)?;
    Ok(())
}
