//! Subprograms in files beside a program: `pocket.ngc` for `o<pocket> call`, `O1234.nc` or `1234.ngc` for `M98 P1234`.
//!
//! Names are compared without regard to case. A file is read when it is first called; files named alike are taken in
//! alphabetical order. Only the folder of the program is searched, and files above [`LARGEST`] bytes are passed over.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use truepath_core::gcode::{Library, LibraryFile};

use crate::diagnostics::Source;
use crate::files;

/// The largest file that is called.
pub const LARGEST: u64 = 64 << 20;

/// Endings of programs.
const ENDINGS: [&str; 6] = ["ngc", "nc", "cnc", "tap", "gcode", "mpf"];

/// The programs of a folder.
#[derive(Debug, Default)]
pub struct Folder {
    files: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    /// Lower case, without the ending.
    stem: String,
    path: PathBuf,
    source: OnceCell<Option<Source>>,
}

impl Folder {
    /// The folder in which a program lies; empty when it cannot be listed.
    pub fn beside(program: &Path) -> Self {
        let folder = program.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut paths = files::entries(folder).unwrap_or_default();
        paths.retain(|path| is_program(path));
        paths.sort_unstable();
        paths.truncate(usize::from(u16::MAX) - 1);
        let entry = |path: PathBuf| {
            let stem = path.file_stem()?.to_str()?.to_lowercase();
            Some(Entry { stem, path, source: OnceCell::new() })
        };
        Self { files: paths.into_iter().filter_map(entry).collect() }
    }

    /// The file that events and errors name by a number; `None` for the program itself and for files never called.
    pub fn source(&self, number: u16) -> Option<&Source> {
        let entry = self.files.get(usize::from(number).checked_sub(1)?)?;
        entry.source.get()?.as_ref()
    }
}

impl Library for Folder {
    fn find(&self, name: &[u8]) -> Option<LibraryFile<'_>> {
        let name = std::str::from_utf8(name).ok()?;
        let index = self.files.iter().position(|file| is_named(&file.stem, name))?;
        let entry = &self.files[index];
        let source = entry.source.get_or_init(|| Source::read(&entry.path).ok()).as_ref()?;
        Some(LibraryFile { number: u16::try_from(index + 1).ok()?, text: source.bytes() })
    }
}

/// Whether a file is the subprogram: by name, or by number with or without O and zeros before it.
fn is_named(stem: &str, name: &str) -> bool {
    let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit()).then(|| text.parse::<u32>().ok()).flatten();
    let number = || digits(name).is_some_and(|n| digits(stem.strip_prefix('o').unwrap_or(stem)) == Some(n));
    stem == name || stem.strip_prefix('o') == Some(name) || number()
}

fn is_program(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_lowercase);
    ending.is_some_and(|e| ENDINGS.contains(&e.as_str()))
        && files::is_file(path)
        && files::length(path).is_ok_and(|length| length <= LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beside_the_program_are_found_by_name_and_by_number() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in [
            ("main.ngc", "M2"),
            ("Pocket.NGC", "o<pocket> sub"),
            ("O1234.nc", "M99"),
            ("7.tap", "G0"),
            ("o0042.nc", "M2"),
        ] {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        std::fs::write(folder.path().join("notes.txt"), "x").expect("written");
        let library = Folder::beside(&folder.path().join("main.ngc"));
        let text = |name: &[u8]| library.find(name).map(|file| file.text);
        assert_eq!(text(b"pocket"), Some(&b"o<pocket> sub"[..]));
        assert_eq!((text(b"1234"), text(b"7")), (Some(&b"M99"[..]), Some(&b"G0"[..])));
        assert_eq!((text(b"notes"), text(b"234")), (None, None));
        assert_eq!((text(b"42"), text(b"0042")), (Some(&b"M2"[..]), Some(&b"M2"[..])));
        let number = library.find(b"7").expect("found").number;
        assert!(library.source(number).is_some_and(|s| s.name().ends_with("7.tap")));
        assert!(library.source(0).is_none());
    }
}
