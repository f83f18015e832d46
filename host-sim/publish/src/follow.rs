//! A folder that `truepath batch` writes again and again.
//!
//! Files are replaced whole, so a change shows in the time, the length or the number of the file. What cannot be read is
//! told once and tried again at every look: a copy over a network may be half there.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use truepath_ground::codes::C001;
use truepath_ground::diagnostics::InputError;

use crate::codes::Q013;
use crate::summary::Summary;

/// Folders at most.
const MOST: usize = 64;
/// Bytes of a summary at most: ten thousand parts of a hundred places.
const LONGEST: u64 = 256 << 20;

/// A folder that is followed.
#[derive(Debug)]
pub struct Followed {
    /// What its batch is called in messages.
    pub name: String,
    file: PathBuf,
    /// The file that was read last.
    stamp: Option<Stamp>,
    /// The code of what was said of it.
    said: Option<String>,
    looked: bool,
    there_at_start: bool,
}

/// What tells a file from the one that it replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stamp {
    modified: SystemTime,
    length: u64,
    number: u64,
}

impl Stamp {
    fn of(data: &Metadata) -> Self {
        #[cfg(unix)]
        let number = std::os::unix::fs::MetadataExt::ino(data);
        #[cfg(not(unix))]
        let number = 0;
        Self { modified: data.modified().unwrap_or(SystemTime::UNIX_EPOCH), length: data.len(), number }
    }
}

/// What a look found.
#[derive(Debug)]
pub enum Looked {
    /// As before.
    Same,
    /// Another summary, and when it was written.
    Changed(Box<Summary>, SystemTime),
    /// Something that cannot be read; said once.
    Unreadable(InputError),
}

impl Followed {
    /// Folders by the names of their last parts, or whole where these are not different.
    ///
    /// # Errors
    /// `C001` where one is named twice, or more than 64.
    pub fn every(folders: &[PathBuf]) -> Result<Vec<Self>, InputError> {
        let wrong = |found: String| Err(C001.error(found, "folders of truepath batch, each once"));
        if folders.len() > MOST {
            return wrong(format!("{} folders", folders.len()));
        }
        let whole = |folder: &Path| fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
        let wholes: Vec<PathBuf> = folders.iter().map(|folder| whole(folder)).collect();
        let last = |folder: &Path| folder.file_name().map(|name| name.to_string_lossy().into_owned());
        let mut all = Vec::new();
        for (at, folder) in wholes.iter().enumerate() {
            if wholes[..at].contains(folder) {
                return wrong(format!("{} is named twice", folders[at].display()));
            }
            let alone = wholes.iter().filter(|other| last(other) == last(folder)).count() == 1;
            let name = last(folder).filter(|_| alone).unwrap_or_else(|| folders[at].display().to_string());
            let file = folders[at].join("summary.json");
            all.push(Self { name, file, stamp: None, said: None, looked: false, there_at_start: false });
        }
        Ok(all)
    }

    /// Whether there was a summary at the first look.
    pub fn was_there_at_start(&self) -> bool {
        self.there_at_start
    }

    /// Looks at the file.
    pub fn look(&mut self) -> Looked {
        let data = fs::metadata(&self.file);
        if !std::mem::replace(&mut self.looked, true) {
            self.there_at_start = data.is_ok();
        }
        let stamp = data.as_ref().ok().map(Stamp::of);
        if stamp.is_some() && stamp == self.stamp {
            return Looked::Same;
        }
        match data.map_err(|e| InputError::unreadable(&self.file, &e)).and_then(|data| self.read(&data)) {
            Ok(summary) => {
                (self.stamp, self.said) = (stamp, None);
                Looked::Changed(Box::new(summary), stamp.map_or(SystemTime::UNIX_EPOCH, |stamp| stamp.modified))
            }
            Err(error) => {
                self.stamp = None;
                // Of one kind: where a file that grows breaks off is another place every time.
                let code = Some(error.code().to_owned());
                if self.said == code {
                    return Looked::Same;
                }
                self.said = code;
                Looked::Unreadable(error)
            }
        }
    }

    fn read(&self, data: &Metadata) -> Result<Summary, InputError> {
        if data.len() > LONGEST {
            let found = format!("{} has {} bytes", self.file.display(), data.len());
            return Err(Q013.error(found, "at most 256 MiB").in_file(&self.file));
        }
        let bytes = fs::read(&self.file).map_err(|e| InputError::unreadable(&self.file, &e))?;
        Summary::parse(&bytes, &self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folders: &[&str]) -> Vec<String> {
        let folders: Vec<PathBuf> = folders.iter().map(PathBuf::from).collect();
        Followed::every(&folders).expect("folders").into_iter().map(|followed| followed.name).collect()
    }

    #[test]
    fn batches_are_named_by_their_folders_and_by_the_whole_way_where_two_end_alike() {
        assert_eq!(names(&["/none/corner/batch", "/none/pocket"]), ["batch", "pocket"]);
        assert_eq!(names(&["/none/a/batch", "/none/b/batch", "/none/c"]), ["/none/a/batch", "/none/b/batch", "c"]);
        let twice = Followed::every(&["/none/a".into(), "/none/a".into()]);
        assert!(twice.is_err_and(|error| error.code() == "C001"));
    }

    #[test]
    fn what_cannot_be_read_is_said_once_until_it_can_be_read_again() {
        let place = tempfile::tempdir().expect("a folder");
        let file = place.path().join("summary.json");
        let mut followed = Followed::every(&[place.path().to_owned()]).expect("a folder").remove(0);
        let code = |looked: Looked| match looked {
            Looked::Unreadable(error) => error.code().to_owned(),
            other => format!("{other:?}").chars().take(7).collect(),
        };
        assert_eq!((code(followed.look()), code(followed.look())), ("F001".to_owned(), "Same".to_owned()));
        fs::write(&file, "{").expect("written");
        assert_eq!((code(followed.look()), code(followed.look())), ("Q013".to_owned(), "Same".to_owned()));
        fs::write(&file, "{\"touched\": 1,").expect("written");
        assert_eq!(code(followed.look()), "Same");
        let whole = r#"{"touched":1,"noise_mm":0.002,"states":[{"part":1,"force_level":{"value":0,"sigma":0.1},
            "radius_lost_mm":{"value":0,"sigma":0.01},"datum_mm":[{"value":0,"sigma":0},{"value":0,"sigma":0}],
            "readings":1,"wild":0,"step":false}],"wear_per_part":{"value":0,"sigma":0.1},"places":[],"alarms":[]}"#;
        fs::write(&file, whole).expect("written");
        assert_eq!((code(followed.look()), code(followed.look())), ("Changed".to_owned(), "Same".to_owned()));
        fs::write(&file, whole.replace("\"states\":[", "\"states\":[],\"o\":[")).expect("written");
        assert_eq!(code(followed.look()), "Q013");
        assert!(!followed.was_there_at_start());
    }
}
