//! Points of a part that was cut with the correction which is about to be replaced.

use std::path::Path as FilePath;

use truepath_correction::learning::{History, Part, refuse_corrected};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

/// Refuses points that lie where the correction in the output folder leaves the wall.
///
/// `correct` takes what the points show for what no correction leaves. Given the points of a part that was already cut
/// with one, it would make a correction of what is left and put it in the place of the whole one: the next part would be
/// nearly as wrong as the first. The probe file may say so itself (`M038`); else the correction in the output folder is
/// what the points can be held against. Limit: in an empty folder, and with a file that says nothing, it cannot be known.
///
/// # Errors
/// `Q008` with both distances.
pub(super) fn refuse_replacing(
    place: &FilePath,
    probe: &FilePath,
    pass: &Pass,
    measurement: &Measurement,
) -> Result<(), Failure> {
    if !place.exists() || pass.job.feed.is_some() {
        return Ok(());
    }
    // What cannot be read, or is of another cut, says nothing about this part.
    let Ok(history) = Source::read(place).map_err(Failure::from).and_then(|file| Ok(History::read(&file)?)) else {
        return Ok(());
    };
    if history.facts.agree(pass).is_err() {
        return Ok(());
    }
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let part = Part::new(history.next_number(), measurement, None)?;
    refuse_corrected(pass, &path, &history, &part).map_err(|error| error.in_file(probe).into())
}
