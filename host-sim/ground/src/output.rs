//! Output files and folders: written whole or not at all, and never over something without being told to.
//!
//! Everything is first written beside its target, in a file or folder with a name of its own, and moved into place
//! when it is complete: a command that fails or is stopped leaves the target as it was. Missing folders above a target
//! are made, and taken away again when nothing came to lie in them. Replacing files in an existing
//! folder (`--force`) takes one rename a file; when one of them fails the others are put back. Only a power failure
//! between two renames can leave a mixture, and then the replaced files are still in the temporary folder. A signal
//! that ends the process takes the temporary files along (see [`interruption`](crate::interruption)). One run at a time
//! writes a folder.

mod lock;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::{NamedTempFile, TempDir};

use crate::codes::F003;
use crate::diagnostics::{Failure, InputError};
use crate::interruption::{Hold, Kind, Temporary, hold};
use lock::Lock;

/// A single output file on its way.
#[derive(Debug)]
pub struct OutputFile {
    target: PathBuf,
    force: bool,
    file: BufWriter<NamedTempFile>,
    // Dropped in this order.
    _temporary: Arc<Temporary>,
    _parents: Parents,
}

impl OutputFile {
    /// Opens a file beside `target`.
    ///
    /// # Errors
    /// `F003` when the target exists and `force` is not set, `F002` when its folder cannot be written to.
    pub fn create(target: &Path, force: bool) -> Result<Self, InputError> {
        if target.is_dir() {
            return Err(InputError::new(
                F003,
                format!("{} is a folder", target.display()),
                "the name of a file",
                "name a file in it",
            )
            .in_file(target));
        }
        refuse_existing(target, force)?;
        let mut hold = hold();
        let parents = Parents::make(target, &mut hold)?;
        let file = plain_mode(&mut tempfile::Builder::new(), 0o666)
            .prefix(".truepath-")
            .tempfile_in(folder_of(target))
            .map_err(|e| InputError::unwritable(target, &e))?;
        let temporary = hold.removes(file.path(), Kind::File);
        Ok(Self {
            target: target.to_owned(),
            force,
            file: BufWriter::new(file),
            _temporary: temporary,
            _parents: parents,
        })
    }

    /// Puts the finished file in its place.
    ///
    /// # Errors
    /// `F002` when writing fails, `F003` when the target has appeared meanwhile and `force` is not set.
    pub fn commit(self) -> Result<(), InputError> {
        let failed = |e: io::Error| InputError::unwritable(&self.target, &e);
        let file = self.file.into_inner().map_err(|e| failed(e.into_error()))?;
        file.as_file().sync_all().map_err(failed)?;
        let _hold = hold();
        let moved = if self.force { file.persist(&self.target) } else { file.persist_noclobber(&self.target) };
        match moved {
            Ok(_) => Ok(()),
            Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => refuse_existing(&self.target, false),
            Err(e) => Err(failed(e.error)),
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Stands for files of any name.
const EVERY: &str = "**";

/// An output folder on its way.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    force: bool,
    owned: Vec<&'static str>,
    staged: TempDir,
    // Dropped in this order: what lies in the folders above goes before them.
    _temporary: Arc<Temporary>,
    _lock: Lock,
    _parents: Parents,
}

/// Folders that were made so that a target can lie in them. Dropped, those go that have stayed empty: a command that
/// fails leaves no folder behind.
#[derive(Debug)]
struct Parents(Vec<(PathBuf, Arc<Temporary>)>);

impl Parents {
    /// Makes the folders above a target that are missing.
    fn make(target: &Path, hold: &mut Hold) -> Result<Self, InputError> {
        let folder = folder_of(target);
        let missing = folder.ancestors().take_while(|a| !a.as_os_str().is_empty() && !a.exists());
        let mut missing: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        missing.reverse();
        let parents = missing.into_iter().map(|path| (path.clone(), hold.removes(&path, Kind::EmptyFolder)));
        let parents = Self(parents.collect());
        fs::create_dir_all(folder).map_err(|e| InputError::unwritable(target, &e))?;
        Ok(parents)
    }
}

impl Drop for Parents {
    fn drop(&mut self) {
        for (folder, _) in self.0.iter().rev() {
            // Refused for one that is not empty, which is as it should be.
            let _ = fs::remove_dir(folder);
        }
    }
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
        if target.exists() && !target.is_dir() {
            return Err(InputError::new(
                F003,
                format!("{} is a file", target.display()),
                "the name of a folder",
                "name another folder",
            )
            .in_file(target));
        }
        refuse_occupied(target, force)?;
        let mut hold = hold();
        let parents = Parents::make(target, &mut hold)?;
        let lock = Lock::take(target, folder_of(target), &mut hold)?;
        let staged = plain_mode(&mut tempfile::Builder::new(), 0o777)
            .prefix(".truepath-")
            .tempdir_in(folder_of(target))
            .map_err(|e| InputError::unwritable(target, &e))?;
        let temporary = hold.removes(staged.path(), Kind::Folder);
        let owned = owned.to_vec();
        Ok(Self {
            target: target.to_owned(),
            force,
            owned,
            staged,
            _temporary: temporary,
            _lock: lock,
            _parents: parents,
        })
    }

    /// Opens a folder that is not there yet, for files of any name in it and below it.
    ///
    /// # Errors
    /// `F003` when the target exists, else as [`OutputFolder::create`].
    pub fn new(target: &Path) -> Result<Self, InputError> {
        if target.exists() {
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
        let failed = |e: &io::Error| InputError::unwritable(&self.target.join(name), e);
        if !self.owns(name) {
            return Err(failed(&io::Error::other("this command has no output of that name")));
        }
        // After a signal the folder is gone.
        let _hold = hold();
        let place = self.staged.path().join(name);
        fs::create_dir_all(folder_of(&place)).map_err(|e| failed(&e))?;
        let mut file = fs::File::create(place).map_err(|e| failed(&e))?;
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(|e| failed(&e))
    }

    /// Whether a name is one of the owned ones, or begins with the owned folder it lies in.
    fn owns(&self, name: &str) -> bool {
        if self.owned == [EVERY] {
            return !name.split('/').any(|part| matches!(part, "" | "." | ".."));
        }
        let folder = name.split_once('/').map(|(folder, _)| folder);
        if let Some(folder) = folder {
            return self.owns_folder(folder) && !name.split('/').any(|part| matches!(part, "" | "." | ".."));
        }
        self.owned.iter().any(|owned| match owned.split_once('#') {
            None if owned.starts_with('*') => name.contains(owned.trim_matches('*')),
            None => *owned == name,
            Some((before, after)) => {
                let number = name.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)).unwrap_or_default();
                number.bytes().all(|b| b.is_ascii_digit()) && number.bytes().next().is_some_and(|first| first != b'0')
            }
        })
    }

    fn owns_folder(&self, name: &str) -> bool {
        self.owned.iter().any(|owned| owned.strip_suffix('/') == Some(name))
    }

    /// The owned names in a folder.
    fn names_in(&self, folder: &Path) -> io::Result<Vec<String>> {
        let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        names.filter(|name| name.as_ref().map_or(true, |name| self.owns(name) || self.owns_folder(name))).collect()
    }

    /// Opens one of the owned files to be written piece by piece, for tables too large for memory.
    ///
    /// # Errors
    /// As [`OutputFolder::write`].
    pub fn stream(&self, name: &str) -> Result<BufWriter<fs::File>, InputError> {
        self.write(name, b"")?;
        let opened = fs::File::options().append(true).open(self.staged.path().join(name));
        opened.map(BufWriter::new).map_err(|e| InputError::unwritable(&self.target.join(name), &e))
    }

    /// Puts the finished files in their place.
    ///
    /// # Errors
    /// `F002` when a file cannot be moved, `F003` when files have appeared in the target meanwhile and `force` is not
    /// set; the target is then as it was.
    pub fn commit(self) -> Result<(), InputError> {
        let failed = |e: &io::Error| InputError::unwritable(&self.target, e);
        let _hold = hold();
        refuse_occupied(&self.target, self.force)?;
        if !self.target.exists() {
            let staged = self.staged.keep();
            return fs::rename(&staged, &self.target).map_err(|e| {
                // The error that matters is the first one; the folder is only litter.
                let _ = fs::remove_dir_all(&staged);
                failed(&e)
            });
        }
        let aside = plain_mode(&mut tempfile::Builder::new(), 0o777)
            .prefix(".truepath-replaced-")
            .tempdir_in(folder_of(&self.target))
            .map_err(|e| failed(&e))?;
        let mut exchange = Exchange::default();
        let mut names = BTreeSet::new();
        for folder in [self.target.as_path(), self.staged.path()] {
            names.extend(self.names_in(folder).map_err(|e| failed(&e))?);
        }
        let moved = names.iter().try_for_each(|name| {
            let place = self.target.join(name);
            if place.is_dir() != self.owns_folder(name) && place.exists() {
                return Err(io::Error::other(format!(
                    "{name} is {} there",
                    if place.is_dir() { "a folder" } else { "a file" }
                )));
            }
            if place.exists() {
                exchange.rename(&place, &aside.path().join(name))?;
            }
            let fresh = self.staged.path().join(name);
            if fresh.exists() { exchange.rename(&fresh, &place) } else { Ok(()) }
        });
        moved.map_err(|error| match exchange.undo() {
            Ok(()) => failed(&error),
            Err(second) => {
                let kept = aside.keep();
                failed(&io::Error::other(format!("{error}; then {second}: the former files are in {}", kept.display())))
            }
        })
    }
}

/// Renames that can be taken back.
#[derive(Default)]
struct Exchange(Vec<(PathBuf, PathBuf)>);

impl Exchange {
    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)?;
        self.0.push((from.to_owned(), to.to_owned()));
        Ok(())
    }
    fn undo(&mut self) -> io::Result<()> {
        while let Some((from, to)) = self.0.pop() {
            fs::rename(to, from)?;
        }
        Ok(())
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
    if force || !fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Ok(());
    }
    let found = format!("{} exists and is not empty", folder.display());
    let help = "name another folder, or add --force to replace the files of the same names";
    Err(InputError::new(F003, found, "a new or an empty folder", help).in_file(folder))
}

fn refuse_existing(target: &Path, force: bool) -> Result<(), InputError> {
    if force || !target.exists() {
        return Ok(());
    }
    let found = format!("{} exists", target.display());
    Err(InputError::new(F003, found, "the name of a new file", "name another file, or add --force to replace it")
        .in_file(target))
}

/// The folder a target lies in, so that moving it into place stays on one file system.
fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if parent.as_os_str() != OsStr::new("") => parent,
        _ => Path::new("."),
    }
}

/// Temporary files are private by default; what becomes an output gets the user's ordinary permissions.
#[cfg(unix)]
fn plain_mode<'b, 'p, 's>(builder: &'b mut tempfile::Builder<'p, 's>, mode: u32) -> &'b mut tempfile::Builder<'p, 's> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(mode))
}

/// Elsewhere than on Unix a new file inherits its permissions.
#[cfg(not(unix))]
fn plain_mode<'b, 'p, 's>(builder: &'b mut tempfile::Builder<'p, 's>, _mode: u32) -> &'b mut tempfile::Builder<'p, 's> {
    builder
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
