//! Outputs in memory: kept apart until they are complete, then put into the tree of files.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::owned::{Owned, of_another_kind};
#[cfg(target_family = "wasm")]
use crate::diagnostics::InputError;
use crate::files::in_memory::Tree;
#[cfg(target_family = "wasm")]
use crate::files::in_memory::here::tree;

/// A file on its way.
#[derive(Debug, Default)]
pub(super) struct StagedFile(Vec<u8>);

impl StagedFile {
    /// Puts it into a tree, over what is there only where it `replaces`.
    ///
    /// # Errors
    /// `AlreadyExists` where it may not replace what is there, and as [`Tree::write`].
    fn commit_to(self, tree: &mut Tree, target: &Path, replaces: bool) -> io::Result<()> {
        if tree.exists(target) && !replaces {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        tree.write(target, self.0)
    }
}

#[cfg(target_family = "wasm")]
impl StagedFile {
    /// One without bytes.
    pub(super) fn create(_target: &Path) -> Result<Self, InputError> {
        Ok(Self::default())
    }
    /// Puts it into the tree of this program.
    pub(super) fn commit(self, target: &Path, replaces: bool) -> io::Result<()> {
        self.commit_to(&mut tree(), target, replaces)
    }
}

impl Write for StagedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Files by their names in the folder.
type Files = BTreeMap<String, Vec<u8>>;

/// A folder on its way.
#[derive(Debug, Default)]
pub(super) struct StagedFolder(Arc<Mutex<Files>>);

/// An output that is written piece by piece.
#[derive(Debug)]
pub struct Stream {
    name: String,
    files: Arc<Mutex<Files>>,
}

fn locked(files: &Mutex<Files>) -> MutexGuard<'_, Files> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
}

impl StagedFolder {
    /// Writes a file.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        locked(&self.0).insert(name.to_owned(), bytes.to_vec());
        Ok(())
    }

    /// Opens a file that was written, to go on at its end.
    pub(super) fn stream(&self, name: &str) -> io::Result<Stream> {
        Ok(Stream { name: name.to_owned(), files: Arc::clone(&self.0) })
    }

    /// Puts the files into a tree; what is `owned` in the target and was not written goes.
    ///
    /// # Errors
    /// A name that is a folder there and a file here, or the other way round; the tree is then as it was.
    fn commit_to(self, tree: &mut Tree, target: &Path, owned: &Owned) -> io::Result<()> {
        let files = std::mem::take(&mut *locked(&self.0));
        if tree.exists(target) {
            let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let there = tree.entries(target)?;
            let there: Vec<_> =
                there.iter().filter(|path| owned.file(&name(path)) || owned.folder(&name(path))).collect();
            if let Some(path) = there.iter().find(|path| tree.is_dir(path) != owned.folder(&name(path))) {
                return Err(of_another_kind(&name(path), tree.is_dir(path)));
            }
            there.into_iter().for_each(|path| tree.remove(path));
        }
        tree.make_folder(target)?;
        files.into_iter().try_for_each(|(name, bytes)| tree.write(&target.join(name), bytes))
    }
}

#[cfg(target_family = "wasm")]
impl StagedFolder {
    /// One without files.
    pub(super) fn create(_target: &Path) -> Result<Self, InputError> {
        Ok(Self::default())
    }
    /// Puts the files into the tree of this program.
    pub(super) fn commit(self, target: &Path, owned: &Owned) -> io::Result<()> {
        self.commit_to(&mut tree(), target, owned)
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        locked(&self.files).entry(self.name.clone()).or_default().write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWNED: [&str; 3] = ["report.html", "contour-#.csv", "parts/"];

    fn written(tree: &mut Tree, files: &[&str]) -> io::Result<()> {
        let folder = StagedFolder::default();
        files.iter().try_for_each(|name| folder.write(name, name.as_bytes()))?;
        folder.commit_to(tree, Path::new("out"), &Owned::new(&OWNED))
    }

    fn names(tree: &Tree) -> Vec<String> {
        tree.files().map(|(path, _)| path.display().to_string()).collect()
    }

    #[test]
    fn a_second_run_replaces_its_own_files_and_leaves_others_alone() {
        let mut tree = Tree::new();
        tree.write(Path::new("out/notes.txt"), b"mine".to_vec()).expect("written");
        written(&mut tree, &["report.html", "contour-1.csv", "parts/a/b.csv"]).expect("written");
        assert_eq!(names(&tree), ["out/contour-1.csv", "out/notes.txt", "out/parts/a/b.csv", "out/report.html"]);
        written(&mut tree, &["report.html", "parts/c.csv"]).expect("written");
        assert_eq!(names(&tree), ["out/notes.txt", "out/parts/c.csv", "out/report.html"]);
    }

    #[test]
    fn a_folder_in_the_place_of_a_file_changes_nothing() {
        let mut tree = Tree::new();
        tree.write(Path::new("out/report.html/x"), b"x".to_vec()).expect("written");
        tree.write(Path::new("out/contour-1.csv"), b"old".to_vec()).expect("written");
        let error = written(&mut tree, &["report.html"]).unwrap_err();
        assert_eq!(error.to_string(), "report.html is a folder there");
        assert_eq!(names(&tree), ["out/contour-1.csv", "out/report.html/x"]);
    }

    #[test]
    fn a_table_is_written_piece_by_piece() {
        let (mut tree, folder) = (Tree::new(), StagedFolder::default());
        folder.write("contour-1.csv", b"").expect("written");
        let mut stream = folder.stream("contour-1.csv").expect("open");
        stream.write_all(b"a,").and_then(|()| stream.write_all(b"b")).expect("written");
        folder.commit_to(&mut tree, Path::new("out"), &Owned::new(&OWNED)).expect("written");
        assert_eq!(tree.read(Path::new("out/contour-1.csv")).expect("there"), b"a,b");
    }

    #[test]
    fn a_file_replaces_another_only_where_it_may() {
        let mut tree = Tree::new();
        let file = |text: &str| StagedFile(text.as_bytes().to_vec());
        file("1").commit_to(&mut tree, Path::new("a/job.toml"), false).expect("written");
        let refused = file("2").commit_to(&mut tree, Path::new("a/job.toml"), false).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        file("3").commit_to(&mut tree, Path::new("a/job.toml"), true).expect("written");
        assert_eq!(tree.read(Path::new("a/job.toml")).expect("there"), b"3");
    }
}
