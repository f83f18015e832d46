//! One run at a time writes a folder.
//!
//! A file beside the folder, `.truepath-NAME.lock`, is locked by the run and names it; the system unlocks it when the
//! process ends, however it ends, so what a dead one left stops nobody. The run removes the file when it is done.
//! Limits: processes of one machine; a file system that knows no locks is written without one.

use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::codes::F004;
use crate::diagnostics::InputError;
use crate::interruption::{Hold, Kind, Temporary};

/// The right to write a folder; it ends with the value.
#[derive(Debug)]
pub(super) struct Lock {
    file: File,
    place: PathBuf,
    _temporary: Arc<Temporary>,
}

impl Lock {
    /// Takes it for `target`, whether that exists or not, in the folder `above`, which does.
    ///
    /// # Errors
    /// `F004` when another run has it, `F002` when the place cannot be written to.
    pub(super) fn take(target: &Path, above: &Path, hold: &mut Hold) -> Result<Self, InputError> {
        let name = |path: &Path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            format!(".truepath-{name}.lock")
        };
        // The same for every way to name a folder.
        let whole = fs::canonicalize(target)
            .or_else(|_| fs::canonicalize(above).map(|above| above.join(target.file_name().unwrap_or_default())));
        let whole = whole.map_err(|error| InputError::unwritable(target, &error))?;
        let beside = above.join(name(target));
        let mut place = whole.parent().unwrap_or(&whole).join(name(&whole));
        loop {
            let opened = File::options().read(true).write(true).create(true).truncate(false).open(&place);
            let mut file = match opened {
                Ok(file) => file,
                // The target is a link to a folder in one that is not ours.
                Err(_) if target.is_symlink() && place != beside => {
                    place.clone_from(&beside);
                    continue;
                }
                Err(error) => return Err(InputError::unwritable(&place, &error)),
            };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(held(target, &mut file)),
                // A file system without locks.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // The run before may have removed it between the two; then somebody else can lock a new one.
            if !same_file::Handle::from_path(&place).is_ok_and(|there| is(&file, &there)) {
                continue;
            }
            let words: Vec<_> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
            let text = format!("{}\n{}\n", std::process::id(), words.join(" "));
            let written = file.set_len(0).and_then(|()| file.write_all(text.as_bytes()));
            written.map_err(|error| InputError::unwritable(&place, &error))?;
            let temporary = hold.removes(&place, Kind::File);
            return Ok(Self { file, place, _temporary: temporary });
        }
    }
}

fn is(file: &File, there: &same_file::Handle) -> bool {
    file.try_clone().and_then(same_file::Handle::from_file).is_ok_and(|own| own == *there)
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Removed before it is unlocked: whoever waited for it sees that it is gone. Litter stops nobody.
        let _ = fs::remove_file(&self.place);
        let _ = self.file.unlock();
    }
}

/// Says who has it.
fn held(target: &Path, file: &mut File) -> InputError {
    let mut text = String::new();
    // Where a locked file cannot be read the run stays unnamed.
    let _ = file.rewind().and_then(|()| file.read_to_string(&mut text));
    let mut lines = text.lines();
    let run = match (lines.next(), lines.next()) {
        (Some(number), Some(words)) => format!("process {number} (`{words}`)"),
        _ => "another run".to_owned(),
    };
    let found = format!("{} is being written by {run}", target.display());
    F004.error(found, "a folder that no other run writes").in_file(target)
}
