//! Outputs on disk: first written beside their target, in a file or folder with a name of its own, and moved into place when
//! they are complete.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::{NamedTempFile, TempDir};

use super::lock::Lock;
use super::owned::{Owned, of_another_kind};
use crate::diagnostics::InputError;
use crate::interruption::{Hold, Kind, Temporary, hold};

/// A file on its way.
#[derive(Debug)]
pub(super) struct StagedFile {
    file: BufWriter<NamedTempFile>,
    // Dropped in this order.
    _temporary: Arc<Temporary>,
    _parents: Parents,
}

impl StagedFile {
    /// Opens a file beside `target`.
    ///
    /// # Errors
    /// `F002` when its folder cannot be written to.
    pub(super) fn create(target: &Path) -> Result<Self, InputError> {
        let mut hold = hold();
        let parents = Parents::make(target, &mut hold)?;
        let file = plain_mode(&mut tempfile::Builder::new(), 0o666)
            .prefix(".truepath-")
            .tempfile_in(folder_of(target))
            .map_err(|e| InputError::unwritable(target, &e))?;
        let temporary = hold.removes(file.path(), Kind::File);
        Ok(Self { file: BufWriter::new(file), _temporary: temporary, _parents: parents })
    }

    /// Moves it to `target`, over what is there only where it `replaces`.
    ///
    /// # Errors
    /// `AlreadyExists` where it may not replace what is there, and what the system says.
    pub(super) fn commit(self, target: &Path, replaces: bool) -> io::Result<()> {
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        let _hold = hold();
        let moved = if replaces { file.persist(target) } else { file.persist_noclobber(target) };
        moved.map(drop).map_err(|e| e.error)
    }
}

impl Write for StagedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A folder on its way.
#[derive(Debug)]
pub(super) struct StagedFolder {
    staged: TempDir,
    // Dropped in this order: what lies in the folders above goes before them.
    _temporary: Arc<Temporary>,
    _lock: Lock,
    _parents: Parents,
}

/// An output that is written piece by piece.
pub type Stream = BufWriter<fs::File>;

impl StagedFolder {
    /// Opens a folder beside `target`.
    ///
    /// # Errors
    /// `F004` when another run writes it; `F002` when its parent cannot be written to.
    pub(super) fn create(target: &Path) -> Result<Self, InputError> {
        let mut hold = hold();
        let parents = Parents::make(target, &mut hold)?;
        let lock = Lock::take(target, folder_of(target), &mut hold)?;
        let staged = plain_mode(&mut tempfile::Builder::new(), 0o777)
            .prefix(".truepath-")
            .tempdir_in(folder_of(target))
            .map_err(|e| InputError::unwritable(target, &e))?;
        let temporary = hold.removes(staged.path(), Kind::Folder);
        Ok(Self { staged, _temporary: temporary, _lock: lock, _parents: parents })
    }

    /// Writes a file.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        // After a signal the folder is gone.
        let _hold = hold();
        let place = self.staged.path().join(name);
        fs::create_dir_all(folder_of(&place))?;
        let mut file = fs::File::create(place)?;
        file.write_all(bytes).and_then(|()| file.sync_all())
    }

    /// Opens a file that was written, to go on at its end.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn stream(&self, name: &str) -> io::Result<Stream> {
        fs::File::options().append(true).open(self.staged.path().join(name)).map(BufWriter::new)
    }

    /// Puts the files in their place; what is `owned` in the target and was not written goes.
    ///
    /// # Errors
    /// What the system says; the target is then as it was.
    pub(super) fn commit(self, target: &Path, owned: &Owned) -> io::Result<()> {
        if !target.exists() {
            let staged = self.staged.keep();
            return fs::rename(&staged, target).inspect_err(|_| {
                // The error that matters is the first one; the folder is only litter.
                let _ = fs::remove_dir_all(&staged);
            });
        }
        let aside = plain_mode(&mut tempfile::Builder::new(), 0o777)
            .prefix(".truepath-replaced-")
            .tempdir_in(folder_of(target))?;
        let mut exchange = Exchange::default();
        let mut names = BTreeSet::new();
        for folder in [target, self.staged.path()] {
            names.extend(names_in(folder, owned)?);
        }
        let moved = names.iter().try_for_each(|name| {
            let place = target.join(name);
            if place.is_dir() != owned.folder(name) && place.exists() {
                return Err(of_another_kind(name, place.is_dir()));
            }
            if place.exists() {
                exchange.rename(&place, &aside.path().join(name))?;
            }
            let fresh = self.staged.path().join(name);
            if fresh.exists() { exchange.rename(&fresh, &place) } else { Ok(()) }
        });
        moved.map_err(|error| match exchange.undo() {
            Ok(()) => error,
            Err(second) => {
                let kept = aside.keep();
                io::Error::other(format!("{error}; then {second}: the former files are in {}", kept.display()))
            }
        })
    }
}

/// The owned names in a folder.
fn names_in(folder: &Path, owned: &Owned) -> io::Result<Vec<String>> {
    let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    names.filter(|name| name.as_ref().map_or(true, |name| owned.file(name) || owned.folder(name))).collect()
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
