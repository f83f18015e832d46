//! `history.json` comes out of its rows again.

use serde::Serialize;
use truepath_correction::learning::Facts;
use truepath_ground::diagnostics::Failure;

use crate::backend::Backend;
use crate::clock::utc;
use crate::codes::{O006, O008};
use crate::place::Place;
use crate::rows::{HistoryRows, PartRows, Reading, json, sha256};
use crate::value::{Row, values};

/// A history to choose.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// Its number.
    pub history: i64,
    /// The number of its last part.
    pub last_part: i64,
    /// When it was stored, UTC.
    pub stored: String,
}

/// The newest histories of a job: those that no other goes on from, which is one whose last part was cut with their correction.
pub(crate) fn choices(on: &mut dyn Backend, facts: &Facts) -> Result<Vec<Choice>, Failure> {
    let newest = "SELECT h.id, h.last_number, h.stored FROM history h JOIN job j ON j.id = h.job WHERE j.hash = $1 AND NOT EXISTS \
                  (SELECT 1 FROM history n WHERE n.job = h.job AND n.cut_with = h.correction AND n.last_number > h.last_number) \
                  ORDER BY h.id DESC";
    let rows = on.rows(newest, &values![sha256(json(facts)?.as_bytes())])?;
    let choice =
        |row: &Row| Ok(Choice { history: row.integer(0)?, last_part: row.integer(1)?, stored: utc(row.integer(2)?) });
    rows.iter().map(choice).collect()
}

/// The number of the next history.
pub(crate) fn next_after(on: &mut dyn Backend, number: i64) -> Result<Option<i64>, Failure> {
    let rows = on.rows("SELECT id FROM history WHERE id > $1 ORDER BY id LIMIT 1", &values![number])?;
    rows.first().map(|row| row.integer(0)).transpose()
}

/// The file of a history.
pub(crate) fn file_of(on: &mut dyn Backend, place: &Place, number: i64) -> Result<Vec<u8>, Failure> {
    let select = "SELECT j.facts, c.nodes, h.predicted, h.sigma, h.files, h.original, h.hash FROM history h \
                  JOIN job j ON j.id = h.job JOIN correction c ON c.id = h.correction WHERE h.id = $1";
    let rows = on.rows(select, &values![number])?;
    let Some(row) = rows.first() else {
        return Err(O006
            .error(format!("{place} has no history of the number {number}"), "the number of a history")
            .into());
    };
    let bytes = match row.some_text(5)? {
        Some(original) => original.as_bytes().to_vec(),
        None => {
            let rows = HistoryRows {
                facts: row.text(0)?.to_owned(),
                parts: parts(on, number)?,
                correction: row.text(1)?.to_owned(),
                predicted: row.text(2)?.to_owned(),
                sigma: row.text(3)?.to_owned(),
                files: row.text(4)?.to_owned(),
            };
            rows.text()?
        }
    };
    let (found, expected) = (sha256(&bytes), row.text(6)?);
    if found != expected {
        let found = format!("the rows of history {number} give a file with the SHA-256 {found}");
        return Err(O008.error(found, format!("{expected}, as it was when it was stored")).into());
    }
    Ok(bytes)
}

fn parts(on: &mut dyn Backend, history: i64) -> Result<Vec<PartRows>, Failure> {
    let select = "SELECT p.number, p.probe_crc32, m.sigma_nm, c.nodes, hp.set_aside, m.id FROM history_part hp \
                  JOIN measurement m ON m.id = hp.measurement JOIN part p ON p.id = m.part \
                  LEFT JOIN correction c ON c.id = hp.correction WHERE hp.history = $1 ORDER BY hp.position";
    let rows = on.rows(select, &values![history])?;
    let mut parts = Vec::with_capacity(rows.len());
    for row in &rows {
        parts.push(PartRows {
            number: number(row.integer(0)?)?,
            probe_crc32: row.text(1)?.to_owned(),
            sigma_nm: row.integer(2)?,
            correction: row.some_text(3)?.map(str::to_owned),
            set_aside: row.integer(4)? != 0,
            readings: readings(on, row.integer(5)?)?,
        });
    }
    Ok(parts)
}

fn readings(on: &mut dyn Backend, measurement: i64) -> Result<Vec<Reading>, Failure> {
    let select = "SELECT place_nm, height, error_nm, normal_x, normal_y, across_nm, pair, sigma_nm FROM reading \
                  WHERE measurement = $1 ORDER BY position";
    let rows = on.rows(select, &values![measurement])?;
    let reading = |row: &Row| {
        Ok(Reading {
            place_nm: row.integer(0)?,
            height: row.real(1)?,
            error_nm: row.integer(2)?,
            normal: [row.real(3)?, row.real(4)?],
            across_nm: row.some_integer(5)?,
            pair: row.some_integer(6)?.map(number).transpose()?,
            sigma_nm: row.some_integer(7)?,
        })
    };
    rows.iter().map(reading).collect()
}

fn number(value: i64) -> Result<u32, Failure> {
    u32::try_from(value).map_err(|_| Failure::Internal(format!("{value} in the store is no number of a part")))
}
