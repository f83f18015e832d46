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

use super::outcome::Outcome;
use crate::codes::{Y001, Y002};

/// Name of the table.
pub const NAME: &str = "cases.csv";

/// The table, open for appending.
#[derive(Debug)]
pub struct CaseTable {
    path: PathBuf,
    file: File,
    /// Finished cases by name.
    pub finished: BTreeMap<String, Outcome>,
}

/// What marks the results of this program: its version and the checksum of its own file.
pub fn program_key() -> String {
    let own = std::env::current_exe().and_then(std::fs::read).map_or(0, |bytes| crc32(&bytes));
    format!("# truepath {} {own:08x}", env!("CARGO_PKG_VERSION"))
}

impl CaseTable {
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
            file.write_all(format!("{key}\n{}", Outcome::header()).as_bytes()).map_err(failed)?;
        }
        Ok(Self { path, file, finished })
    }

    /// Appends a finished case, in one write.
    ///
    /// # Errors
    /// `F002` when it cannot be written.
    pub fn append(&mut self, outcome: Outcome) -> Result<(), Failure> {
        self.file.write_all(outcome.line().as_bytes()).map_err(|e| InputError::unwritable(&self.path, &e))?;
        self.finished.insert(outcome.case.clone(), outcome);
        Ok(())
    }
}

fn read(path: &Path, bytes: &[u8]) -> Result<BTreeMap<String, Outcome>, Failure> {
    let mut finished = BTreeMap::new();
    for row in csv::Reader::from_reader(bytes).deserialize::<Outcome>() {
        let outcome = row.map_err(|e| Y002.error(format!("{e}"), "lines that a study wrote").in_file(path))?;
        finished.insert(outcome.case.clone(), outcome);
    }
    Ok(finished)
}

fn other_program(path: &Path, found: &str, key: &str) -> Failure {
    Y001.error(format!("results of another program: `{found}`"), format!("`{key}`")).in_file(path).into()
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let table = CaseTable::open(folder.path(), "# key", false).expect("the same table");
            assert_eq!(table.finished.values().collect::<Vec<_>>(), [&outcome("bore/1001")]);
        }
        let mut table = CaseTable::open(folder.path(), "# key", false).expect("the same table");
        table.append(outcome("boss/1002")).expect("room");
        assert_eq!(std::fs::read(&path).expect("the table"), whole);
        assert!(CaseTable::open(folder.path(), "# other", false).is_err());
        assert!(CaseTable::open(folder.path(), "# other", true).expect("afresh").finished.is_empty());
    }
}
