//! What came of `truepath store`, and its words.

use std::fmt::Write;
use std::path::PathBuf;

use serde::Serialize;
use truepath_store::{Migrated, Place, Status};

/// What was imported.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Imported {
    pub(super) store: String,
    pub(super) folders: usize,
    pub(super) histories: usize,
    pub(super) known: usize,
    pub(super) new_parts: usize,
    pub(super) new_readings: usize,
}

/// A history that was written.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Exported {
    pub(super) history: i64,
    pub(super) file: PathBuf,
}

pub(super) fn made(place: &Place, done: Migrated) -> String {
    let Migrated { before, version } = done;
    match before {
        None => format!("{place}: a new store, schema version {version}\n"),
        Some(before) if before == version => format!("{place}: a store of schema version {version} already\n"),
        Some(before) => format!("{place}: schema version {before} → {version}\n"),
    }
}

pub(super) fn imported(s: &Imported) -> String {
    format!(
        "{}: {} new parts with {} readings; {} of {} histories in {} folders were known\n",
        s.store, s.new_parts, s.new_readings, s.known, s.histories, s.folders
    )
}

pub(super) fn exported(written: &[Exported]) -> String {
    written.iter().map(|one| format!("history {}: {}\n", one.history, one.file.display())).collect()
}

pub(super) fn status(s: &Status) -> String {
    let mut text = format!(
        "{}, schema version {}\n\
         machines {}, holders {}, cutters {}, lots of material {}\n\
         jobs {}, parts {}, readings {}, histories {}\n",
        s.store,
        s.schema_version,
        s.machines,
        s.holders,
        s.cutters,
        s.materials,
        s.jobs,
        s.parts,
        s.readings,
        s.histories
    );
    if s.last_parts.is_empty() {
        return text;
    }
    let row = ["stored (UTC)", "history", "program", "feature", "part", "serial", "machine", "readings"];
    let mut rows = vec![row.map(str::to_owned)];
    rows.extend(s.last_parts.iter().map(|part| {
        let named = |name: &Option<String>| name.clone().unwrap_or_else(|| "-".to_owned());
        [
            part.stored.clone(),
            part.history.map_or_else(|| "-".to_owned(), |number| number.to_string()),
            part.program_crc32.clone(),
            part.feature.clone(),
            part.part.to_string(),
            named(&part.serial),
            named(&part.machine),
            part.readings.to_string(),
        ]
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..8).map(width).collect();
    text.push('\n');
    for row in &rows {
        let line: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", line.join("  ").trim_end());
    }
    text
}
