//! The history of a folder, and the correction beside it: the one that `learn` goes on from, and the one that `correct` is
//! about to replace.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_correction::codes::{Q001, Q004};
use truepath_correction::learning::{History, Part, WrittenFile, refuse_corrected};
use truepath_correction::plan::history::PlanHistory;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::correction_files::{HISTORY, contour_folder, contour_name};
use super::plan_files::{PLAN_HISTORY, PROGRAM};

/// Reads the history of a folder, and makes sure that the correction beside it, or in the folder `base` of all contours, is
/// the one it tells of.
pub(super) fn history_in(folder: &FilePath, base: &FilePath) -> Result<History, InputError> {
    let place = folder.join(HISTORY);
    if !files::exists(&place) {
        let found = format!("{} holds no {HISTORY}", folder.display());
        let help = "name the folder that truepath correct or truepath learn wrote the correction of this part into; a second pass of truepath split has no next part";
        return Err(InputError::new(Q001, found, "a folder with a correction and its history", help).in_file(folder));
    }
    let history = History::read(&Source::read(&place)?)?;
    refuse_changed(&history.next.files, HISTORY, folder, base)?;
    Ok(history)
}

/// Whether a folder holds planned passes, of one contour or of several.
pub(super) fn holds_planned(folder: &FilePath) -> bool {
    files::exists(&folder.join(PLAN_HISTORY)) || files::exists(&folder.join(PROGRAM))
}

/// The contours of planned passes.
pub(super) struct PlannedContours {
    /// Those with a history.
    pub(super) cuts: Vec<(Pass, PlanHistory)>,
    /// Whether there is a folder for each.
    pub(super) several: bool,
    /// Names of those that were left as they are.
    pub(super) left: Vec<String>,
}

/// Reads the histories of planned parts of a folder, and makes sure that the program beside them is the one they tell of.
///
/// # Errors
/// `Q001` where there is none, or `--feature` names one contour of several; `Q004` for another program.
pub(super) fn planned_in(folder: &FilePath, job: JobFile) -> Result<PlannedContours, Failure> {
    let several = !files::exists(&folder.join(PLAN_HISTORY));
    let (mut cuts, mut left) = (Vec::new(), Vec::new());
    let feature = job.which.feature.clone();
    for pass in if several { Pass::every(job)? } else { vec![Pass::read(job)?] } {
        let own = if several { folder.join(contour_folder(&pass)) } else { folder.to_owned() };
        if !files::exists(&own.join(PLAN_HISTORY)) {
            left.push(contour_name(&pass));
            continue;
        }
        let history = PlanHistory::read(&Source::read(&own.join(PLAN_HISTORY))?)?;
        refuse_changed(&history.next.files, PLAN_HISTORY, folder, folder)?;
        let level = history.facts.level().filter(|_| pass.job.which.pass.is_none() && pass.plan.is_some());
        let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass);
        cuts.push((pass.cut_with(history.cut_with()), history));
    }
    let refused = |found: String, expected: &str, help: &str| {
        Err(InputError::new(Q001, found, expected, help).in_file(folder).into())
    };
    if let Some(feature) = feature.filter(|_| several && !cuts.is_empty()) {
        let found = format!("--feature {feature}, and {} holds planned passes of several contours", folder.display());
        let help = "leave --feature out: one program cuts them all, and one machine is learned from the points of all";
        return refused(found, "all contours of the part", help);
    }
    if cuts.is_empty() {
        let found = format!("{} holds planned passes and no {PLAN_HISTORY}", folder.display());
        let help = "write a choice of the program's own cutter with truepath plan --write and learn from its part; truepath inspect judges this one";
        return refused(found, "planned passes of the program's own cutter with their history", help);
    }
    Ok(PlannedContours { cuts, several, left })
}

/// Makes sure that the files that a history tells of lie in its folder or in the folder `base` of all contours, unchanged.
fn refuse_changed(files: &[WrittenFile], history: &str, folder: &FilePath, base: &FilePath) -> Result<(), InputError> {
    let mut held = 0;
    for file in files {
        let places = [folder.join(&file.name), base.join(&file.name)];
        let Some((place, bytes)) = places.into_iter().find_map(|p| files::read(&p).ok().map(|bytes| (p, bytes))) else {
            continue;
        };
        held += 1;
        let crc = format!("{:08x}", crc32(&bytes));
        if crc != file.crc32 {
            let found = format!("{} has the CRC-32 {crc}", place.display());
            let expected = format!("{}, as {history} says of the correction it was cut with", file.crc32);
            return Err(Q004.error(found, expected).in_file(&place));
        }
    }
    if held == 0 {
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        let found = format!("{} does not hold the correction", folder.display());
        let help = "name the folder as truepath wrote it";
        return Err(InputError::new(Q004, found, names.join(" or "), help).in_file(folder));
    }
    Ok(())
}

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
    if !files::exists(place) || pass.job.feed.is_some() {
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
