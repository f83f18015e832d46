//! The history of a folder and the correction beside it.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_correction::codes::{Q001, Q004};
use truepath_correction::learning::History;
use truepath_ground::diagnostics::{InputError, Source};

use super::super::correction_files::HISTORY;

/// Reads the history of a folder, and makes sure that the correction beside it, or in the folder `base` of all contours, is
/// the one it tells of.
pub(in super::super) fn history_in(folder: &FilePath, base: &FilePath) -> Result<History, InputError> {
    let place = folder.join(HISTORY);
    if !place.exists() {
        let found = format!("{} holds no {HISTORY}", folder.display());
        let help = "name the folder that truepath correct or truepath learn wrote the correction of this part into; a second pass of truepath split has no next part";
        return Err(InputError::new(Q001, found, "a folder with a correction and its history", help).in_file(folder));
    }
    let history = History::read(&Source::read(&place)?)?;
    let mut held = 0;
    for file in &history.next.files {
        let places = [folder.join(&file.name), base.join(&file.name)];
        let Some((place, bytes)) = places.into_iter().find_map(|p| std::fs::read(&p).ok().map(|bytes| (p, bytes)))
        else {
            continue;
        };
        held += 1;
        let crc = format!("{:08x}", crc32(&bytes));
        if crc != file.crc32 {
            let found = format!("{} has the CRC-32 {crc}", place.display());
            let expected = format!("{}, as {HISTORY} says of the correction it was cut with", file.crc32);
            return Err(Q004.error(found, expected).in_file(&place));
        }
    }
    if held == 0 {
        let names: Vec<&str> = history.next.files.iter().map(|file| file.name.as_str()).collect();
        let found = format!("{} does not hold the correction", folder.display());
        let help = "name the folder as truepath correct or truepath learn left it";
        return Err(InputError::new(Q004, found, names.join(" or "), help).in_file(folder));
    }
    Ok(history)
}
