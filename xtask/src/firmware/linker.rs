//! A linker for the firmware and for WebAssembly: the one that came with the compiler, else Debian's lld under the name rustc looks for.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::repository::{may_install, target};
use crate::step::Failure;
use crate::toolchain::{Toolchain, install};

/// What rustc calls it.
const NAME: &str = "rust-lld";

/// Lets a command of cargo find a linker.
///
/// # Errors
/// There is none and none may be installed.
pub fn provide(toolchain: &Toolchain, command: &mut Command) -> Result<(), Failure> {
    if matches!(toolchain, Toolchain::Own) {
        return Ok(());
    }
    let folder = target().join("firmware/tools");
    let said = |e: std::io::Error| Failure::found(format!("{}: {e}", folder.display()));
    std::fs::create_dir_all(&folder).map_err(said)?;
    let link = folder.join(NAME);
    let found = lld()?;
    if std::fs::read_link(&link).ok().as_deref() != Some(&found) {
        let _ = std::fs::remove_file(&link);
        symlink(&found, &link).map_err(said)?;
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(folder.clone()).chain(std::env::split_paths(&path));
    let path = std::env::join_paths(folders).map_err(|e| Failure::found(e.to_string()))?;
    command.env("PATH", path);
    Ok(())
}

/// Debian's lld, the newest.
fn lld() -> Result<PathBuf, Failure> {
    let newest = || newest(Path::new("/usr/bin").read_dir().ok()?.flatten().map(|f| f.path()));
    let package = "lld-22";
    if let Some(found) = newest() {
        return Ok(found);
    }
    if may_install()
        && (install(&[package]).is_ok() || install(&["lld"]).is_ok())
        && let Some(found) = newest()
    {
        return Ok(found);
    }
    Err(Failure::Missing(format!("no linker for this target: apt-get install {package}")))
}

/// Of files named `lld-NN` the one with the greatest number.
fn newest(files: impl Iterator<Item = PathBuf>) -> Option<PathBuf> {
    let number = |file: &PathBuf| file.file_name()?.to_str()?.strip_prefix("lld-")?.parse::<u32>().ok();
    files.filter_map(|file| Some((number(&file)?, file))).max().map(|(_, file)| file)
}

#[cfg(unix)]
fn symlink(original: &Path, link: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(original, link)
}

#[cfg(not(unix))]
fn symlink(original: &Path, link: &Path) -> std::io::Result<()> {
    std::fs::copy(original, link).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_of_several_linkers_is_taken_and_other_programs_are_not() {
        let files = ["/b/lld-9", "/b/lld-22", "/b/lld-link-23", "/b/ld.lld-24", "/b/lld"].map(PathBuf::from);
        assert_eq!(newest(files.into_iter()), Some(PathBuf::from("/b/lld-22")));
        assert_eq!(newest(std::iter::empty()), None);
    }
}
