//! Output files and folders: written whole or not at all, and never over something without being told to.
//!
//! Everything is first written beside its target, in a file or folder with a name of its own, and moved into place
//! when it is complete: a command that fails or is stopped leaves the target as it was. Missing folders above a target
//! are made, and taken away again when nothing came to lie in them. Replacing files in an existing
//! folder (`--force`) takes one rename a file; when one of them fails the others are put back. Only a power failure
//! between two renames can leave a mixture, and then the replaced files are still in the temporary folder. A signal
//! that ends the process takes the temporary files along (see [`interruption`](crate::interruption)). One run at a time
//! writes a folder.
//!
//! In a browser the target lies in memory ([`crate::files`]), and nothing is written before it is complete.

#[cfg(any(test, target_family = "wasm"))]
mod in_memory;
#[cfg(not(target_family = "wasm"))]
mod lock;
#[cfg(not(target_family = "wasm"))]
mod on_disk;
mod owned;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::codes::F003;
use crate::diagnostics::{Failure, InputError};
use crate::files;
use crate::interruption::hold;
#[cfg(target_family = "wasm")]
use in_memory::{StagedFile, StagedFolder};
#[cfg(not(target_family = "wasm"))]
use on_disk::{StagedFile, StagedFolder};
use owned::{EVERY, Owned};

#[cfg(target_family = "wasm")]
pub use in_memory::Stream;
#[cfg(not(target_family = "wasm"))]
pub use on_disk::Stream;

/// A single output file on its way.
#[derive(Debug)]
pub struct OutputFile {
    target: PathBuf,
    force: bool,
    staged: StagedFile,
}

impl OutputFile {
    /// Opens a file beside `target`.
    ///
    /// # Errors
    /// `F003` when the target exists and `force` is not set, `F002` when its folder cannot be written to.
    pub fn create(target: &Path, force: bool) -> Result<Self, InputError> {
        if files::is_dir(target) {
            return Err(InputError::new(
                F003,
                format!("{} is a folder", target.display()),
                "the name of a file",
                "name a file in it",
            )
            .in_file(target));
        }
        refuse_existing(target, force)?;
        Ok(Self { target: target.to_owned(), force, staged: StagedFile::create(target)? })
    }

    /// Puts the finished file in its place.
    ///
    /// # Errors
    /// `F002` when writing fails, `F003` when the target has appeared meanwhile and `force` is not set.
    pub fn commit(self) -> Result<(), InputError> {
        self.staged.commit(&self.target, self.force).or_else(|e| match e.kind() {
            io::ErrorKind::AlreadyExists => refuse_existing(&self.target, false),
            _ => Err(InputError::unwritable(&self.target, &e)),
        })
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.staged.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.staged.flush()
    }
}

/// An output folder on its way.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    force: bool,
    owned: Owned,
    staged: StagedFolder,
}

impl OutputFolder {
    /// Opens a folder beside `target`. `owned` are the names this command may write, `#` in them stands for a number
    /// from 1, `*` before and behind a part of a name for any text, and one that ends in `/` is a folder with whatever is in it: with `force` every one of them that lies in the target is replaced or, when this run does not write it,
    /// removed, so that no file of an earlier run stays behind beside newer ones. Other files in the target are left
    /// alone.
    ///
    /// # Errors
    /// `F003` when the target exists, is not empty and `force` is not set, or is no folder; `F004` when another run
    /// writes it; `F002` when its parent cannot be written to.
    pub fn create(target: &Path, force: bool, owned: &[&'static str]) -> Result<Self, InputError> {
        if files::exists(target) && !files::is_dir(target) {
            return Err(InputError::new(
                F003,
                format!("{} is a file", target.display()),
                "the name of a folder",
                "name another folder",
            )
            .in_file(target));
        }
        refuse_occupied(target, force)?;
        let staged = StagedFolder::create(target)?;
        Ok(Self { target: target.to_owned(), force, owned: Owned::new(owned), staged })
    }

    /// Opens a folder that is not there yet, for files of any name in it and below it.
    ///
    /// # Errors
    /// `F003` when the target exists, else as [`OutputFolder::create`].
    pub fn new(target: &Path) -> Result<Self, InputError> {
        if files::exists(target) {
            let found = format!("{} exists", target.display());
            return Err(InputError::new(F003, found, "the name of a new folder", "name another folder").in_file(target));
        }
        Self::create(target, false, &[EVERY])
    }

    /// Writes one of the owned files.
    ///
    /// # Errors
    /// `F002` when writing fails or the name is not one of the owned ones.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), InputError> {
        if !self.owned.file(name) {
            let error = io::Error::other("this command has no output of that name");
            return Err(InputError::unwritable(&self.target.join(name), &error));
        }
        self.staged.write(name, bytes).map_err(|e| InputError::unwritable(&self.target.join(name), &e))
    }

    /// Opens one of the owned files to be written piece by piece, for tables too large for memory.
    ///
    /// # Errors
    /// As [`OutputFolder::write`].
    pub fn stream(&self, name: &str) -> Result<Stream, InputError> {
        self.write(name, b"")?;
        self.staged.stream(name).map_err(|e| InputError::unwritable(&self.target.join(name), &e))
    }

    /// Puts the finished files in their place.
    ///
    /// # Errors
    /// `F002` when a file cannot be moved, `F003` when files have appeared in the target meanwhile and `force` is not
    /// set; the target is then as it was.
    pub fn commit(self) -> Result<(), InputError> {
        let _hold = hold();
        refuse_occupied(&self.target, self.force)?;
        self.staged.commit(&self.target, &self.owned).map_err(|e| InputError::unwritable(&self.target, &e))
    }
}

/// Writes one file whole or not at all.
///
/// # Errors
/// As [`OutputFile::create`] and [`OutputFile::commit`].
pub fn write_file(target: &Path, force: bool, bytes: &[u8]) -> Result<(), InputError> {
    let mut file = OutputFile::create(target, force)?;
    file.write_all(bytes).map_err(|e| InputError::unwritable(target, &e))?;
    file.commit()
}

fn refuse_occupied(folder: &Path, force: bool) -> Result<(), InputError> {
    if force || !files::is_occupied(folder) {
        return Ok(());
    }
    let found = format!("{} exists and is not empty", folder.display());
    let help = "name another folder, or add --force to replace the files of the same names";
    Err(InputError::new(F003, found, "a new or an empty folder", help).in_file(folder))
}

fn refuse_existing(target: &Path, force: bool) -> Result<(), InputError> {
    if force || !files::exists(target) {
        return Ok(());
    }
    let found = format!("{} exists", target.display());
    Err(InputError::new(F003, found, "the name of a new file", "name another file, or add --force to replace it")
        .in_file(target))
}

/// A summary as JSON text.
///
/// # Errors
/// Internal, when it cannot be written.
pub fn json(value: &impl serde::Serialize) -> Result<Vec<u8>, Failure> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| Failure::Internal(format!("JSON: {e}")))?;
    text.push(b'\n');
    Ok(text)
}
