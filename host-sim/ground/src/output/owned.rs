//! The names that a command may write in its folder of outputs.

use std::io;

/// Stands for files of any name.
pub(super) const EVERY: &str = "**";

/// The names that a command may write in a folder.
#[derive(Debug)]
pub(super) struct Owned(Vec<&'static str>);

impl Owned {
    /// These.
    pub(super) fn new(names: &[&'static str]) -> Self {
        Self(names.to_vec())
    }

    /// Whether a name is one of them, or begins with the owned folder it lies in.
    pub(super) fn file(&self, name: &str) -> bool {
        let stays_inside = !name.split('/').any(|part| matches!(part, "" | "." | ".."));
        if self.0 == [EVERY] {
            return stays_inside;
        }
        if let Some((folder, _)) = name.split_once('/') {
            return self.folder(folder) && stays_inside;
        }
        self.0.iter().any(|owned| match owned.split_once('#') {
            None if owned.starts_with('*') => name.contains(owned.trim_matches('*')),
            None => *owned == name,
            Some((before, after)) => {
                let number = name.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)).unwrap_or_default();
                number.bytes().all(|b| b.is_ascii_digit()) && number.bytes().next().is_some_and(|first| first != b'0')
            }
        })
    }

    /// Whether a name is one of the owned folders.
    pub(super) fn folder(&self, name: &str) -> bool {
        self.0.iter().any(|owned| owned.strip_suffix('/') == Some(name))
    }
}

/// The error of a name that stands for a folder where a file is to be written, or for a file where a folder is.
pub(super) fn of_another_kind(name: &str, is_folder: bool) -> io::Error {
    io::Error::other(format!("{name} is {} there", if is_folder { "a folder" } else { "a file" }))
}
