//! `learn`: from the probe file of a part that was cut with a correction to the correction of the next part.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_core::correct::Law;
use truepath_core::job::LawName;

use super::as_milled::{AsMilled, WholeContour};
use super::correct::{Corrected, design};
use super::correction_files::{FILES, HISTORY, MILLED, write};
use super::page::{REPORT, learned};
use super::remarks::Remarks;
use crate::correction::{Identified, Wish};
use crate::diagnostics::{Failure, InputError, Source};
use crate::job::{Job, ProbeFlags, Route, Which};
use crate::learning::{History, MOST_PARTS, Part, PartPoints, Update, Verdict, update};
use crate::measurement::Measurement;
use crate::output::OutputFolder;
use crate::pass::{Pass, PathBuffer};
use crate::report::page::render;
use crate::report::{CorrectSummary, correction_csv, json};

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

/// The correction of the next part.
#[derive(Clone, Debug)]
pub struct Learned {
    /// The correction, as `correct` gives it.
    pub corrected: Corrected,
    /// The history with one part more.
    pub history: History,
    /// How the part came out, and what was made of it.
    pub verdict: Verdict,
}

/// Summary of `learn`: that of `correct`, and the verdict on the part.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LearnSummary {
    /// Of the correction for the next part.
    #[serde(flatten)]
    pub correct: CorrectSummary,
    /// Of the part that was measured.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// The part that was measured, along the whole contour, as the model of all parts has it.
    pub whole_contour_error_mm: WholeContour,
}

/// Learns from the part that was cut with the history's correction, in memory, for one or both routes.
///
/// # Errors
/// A history of another cut, a measurement it already holds or of a part without its correction, and what [`correct`](super::correct::correct) refuses.
pub fn learn(
    pass: &Pass,
    history: &History,
    measurement: &Measurement,
    remarks: &[String],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Learned, Failure> {
    history.facts.agree(pass)?;
    refuse_other_laws(pass)?;
    refuse_feeds(pass)?;
    let mut part = Part::new(history.next_number(), measurement, Some(history.next.correction.clone()))?;
    history.refuse_known(&part)?;
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let of = |part: &Part| {
        PartPoints::of(part, &sampled).ok_or_else(|| {
            let found = format!("the correction of part {} does not lie along this contour", part.number);
            let help = "correct again with truepath correct, and learn from there";
            InputError::new("Q002", found, format!("one entry for each of {} samples", sampled.count()), help)
        })
    };
    let parts: Vec<PartPoints> = history.parts.iter().filter(|p| !p.set_aside).map(of).collect::<Result<_, _>>()?;
    let newest = of(&part)?;
    let Update { joint, residual, residual_sigma, kept, set_aside, verdict } =
        update(pass, &sampled, parts, newest, &history.next.promised(), &mut |share| progress(0.5 * share))?;
    part.set_aside = set_aside;
    let observations = joint.observations.last().cloned().unwrap_or_default();
    let identified = Identified { core: joint.core, observations };
    let wish = Wish { law: Law::Model, residual: &residual, residual_sigma: &residual_sigma, kept: kept.as_deref() };
    let mut texts = remarks.to_vec();
    texts.extend_from_slice(verdict.remarks());
    if let Some(oldest) = history.parts.first().filter(|_| history.parts.len() >= MOST_PARTS) {
        texts.push(format!("part {} is dropped from the history, which keeps {MOST_PARTS} parts", oldest.number));
    }
    let texts = Remarks::of(measurement, &texts);
    let later = &mut |share| progress(0.5 + 0.5 * share);
    let corrected = design(pass, &sampled, identified, &wish, texts, routes, later)?;
    let history = history.with(part, &corrected);
    Ok(Learned { corrected, history, verdict })
}

/// The papers' laws are made from one measurement and know nothing of a second.
fn refuse_other_laws(pass: &Pass) -> Result<(), InputError> {
    let name = match pass.job.numbers.correct.law {
        LawName::Model => return Ok(()),
        LawName::Mirror => "mirror",
        LawName::Paper => "paper",
    };
    let found = format!("correct.law is \"{name}\"");
    let error = InputError::new("Q006", found, "a law that can learn", "set law = \"model\", or leave it out");
    Err(error.at(pass.job.source(), pass.job.span("correct.law")))
}

/// The fit over parts takes every part as cut at the feeds of the program.
pub(super) fn refuse_feeds(pass: &Pass) -> Result<(), InputError> {
    if pass.job.feed.is_none() {
        return Ok(());
    }
    let help = "learn without [feed], or correct the next part anew with truepath correct";
    let error = InputError::new("Q006", "[feed] is given", "parts that are all cut at the feeds of the program", help);
    Err(error.at(pass.job.source(), pass.job.span("feed")))
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
        Failure::Input(error) if matches!(error.code(), "Q003" | "Q007") => error.in_file(options.probe).into(),
        Failure::Input(error) if error.code() == "Q002" && error.line_column().is_none() => {
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
        return Err(InputError::new("Q001", found, "a folder with a correction and its history", help).in_file(folder));
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
            return Err(InputError::new("Q004", found, expected, help).in_file(&place));
        }
    }
    if held == 0 {
        let names: Vec<&str> = history.next.files.iter().map(|file| file.name.as_str()).collect();
        let found = format!("{} does not hold the correction", folder.display());
        let help = "name the folder as truepath correct or truepath learn left it";
        return Err(InputError::new("Q004", found, names.join(" or "), help).in_file(folder));
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
    Err(InputError::new("Q005", found, "two folders", help).in_file(options.out))
}
