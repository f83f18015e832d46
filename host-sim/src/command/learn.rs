//! `learn`: from the probe file of a part that was cut with a correction to the correction of the next part.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_correction::as_milled::AsMilled;
use truepath_correction::codes::{Q001, Q002, Q003, Q004, Q005, Q007};
use truepath_correction::learn::{LearnSummary, learn};
use truepath_correction::learning::History;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{Job, ProbeFlags, Route, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::correction_csv;
use truepath_report::page::render;
use truepath_report::pages::{REPORT, learned};

use super::correction_files::{FILES, HISTORY, MILLED, write};

/// What is learned from.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// The probe file of the part cut with the correction in `from`.
    pub probe: &'a FilePath,
    /// The folder of that correction.
    pub from: &'a FilePath,
    /// Output folder.
    pub out: &'a FilePath,
    /// Replace existing files.
    pub force: bool,
    /// `--route`, over that of the job.
    pub route: Option<Route>,
    /// What the command line says of the probe file.
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    pub which: Which,
}

/// Learns and writes the outputs.
///
/// # Errors
/// As [`learn`], a folder without a history or with another corrected program, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<LearnSummary, Failure> {
    refuse_same_folder(options)?;
    let history = history_in(options.from)?;
    let mut job = Job::read(options.job)?;
    job.override_probe(&options.probe_flags)?;
    job.which = options.which.clone();
    let pass = Pass::read(job)?;
    let level = history.facts.level().filter(|_| options.which.pass.is_none() && pass.plan.is_some());
    let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass).cut_with(history.cut_with());
    let file = Source::read(options.probe)?;
    let measurement = Measurement::read(&pass, &file)?;
    let folder = OutputFolder::create(options.out, options.force, FILES)?;
    let remarks = measurement.remarks(&file);
    let routes = [options.route.unwrap_or(pass.job.route)];
    let done = learn(&pass, &history, &measurement, &remarks, &routes, progress).map_err(|failure| match failure {
        Failure::Input(error) if [Q003.code, Q007.code].contains(&error.code()) => error.in_file(options.probe).into(),
        Failure::Input(error) if error.code() == Q002.code && error.line_column().is_none() => {
            error.in_file(&options.from.join(HISTORY)).into()
        }
        failure => failure,
    })?;
    let milled = AsMilled::of(&pass, &history, &done.corrected)?;
    let summary = LearnSummary {
        correct: done.corrected.summary.clone(),
        verdict: done.verdict,
        whole_contour_error_mm: milled.whole_contour(),
    };
    let page = learned(&pass, &measurement, &done.corrected, &milled, &summary)?;
    folder.write("probe-raw.txt", file.bytes())?;
    folder.write("summary.json", &json(&summary)?)?;
    folder.write(HISTORY, &done.history.text()?)?;
    write(&folder, &pass, &measurement, &done.corrected)?;
    folder.write(MILLED, &correction_csv(&milled.rows)?)?;
    folder.write(REPORT, &render(&page)?)?;
    folder.commit()?;
    Ok(summary)
}

/// Reads the history of a folder, and makes sure that the correction beside it is the one it tells of.
pub(super) fn history_in(folder: &FilePath) -> Result<History, InputError> {
    let place = folder.join(HISTORY);
    if !place.exists() {
        let found = format!("{} holds no {HISTORY}", folder.display());
        let help = "name the folder that truepath correct or truepath learn wrote the correction of this part into; a second pass of truepath split has no next part";
        return Err(InputError::new(Q001, found, "a folder with a correction and its history", help).in_file(folder));
    }
    let history = History::read(&Source::read(&place)?)?;
    let mut held = 0;
    for file in &history.next.files {
        let place = folder.join(&file.name);
        let Ok(bytes) = std::fs::read(&place) else { continue };
        held += 1;
        let crc = format!("{:08x}", crc32(&bytes));
        if crc != file.crc32 {
            let found = format!("{} has the CRC-32 {crc}", place.display());
            let expected = format!("{}, as {HISTORY} says of the correction it was cut with", file.crc32);
            let help = "the part must be cut with the correction of this folder, unchanged; put the file back, or correct again";
            return Err(InputError::new(Q004, found, expected, help).in_file(&place));
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

/// The old correction must outlive the new one: it is what the measured part was cut with.
fn refuse_same_folder(options: &Options) -> Result<(), InputError> {
    let same = match (options.from.canonicalize(), options.out.canonicalize()) {
        (Ok(from), Ok(out)) => from == out,
        _ => options.from == options.out,
    };
    if !same {
        return Ok(());
    }
    let found = format!("--from and -o are both {}", options.from.display());
    let help = "name another folder with -o: the correction of each part is kept";
    Err(InputError::new(Q005, found, "two folders", help).in_file(options.out))
}
