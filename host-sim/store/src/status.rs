//! What is in a store: from counters and indices, so that its size does not matter.

use serde::Serialize;
use truepath_ground::diagnostics::Failure;

use crate::backend::Backend;
use crate::clock::utc;
use crate::codes::O008;
use crate::place::Place;
use crate::schema::VERSION;
use crate::value::{Row, values};

/// The tables with a counter.
const COUNTED: [&str; 8] = ["machine", "holder", "cutter", "material", "job", "part", "reading", "history"];

/// What is in a store.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    /// Where it is, without a password.
    pub store: String,
    /// The version of its schema.
    pub schema_version: i64,
    /// Machines.
    pub machines: i64,
    /// Holders.
    pub holders: i64,
    /// Cutters.
    pub cutters: i64,
    /// Materials, each lot for itself.
    pub materials: i64,
    /// Walls of programs, each way of cutting it for itself.
    pub jobs: i64,
    /// Measured parts.
    pub parts: i64,
    /// Their readings.
    pub readings: i64,
    /// Files `history.json`.
    pub histories: i64,
    /// The parts that were stored last, the newest first.
    pub last_parts: Vec<LastPart>,
}

/// A part that was stored.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LastPart {
    /// The number of the newest history that holds it: what `export` takes.
    pub history: Option<i64>,
    /// CRC-32 of its program.
    pub program_crc32: String,
    /// The feature of it.
    pub feature: String,
    /// Its number in the order they were cut.
    pub part: i64,
    /// Its serial number.
    pub serial: Option<String>,
    /// Its machine.
    pub machine: Option<String>,
    /// How warm it was when it was measured, °C.
    pub temperature_c: Option<f64>,
    /// Its readings.
    pub readings: i64,
    /// When it was stored, UTC.
    pub stored: String,
}

pub(crate) fn status(on: &mut dyn Backend, place: &Place, last: u32) -> Result<Status, Failure> {
    let rows = on.rows("SELECT name, value FROM counter", &[])?;
    let counter = |name: &str| {
        let of = rows.iter().find(|row| row.text(0).is_ok_and(|own| own == name));
        of.map_or(Ok(0), |row| row.integer(1))
    };
    let last_parts = "SELECT j.program_crc32, j.feature, p.number, p.serial, m.name, p.stored, \
                      (SELECT s.readings FROM measurement s WHERE s.part = p.id ORDER BY s.id DESC LIMIT 1), \
                      (SELECT max(h.history) FROM history_part h JOIN measurement s ON s.id = h.measurement WHERE s.part = p.id), \
                      p.temperature_c \
                      FROM part p JOIN job j ON j.id = p.job LEFT JOIN machine m ON m.id = p.machine \
                      ORDER BY p.id DESC LIMIT $1";
    let parts = on.rows(last_parts, &values![i64::from(last)])?;
    let part = |row: &Row| {
        Ok(LastPart {
            program_crc32: row.text(0)?.to_owned(),
            feature: row.text(1)?.to_owned(),
            part: row.integer(2)?,
            serial: row.some_text(3)?.map(str::to_owned),
            machine: row.some_text(4)?.map(str::to_owned),
            stored: utc(row.integer(5)?),
            readings: row.some_integer(6)?.unwrap_or(0),
            history: row.some_integer(7)?,
            temperature_c: row.some_real(8)?,
        })
    };
    Ok(Status {
        store: place.to_string(),
        schema_version: VERSION,
        machines: counter("machine")?,
        holders: counter("holder")?,
        cutters: counter("cutter")?,
        materials: counter("material")?,
        jobs: counter("job")?,
        parts: counter("part")?,
        readings: counter("reading")?,
        histories: counter("history")?,
        last_parts: parts.iter().map(part).collect::<Result<_, Failure>>()?,
    })
}

/// Counts what the counters say.
///
/// # Errors
/// `O008` for one that says something else.
pub(crate) fn count_again(on: &mut dyn Backend, place: &Place) -> Result<(), Failure> {
    for table in COUNTED {
        let counts = format!("SELECT count(*), (SELECT value FROM counter WHERE name = '{table}') FROM {table}");
        for row in on.rows(&counts, &[])? {
            let (rows, said) = (row.integer(0)?, row.some_integer(1)?);
            if said != Some(rows) {
                let found = format!("{place} has {rows} rows of {table}, and its counter says {said:?}");
                return Err(O008.error(found, "the same number").into());
            }
        }
    }
    Ok(())
}
