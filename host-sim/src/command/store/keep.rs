//! A part goes into the store after `correct` or `learn` has written its folder.
//!
//! The folder is what counts: whatever is wrong with the store, the command has done its work, and `truepath store import` takes
//! the folder later.

use std::path::Path as FilePath;

use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::Failure;
use truepath_job::job::{JobFile, StoreNames};
use truepath_store::{Added, PartFolder, Place, Setup, Store};

use super::chosen::place;
use crate::terminal::Terminal;

/// Puts the part of a folder into the store that is named, if any is, and prints what came of it.
pub(in crate::command) fn keep(
    named: (&FilePath, Option<&str>),
    output: &FilePath,
    by: &'static str,
    terminal: &Terminal,
) {
    match kept(named, output, by) {
        Ok(notes) => notes.iter().for_each(|note| terminal.note(note)),
        Err(failure) => terminal.warn(&format!(
            "the part is not in the store: {failure}. Nothing else is wrong: its folder is written, and truepath store import {} takes it later",
            output.display()
        )),
    }
}

/// Puts the part of a folder into the store that is named; a sentence for each history, none where no store is named.
///
/// # Errors
/// Whatever is wrong with the store; the folder stays as it is.
pub fn kept(
    (job, given): (&FilePath, Option<&str>),
    output: &FilePath,
    by: &'static str,
) -> Result<Vec<String>, Failure> {
    // It was read a moment ago; if it has gone since, only the command line and the environment name a store.
    let job = JobFile::read(job).ok();
    let Ok(place) = place(given, job.as_ref()) else { return Ok(Vec::new()) };
    let Some(added) = stored(&place, job.as_ref(), output, by)? else {
        let why = "a second pass and planned passes have no history there";
        return Ok(vec![format!("nothing went into the store {place}: {why}")]);
    };
    let said = |one: &Added| {
        let new = if one.known { "was already" } else { "is" };
        format!("part {} {new} in the store {place}, as history {}", one.last_part, one.history)
    };
    Ok(added.iter().map(said).collect())
}

fn stored(
    place: &Place,
    job: Option<&JobFile>,
    output: &FilePath,
    by: &'static str,
) -> Result<Option<Vec<Added>>, Failure> {
    let Some(part) = PartFolder::read(output)? else { return Ok(None) };
    Store::open(place)?.add(&part, &setup(job, by)).map(Some)
}

/// What the job says of the shop; serial number and lot may stand in `[part]`.
pub(super) fn setup(job: Option<&JobFile>, by: &'static str) -> Setup {
    let Some(job) = job else { return Setup { by, ..Setup::default() } };
    let (names, part) = (job.store.names.clone(), &job.part.names);
    let names = StoreNames {
        lot: names.lot.or_else(|| part.material_batch.clone()),
        serial: names.serial.or_else(|| part.serial.clone()),
        ..names
    };
    let stickout_nm = job.numbers.tool.cantilever.map_or(0, |cutter| cutter.length.nm());
    let temperature_c = job.part.temperature.map(Decimal::as_f64);
    Setup { names, stickout_nm, temperature_c, by }
}
