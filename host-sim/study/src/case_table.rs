//! `cases.csv`: one line for every finished case, appended as it is finished.
//!
//! The first line names the program that made the rest, so that results of different programs are never mixed. A study that
//! is stopped at any moment leaves at most half a line at the end, which the next run drops.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use truepath_core::checksum::crc32;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::codes::{Y001, Y002};

/// Name of the table.
pub const NAME: &str = "cases.csv";

/// What became of a case, as a line of a table: flat text and numbers.
pub trait Line: Serialize + DeserializeOwned + Default {
    /// Name of the case.
    fn case(&self) -> &str;
}

/// The table, open for appending.
#[derive(Debug)]
pub struct CaseTable<L> {
    path: PathBuf,
    file: File,
    /// Finished cases by name.
    pub finished: BTreeMap<String, L>,
}

/// What marks the results of this program: its version and the checksum of its own file.
pub fn program_key() -> String {
    let own = std::env::current_exe().and_then(std::fs::read).map_or(0, |bytes| crc32(&bytes));
    format!("# truepath {} {own:08x}", env!("CARGO_PKG_VERSION"))
}

impl<L: Line> CaseTable<L> {
    /// Opens the table in a folder, which is made when it is not there. `afresh` drops what it holds.
    ///
    /// # Errors
    /// `F002` for a folder that cannot be written, `Y001` for results of another program, `Y002` for a table that is none.
    pub fn open(folder: &Path, key: &str, afresh: bool) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let failed = |e: std::io::Error| Failure::from(InputError::unwritable(&path, &e));
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut finished = BTreeMap::new();
        let mut length = 0;
        if !afresh && path.exists() {
            let source = Source::read(&path)?;
            let whole = source.bytes().iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1);
            let bytes = &source.bytes()[..whole];
            if let Some(end) = bytes.iter().position(|b| *b == b'\n') {
                let found = String::from_utf8_lossy(&bytes[..end]).into_owned();
                if found != key {
                    return Err(other_program(&path, &found, key));
                }
                finished = read(&path, &bytes[end + 1..])?;
                length = whole as u64;
            }
        }
        let mut file =
            OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path).map_err(failed)?;
        file.set_len(length).map_err(failed)?;
        std::io::Seek::seek(&mut file, std::io::SeekFrom::End(0)).map_err(failed)?;
        if length == 0 {
            file.write_all(format!("{key}\n{}", header::<L>()).as_bytes()).map_err(failed)?;
        }
        Ok(Self { path, file, finished })
    }

    /// Appends a finished case, in one write.
    ///
    /// # Errors
    /// `F002` when it cannot be written.
    pub fn append(&mut self, outcome: L) -> Result<(), Failure> {
        self.file.write_all(text(&outcome, false).as_bytes()).map_err(|e| InputError::unwritable(&self.path, &e))?;
        self.finished.insert(outcome.case().to_owned(), outcome);
        Ok(())
    }
}

/// The columns of the table, with the end of their line.
fn header<L: Line>() -> String {
    text(&L::default(), true).lines().next().unwrap_or_default().to_owned() + "\n"
}

fn text(outcome: &impl Line, header: bool) -> String {
    let mut writer = csv::WriterBuilder::new().has_headers(header).from_writer(Vec::new());
    // Serialising flat text and numbers into memory cannot fail.
    let _ = writer.serialize(outcome);
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

fn read<L: Line>(path: &Path, bytes: &[u8]) -> Result<BTreeMap<String, L>, Failure> {
    let mut finished = BTreeMap::new();
    for row in csv::Reader::from_reader(bytes).deserialize::<L>() {
        let outcome = row.map_err(|e| Y002.error(format!("{e}"), "lines that a study wrote").in_file(path))?;
        finished.insert(outcome.case().to_owned(), outcome);
    }
    Ok(finished)
}

fn other_program(path: &Path, found: &str, key: &str) -> Failure {
    Y001.error(format!("results of another program: `{found}`"), format!("`{key}`")).in_file(path).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Outcome;

    fn outcome(case: &str) -> Outcome {
        Outcome { case: case.to_owned(), factor: Some(12.5), failure: "a, \"b\"".to_owned(), ..Outcome::default() }
    }

    #[test]
    fn a_half_line_at_the_end_is_dropped_and_the_rest_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(NAME);
        let mut table = CaseTable::open(folder.path(), "# key", false).expect("a new table");
        table.append(outcome("bore/1001")).expect("room");
        table.append(outcome("boss/1002")).expect("room");
        drop(table);
        let whole = std::fs::read(&path).expect("the table");
        for cut in [1, 5, 12] {
            std::fs::write(&path, &whole[..whole.len() - cut]).expect("writable");
            let table = CaseTable::<Outcome>::open(folder.path(), "# key", false).expect("the same table");
            assert_eq!(table.finished.values().collect::<Vec<_>>(), [&outcome("bore/1001")]);
        }
        let mut table = CaseTable::open(folder.path(), "# key", false).expect("the same table");
        table.append(outcome("boss/1002")).expect("room");
        assert_eq!(std::fs::read(&path).expect("the table"), whole);
        assert!(CaseTable::<Outcome>::open(folder.path(), "# other", false).is_err());
        assert!(CaseTable::<Outcome>::open(folder.path(), "# other", true).expect("afresh").finished.is_empty());
    }
}
