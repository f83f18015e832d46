//! Files of the system.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// A file that is read from its beginning on.
pub type Opened = fs::File;

/// The bytes of a file.
///
/// # Errors
/// What the system says.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    fs::read(path)
}

/// Opens a file to be read.
///
/// # Errors
/// What the system says.
pub fn open(path: &Path) -> io::Result<Opened> {
    fs::File::open(path)
}

/// Whether there is a file or a folder.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// Whether it is a file.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Whether it is a folder.
pub fn is_dir(path: &Path) -> bool {
    path.is_dir()
}

/// Whether it is a folder with something in it.
pub fn is_occupied(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some())
}

/// Bytes of a file.
///
/// # Errors
/// What the system says.
pub fn length(path: &Path) -> io::Result<u64> {
    fs::metadata(path).map(|found| found.len())
}

/// The one name of a file or folder that exists.
///
/// # Errors
/// What the system says.
pub fn canonical(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path)
}

/// What lies in a folder, in no order; what cannot be told is left out.
///
/// # Errors
/// What the system says.
pub fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    Ok(fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path())).collect())
}
