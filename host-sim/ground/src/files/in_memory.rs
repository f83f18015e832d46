//! A tree of files in memory, and the one that a program without a file system works in.
//!
//! The working folder is the root, and `..` of the root is the root.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Folders and files by their whole names.
#[derive(Debug, Default)]
pub struct Tree {
    /// `None` is a folder. The root has no entry.
    nodes: BTreeMap<PathBuf, Option<Vec<u8>>>,
}

/// The name of a place from the root on, without `.` and `..`; the root is empty.
fn whole(path: &Path) -> PathBuf {
    let mut whole = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => whole.push(name),
            Component::ParentDir => drop(whole.pop()),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    whole
}

fn error(kind: io::ErrorKind, text: &str) -> io::Error {
    io::Error::new(kind, text)
}

/// In the words of a system with files, so that messages are the same.
fn not_found() -> io::Error {
    error(io::ErrorKind::NotFound, "No such file or directory (os error 2)")
}

fn is_a_folder() -> io::Error {
    error(io::ErrorKind::IsADirectory, "Is a directory (os error 21)")
}

fn is_a_file() -> io::Error {
    error(io::ErrorKind::NotADirectory, "Not a directory (os error 20)")
}

impl Tree {
    /// One without anything in it.
    pub const fn new() -> Self {
        Self { nodes: BTreeMap::new() }
    }

    /// Whether there is a file or a folder.
    pub fn exists(&self, path: &Path) -> bool {
        let whole = whole(path);
        whole.as_os_str().is_empty() || self.nodes.contains_key(&whole)
    }

    /// Whether it is a file.
    pub fn is_file(&self, path: &Path) -> bool {
        matches!(self.nodes.get(&whole(path)), Some(Some(_)))
    }

    /// Whether it is a folder.
    pub fn is_dir(&self, path: &Path) -> bool {
        self.exists(path) && !self.is_file(path)
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// `NotFound`, `IsADirectory`.
    pub fn read(&self, path: &Path) -> io::Result<&[u8]> {
        match self.nodes.get(&whole(path)) {
            Some(Some(bytes)) => Ok(bytes),
            _ if self.exists(path) => Err(is_a_folder()),
            _ => Err(not_found()),
        }
    }

    /// The one name of what is there.
    ///
    /// # Errors
    /// `NotFound`.
    pub fn canonical(&self, path: &Path) -> io::Result<PathBuf> {
        if self.exists(path) { Ok(Path::new("/").join(whole(path))) } else { Err(not_found()) }
    }

    /// What lies in a folder, by the name the folder was asked for.
    ///
    /// # Errors
    /// `NotFound`, `NotADirectory`.
    pub fn entries(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        if !self.exists(folder) {
            return Err(not_found());
        }
        if self.is_file(folder) {
            return Err(is_a_file());
        }
        let root = whole(folder);
        let inside = self.nodes.keys().filter(|path| path.parent() == Some(root.as_path()));
        Ok(inside.filter_map(|path| Some(folder.join(path.file_name()?))).collect())
    }

    /// Makes a folder with those above it.
    ///
    /// # Errors
    /// `NotADirectory` where one of them is a file.
    pub fn make_folder(&mut self, path: &Path) -> io::Result<()> {
        let whole = whole(path);
        if whole.ancestors().any(|above| self.is_file(above)) {
            return Err(is_a_file());
        }
        let missing = whole.ancestors().filter(|above| !above.as_os_str().is_empty());
        for folder in missing {
            self.nodes.entry(folder.to_owned()).or_default();
        }
        Ok(())
    }

    /// Writes a file, in place of what it held; folders above it are made.
    ///
    /// # Errors
    /// `IsADirectory`, `NotADirectory` where a folder above it is a file.
    pub fn write(&mut self, path: &Path, bytes: Vec<u8>) -> io::Result<()> {
        if self.is_dir(path) {
            return Err(is_a_folder());
        }
        let whole = whole(path);
        self.make_folder(whole.parent().unwrap_or(Path::new("")))?;
        self.nodes.insert(whole, Some(bytes));
        Ok(())
    }

    /// Removes a file, or a folder with all that is in it; nothing where nothing is.
    pub fn remove(&mut self, path: &Path) {
        let root = whole(path);
        self.nodes.retain(|path, _| !path.starts_with(&root));
    }

    /// Every file with its bytes, in the order of their names.
    pub fn files(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.nodes.iter().filter_map(|(path, bytes)| Some((path.as_path(), bytes.as_deref()?)))
    }
}

/// The tree of this program.
#[cfg(target_family = "wasm")]
pub mod here {
    use std::io::{self, Cursor};
    use std::path::{Path, PathBuf};
    use std::sync::{Mutex, MutexGuard, PoisonError};

    use super::Tree;

    static TREE: Mutex<Tree> = Mutex::new(Tree::new());

    /// The tree; it must not be taken twice by one thread.
    pub fn tree() -> MutexGuard<'static, Tree> {
        TREE.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A file that is read from its beginning on.
    pub type Opened = Cursor<Vec<u8>>;

    /// As [`Tree::read`].
    ///
    /// # Errors
    /// As there.
    pub fn read(path: &Path) -> io::Result<Vec<u8>> {
        tree().read(path).map(<[u8]>::to_vec)
    }

    /// Opens a file to be read.
    ///
    /// # Errors
    /// As [`Tree::read`].
    pub fn open(path: &Path) -> io::Result<Opened> {
        read(path).map(Cursor::new)
    }

    /// As [`Tree::exists`].
    pub fn exists(path: &Path) -> bool {
        tree().exists(path)
    }

    /// As [`Tree::is_file`].
    pub fn is_file(path: &Path) -> bool {
        tree().is_file(path)
    }

    /// As [`Tree::is_dir`].
    pub fn is_dir(path: &Path) -> bool {
        tree().is_dir(path)
    }

    /// Whether it is a folder with something in it.
    pub fn is_occupied(path: &Path) -> bool {
        entries(path).is_ok_and(|entries| !entries.is_empty())
    }

    /// Bytes of a file.
    ///
    /// # Errors
    /// As [`Tree::read`].
    pub fn length(path: &Path) -> io::Result<u64> {
        tree().read(path).map(|bytes| bytes.len() as u64)
    }

    /// As [`Tree::canonical`].
    ///
    /// # Errors
    /// As there.
    pub fn canonical(path: &Path) -> io::Result<PathBuf> {
        tree().canonical(path)
    }

    /// As [`Tree::entries`].
    ///
    /// # Errors
    /// As there.
    pub fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
        tree().entries(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree() -> Tree {
        let mut tree = Tree::new();
        tree.write(Path::new("a/b/c.nc"), b"G0".to_vec()).expect("written");
        tree.write(Path::new("./top.txt"), b"top".to_vec()).expect("written");
        tree
    }

    #[test]
    fn a_file_has_one_place_by_whatever_way_it_is_named() {
        let tree = tree();
        for name in ["a/b/c.nc", "./a/b/c.nc", "/a/b/c.nc", "a/x/../b/c.nc", "../a/b/c.nc"] {
            assert_eq!(tree.read(Path::new(name)).expect(name), b"G0");
            assert_eq!(tree.canonical(Path::new(name)).expect(name), Path::new("/a/b/c.nc"));
        }
        assert!(tree.is_dir(Path::new(".")) && tree.is_dir(Path::new("")) && tree.is_dir(Path::new("a/b")));
        assert!(!tree.exists(Path::new("a/c.nc")));
    }

    #[test]
    fn a_folder_lists_what_lies_in_it_and_nothing_deeper() {
        let tree = tree();
        let list = |folder: &str| tree.entries(Path::new(folder)).expect(folder);
        assert_eq!(list("."), [Path::new("./a"), Path::new("./top.txt")]);
        assert_eq!(list("a"), [Path::new("a/b")]);
        assert_eq!(tree.entries(Path::new("b")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(tree.entries(Path::new("top.txt")).unwrap_err().kind(), io::ErrorKind::NotADirectory);
    }

    #[test]
    fn a_file_is_no_folder_and_a_folder_no_file() {
        let mut tree = tree();
        assert_eq!(tree.read(Path::new("a")).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        assert_eq!(tree.write(Path::new("a/b"), vec![]).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        assert_eq!(tree.write(Path::new("top.txt/x"), vec![]).unwrap_err().kind(), io::ErrorKind::NotADirectory);
        tree.remove(Path::new("a/b"));
        assert!(tree.is_dir(Path::new("a")) && !tree.exists(Path::new("a/b/c.nc")));
        assert_eq!(tree.files().map(|(path, _)| path).collect::<Vec<_>>(), [Path::new("top.txt")]);
    }

    #[test]
    fn what_is_missing_is_told_as_a_system_tells_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let there = std::fs::read(folder.path().join("none")).unwrap_err();
        let here = Tree::new().read(Path::new("none")).map(<[u8]>::to_vec).unwrap_err();
        assert_eq!((here.kind(), here.to_string()), (there.kind(), there.to_string()));
    }
}
