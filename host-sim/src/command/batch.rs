//! `batch`: many parts of one job, touched one after the other: what moves, whether it holds, when to act.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use truepath_batch::batch::{Alarm, Batch, Cause, Request};
use truepath_batch::codes::{Q011, Q012};
use truepath_batch::series::{Event, Place, Reading, Series};
use truepath_core::probe::{CutWith, Rejected};
use truepath_ground::count::counted;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::{float, mm, rounded};
use truepath_job::job::{PartFlags, Said};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::batch::batch_page;
use truepath_report::read_correction;

use super::correction_files::{contour_name, contour_place};
use super::readings::Readings;
use crate::terminal::Terminal;

/// Files this command may write.
const FILES: &[&str] = &["batch.html", "summary.json"];
/// Parts of a batch at most.
const MOST: usize = 10_000;

/// Which batch.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// A table of the touched parts: part,probe,event, one line each, probe files named from its folder; events are cutter, lot and setup.
    #[arg(value_name = "PARTS.csv")]
    pub parts: PathBuf,
    /// Folder of the correction that the parts were cut with: how far the cutter is pushed where, so that the force level can be told.
    #[arg(long, value_name = "DIR")]
    pub from: Option<PathBuf>,
    /// Parts ahead for which the tolerance has to be held.
    #[arg(long, value_name = "PARTS", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=200))]
    pub ahead: u32,
    /// Folder for batch.html and summary.json.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
    /// What is said of the part in place of the job.
    #[command(flatten)]
    pub part: PartFlags,
    /// What is said in place of the job.
    #[command(flatten)]
    pub said: Said,
}

/// What came of it.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Report {
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// The batch.
    #[serde(flatten)]
    pub batch: Batch,
    /// The same in words, the most urgent first.
    pub words: Vec<String>,
    /// What to do about the most urgent alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
    /// The page.
    pub page: PathBuf,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// Follows a batch and prints how it stands; what asks for action ends with exit code 3.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let report = run(options)?;
    terminal.warn_all(&report.warnings);
    terminal.tell(&report, || words(&report))?;
    match report.batch.alarms.first() {
        None => Ok(()),
        Some(alarm) => {
            let expected = "a batch that goes on as it began, in tolerance";
            Err(Q011.error(alarm.words(report.unit), expected).by_judgement().into())
        }
    }
}

fn words(report: &Report) -> String {
    let batch = &report.batch;
    let mut text = format!("{} touched, {} to {}\n", counted(batch.touched, "part"), batch.parts[0], batch.parts[1]);
    for said in batch.words(report.unit) {
        text += &format!("{said}\n");
    }
    if let Some(share) = batch.next_in_tolerance {
        text += &format!(
            "the next part is in tolerance everywhere with at least {:.0} %\n",
            (100.0 * share).floor().min(99.0)
        );
    }
    text += &format!("written to {}\n", report.page.display());
    if let Some(next) = &report.next {
        text += &format!("next: {next}\n");
    }
    text
}

/// What to do about the most urgent alarm.
fn next(batch: &Batch, options: &Options) -> Option<String> {
    let from = options.from.as_ref().map_or_else(|| "DIR".to_owned(), |from| from.display().to_string());
    let job = options.job.display();
    batch.alarms.first().map(|alarm| match alarm {
        Alarm::Step { cause: Cause::Datum, .. } => "look at clamping, probe and work offset before the next part".to_owned(),
        Alarm::Step { cause: Cause::ForceLevel, .. } => {
            format!("if it is another lot or another cutter, correct anew from one uncorrected part; else truepath learn {job} --probe FILE --from {from} -o NEXT")
        }
        Alarm::Wild { .. } => "touch the part again at these places".to_owned(),
        _ => format!("put in a new cutter, or correct for what moved: truepath learn {job} --probe FILE --from {from} -o NEXT"),
    })
}

/// One line of the table.
struct Entry {
    line: u32,
    number: u32,
    probe: PathBuf,
    events: Vec<Event>,
}

/// Follows a batch.
///
/// # Errors
/// Whatever is wrong with job, table, probe files or the folder of the correction, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<Report, Failure> {
    let mut job = options.said.read(&options.job)?;
    job.override_part(&options.part)?;
    let tolerance = job.part.tolerance.map(|t| [mm(t.lower), mm(t.upper)]);
    let walls: Vec<Pass> = Pass::every(job)?.into_iter().map(|pass| pass.cut_with(CutWith::Anything)).collect();
    let several = walls.len() > 1;
    let mut warnings: Vec<Remark> = walls.iter().flat_map(|pass| pass.warnings.clone()).collect();
    let table = Source::read(&options.parts)?;
    let entries = entries(&table, options.parts.parent().unwrap_or(Path::new("")))?;
    let pushed = options.from.as_ref().map(|from| deflections(from, &walls, several, &mut warnings)).transpose()?;
    if pushed.is_none() {
        warnings.push("without --from DIR, the folder of the correction the parts were cut with, force level and cutter size cannot be told apart".into());
    }
    let folder = OutputFolder::create(&options.output, options.force, FILES)?;
    let mut series = Series::default();
    let mut noise: f64 = 0.0;
    // What happened before a part that nobody touched counts for the next one.
    let mut waiting: Vec<Event> = Vec::new();
    let milled = entries.last().map(|entry| entry.number);
    for entry in entries {
        waiting.extend(entry.events);
        if entry.probe.as_os_str().is_empty() {
            continue;
        }
        let measured = Readings::read(Some(&entry.probe), None)?.of_every(walls.clone())?;
        let mut readings = Vec::new();
        for (pass, measurement) in &measured {
            noise = noise.max(mm(measurement.noise));
            let aside = measurement.rejected.iter().filter(|aside| aside.reason != Rejected::Superseded).count();
            if aside > 0 && !measurement.contacts.is_empty() {
                warnings.push(
                    format!("part {}: {aside} readings are not of this wall; truepath inspect says why", entry.number)
                        .into(),
                );
            }
            readings.extend(of_wall(pass, measurement, several, pushed.as_ref()));
        }
        if readings.is_empty() {
            let found = format!("{} says nothing of a wall of this job", entry.probe.display());
            return Err(Q012.error(found, "touches of the wall").at(&table, table.line_span(entry.line)).into());
        }
        series.push(entry.number, std::mem::take(&mut waiting), readings);
    }
    series.milled =
        milled.filter(|number| series.parts.last().is_some_and(|last| last.number != *number)).map(|n| (n, waiting));
    // What a machine repeats to at best comes beside the probe.
    let request =
        Request { noise_mm: noise.hypot(0.001), tolerance_mm: tolerance, ahead: options.ahead, ..Request::default() };
    let batch = Batch::of(&series, &request)
        .ok_or_else(|| Q012.error("no part of the table was touched", "at least one line with a probe file"))
        .map_err(|error| error.at(&table, 0..0))?;
    let unit = walls.first().map(Pass::unit).unwrap_or_default();
    let name = walls.first().map_or_else(String::new, |pass| {
        pass.job.part.names.name.clone().unwrap_or_else(|| pass.program.name().to_owned())
    });
    folder.write("batch.html", batch_page(&batch, &name, unit)?.as_bytes())?;
    let (words, next) = (batch.words(Unit::Millimetre), next(&batch, options));
    let report = Report { unit, words, next, batch, page: options.output.join("batch.html"), warnings };
    folder.write("summary.json", &json(&report)?)?;
    folder.commit()?;
    Ok(report)
}

/// The readings of one wall of a part.
fn of_wall(
    pass: &Pass,
    measurement: &Measurement,
    several: bool,
    pushed: Option<&BTreeMap<String, Vec<(f64, f64)>>>,
) -> Vec<Reading> {
    let name = contour_name(pass);
    let depth = mm(pass.job.numbers.cut.axial_depth);
    let along = pushed.and_then(|all| all.get(&name));
    let readings = measurement.contacts.iter().map(|contact| {
        let s_mm = mm(contact.s);
        let place = Place {
            contour: several.then(|| name.clone()),
            s_mm: rounded(s_mm, 3),
            height_mm: rounded(float(contact.height) * depth, 3),
            normal: [float(contact.normal.x), float(contact.normal.y)],
            // The table has the mean over the height; what a height differs by stands on the first part that was cut with it.
            deflection_mm: along.map_or(0.0, |along| at(along, s_mm) + mm(contact.error)),
        };
        Reading { place, error_mm: mm(contact.error) }
    });
    readings.collect()
}

/// The value at a place of a table along the contour.
fn at(along: &[(f64, f64)], s_mm: f64) -> f64 {
    let behind = along.partition_point(|(s, _)| *s < s_mm).min(along.len().saturating_sub(1));
    along.get(behind).map_or(0.0, |(_, value)| *value)
}

/// How far each wall would be off uncorrected, along it, from the folder of a correction.
fn deflections(
    from: &Path,
    walls: &[Pass],
    several: bool,
    warnings: &mut Vec<Remark>,
) -> Result<BTreeMap<String, Vec<(f64, f64)>>, Failure> {
    let mut all = BTreeMap::new();
    for pass in walls {
        let table = from.join(format!("{}correction.csv", contour_place(pass, several)));
        if several && !truepath_ground::files::exists(&table) {
            warnings.push(
                format!("{} is not there: how far {} is pushed is not known", table.display(), contour_name(pass))
                    .into(),
            );
            continue;
        }
        let rows = read_correction(&Source::read(&table)?, None)?;
        let along = rows.iter().filter_map(|row| Some((row.s_mm, row.predicted_error_before_mm?))).collect();
        all.insert(contour_name(pass), along);
    }
    Ok(all)
}

/// The line of a record, counted from 1: its place is that behind the record before, ahead of blank lines and comments.
fn line_of(table: &Source, place: &csv::Position) -> u64 {
    let bytes = table.bytes();
    let mut at = usize::try_from(place.byte()).unwrap_or(usize::MAX).min(bytes.len());
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'\r' | b'\n' => at += 1,
            b'#' => at += bytes[at..].iter().take_while(|b| **b != b'\n').count(),
            _ => break,
        }
    }
    1 + bytes[..at].iter().filter(|b| **b == b'\n').count() as u64
}

/// Reads the table of parts.
fn entries(table: &Source, folder: &Path) -> Result<Vec<Entry>, Failure> {
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).trim(csv::Trim::All).from_reader(table.bytes());
    let wrong = |line: u64, found: String, expected: &str| {
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        Failure::from(Q012.error(found, expected).at(table, table.line_span(line)))
    };
    let unreadable = |e: &csv::Error| {
        wrong(e.position().map_or(1, csv::Position::line), format!("no table: {e}"), "part,probe,event")
    };
    let head = reader.headers().map_err(|e| unreadable(&e))?.clone();
    let column = |name: &str| head.iter().position(|field| field.eq_ignore_ascii_case(name));
    let (Some(part), Some(probe)) = (column("part"), column("probe")) else {
        let found = format!("the first line is `{}`", head.iter().collect::<Vec<_>>().join(","));
        return Err(wrong(1, found, "names of columns: part,probe,event"));
    };
    let event = column("event");
    let mut entries: Vec<Entry> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| unreadable(&e))?;
        let line = record.position().map_or(1, |place| line_of(table, place));
        let field = |at: usize| record.get(at).unwrap_or_default();
        let number = field(part).parse::<u32>().ok().filter(|n| (1..=1_000_000).contains(n));
        let number =
            number.ok_or_else(|| wrong(line, format!("the part is `{}`", field(part)), "its number, 1 to 1000000"))?;
        if let Some(before) = entries.last().filter(|before| before.number >= number) {
            return Err(wrong(
                line,
                format!("part {number} behind part {}", before.number),
                "parts in the order in which they were milled, each once",
            ));
        }
        let mut events = Vec::new();
        for word in event.map_or("", field).split([' ', '+', ';']).filter(|word| !word.is_empty()) {
            events.push(match word.to_ascii_lowercase().as_str() {
                "cutter" => Event::Cutter,
                "lot" => Event::Lot,
                "setup" => Event::Setup,
                _ => {
                    return Err(wrong(
                        line,
                        format!("the event `{word}`"),
                        "cutter, lot or setup, or several with a blank between them",
                    ));
                }
            });
        }
        if entries.len() == MOST {
            return Err(wrong(line, format!("more than {MOST} parts"), "a batch of fewer parts"));
        }
        let file = field(probe);
        let probe = if file.is_empty() { PathBuf::new() } else { folder.join(file) };
        entries.push(Entry { line: u32::try_from(line).unwrap_or(u32::MAX), number, probe, events });
    }
    Ok(entries)
}
