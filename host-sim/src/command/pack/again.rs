//! A story run again: every correction made from its inputs by this program, beside what was written then, and what parts that
//! were cut again showed beside what had been promised.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path as FilePath;

use serde_json::Value;
use truepath_correction::learn::LearnSummary;
use truepath_correction::shop::Belief;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;
use truepath_job::job::{Route, Said, Which};
use truepath_story::contents::{Command, Step, Story};

use super::super::begin::{Begin, BeginFlags};
use super::super::{correct, learn};
use super::gathered::{SUMMARY, inside};

/// A story run again.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Again {
    /// The program that packed it.
    pub then: String,
    /// This program.
    pub now: String,
    /// Its corrections.
    pub corrections: Vec<MadeAgain>,
    /// Parts that were cut with a correction and touched.
    pub parts: Vec<CameOut>,
    /// Whether every file is the same.
    pub same: bool,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
}

/// A correction made again.
#[derive(Clone, Debug, serde::Serialize)]
pub struct MadeAgain {
    /// The command.
    pub command: Command,
    /// Its folder.
    pub folder: String,
    /// Files that are the same, byte for byte; a summary is as well when its numbers are.
    pub same: Vec<String>,
    /// Files that differ, with how.
    pub differ: BTreeMap<String, String>,
    /// What it promises.
    pub promised: Promised,
    /// What it promised then.
    pub promised_then: Promised,
}

/// What a correction promises of the wall, mm; `None` where its summary does not say it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Promised {
    /// The largest mean over the height.
    pub mean_mm: Option<f64>,
    /// Its standard deviation.
    pub mean_sigma_mm: Option<f64>,
    /// The largest error at any height.
    pub profile_mm: Option<f64>,
    /// What does not repeat.
    pub floor_mm: Option<f64>,
}

impl Promised {
    fn of(summary: Option<&[u8]>) -> Self {
        let summary = summary.and_then(|bytes| serde_json::from_slice::<Value>(bytes).ok());
        let number = |at: &str| summary.as_ref()?.pointer(at)?.as_f64();
        Self {
            mean_mm: number("/surface/after/mean_mm"),
            mean_sigma_mm: number("/surface/after/mean_sigma_mm"),
            profile_mm: number("/surface/after/profile_mm"),
            floor_mm: number("/floor_mm"),
        }
    }

    fn words(&self, unit: Unit) -> String {
        let number = |mm: Option<f64>| mm.map_or_else(|| "-".to_owned(), |mm| format!("{:.4}", unit.of(mm)));
        format!(
            "{} ± {} {} (mean over the height, 1 sigma), {} at the worst height; floor {}",
            number(self.mean_mm),
            number(self.mean_sigma_mm),
            unit.name(),
            number(self.profile_mm),
            number(self.floor_mm)
        )
    }
}

/// A part that was cut with a correction: what was promised and what was measured.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CameOut {
    /// Its number.
    pub part: u32,
    /// Largest predicted error at its places, mm.
    pub promised_mm: f64,
    /// Largest standard deviation there, mm.
    pub sigma_mm: f64,
    /// Largest measured error, mm.
    pub measured_mm: f64,
    /// The part before at the same places, mm.
    pub before_mm: f64,
    /// Places within two standard deviations.
    pub within_two_sigma: usize,
    /// Places.
    pub places: usize,
}

impl CameOut {
    fn of(summary: &LearnSummary) -> Self {
        let verdict = &summary.verdict;
        Self {
            part: verdict.part,
            promised_mm: verdict.promise.max_mm,
            sigma_mm: verdict.promise.max_sigma_mm,
            measured_mm: verdict.measured_error_mm.max_mm,
            before_mm: verdict.previous_error_mm.max_mm,
            within_two_sigma: verdict.promise.within_two_sigma,
            places: verdict.promise.places,
        }
    }
}

impl Again {
    /// For people.
    pub fn words(&self) -> String {
        let (unit, name) = (self.unit, self.unit.name());
        let mut text = format!("made again by {} what {} made:\n", self.now, self.then);
        for one in &self.corrections {
            let folder = if one.folder.is_empty() { "." } else { &one.folder };
            let _ = writeln!(
                text,
                "  {} {folder}: {} files the same, {} not",
                one.command.word(),
                one.same.len(),
                one.differ.len()
            );
            for (name, how) in &one.differ {
                let _ = writeln!(text, "    {name}: {how}");
            }
            let _ = writeln!(text, "    promises {}", one.promised.words(unit));
            if one.promised_then != one.promised {
                let _ = writeln!(text, "    promised {} then", one.promised_then.words(unit));
            }
        }
        for part in &self.parts {
            let _ = writeln!(
                text,
                "  part {}: {:.4} {name} promised (± {:.4}), {:.4} {name} measured at {} places, {} of them within 2 sigma; the part before {:.4} {name}",
                part.part,
                unit.of(part.promised_mm),
                unit.of(part.sigma_mm),
                unit.of(part.measured_mm),
                part.places,
                part.within_two_sigma,
                unit.of(part.before_mm)
            );
        }
        text
    }
}

/// Runs a story again, in a folder that goes with it.
///
/// # Errors
/// What the commands refuse; files that cannot be written.
pub fn again(story: &Story, progress: &mut dyn FnMut(f64)) -> Result<Again, Failure> {
    let place = Place::of(story)?;
    let count = (story.told.steps.len() + usize::from(story.told.cut_again.is_some())) as f64;
    let (mut corrections, mut parts, mut unit) = (Vec::new(), Vec::new(), Unit::default());
    for (at, step) in story.told.steps.iter().enumerate() {
        let mut told = |share: f64| progress((at as f64 + share) / count);
        let made = place.make(story, step, &format!("again-{at}"), &mut told)?;
        parts.extend(made.came_out);
        unit = made.unit;
        corrections.push(compared(story, step, &made));
    }
    if let (Some(probe), Some(last)) = (&story.told.cut_again, story.told.steps.last()) {
        let step = Step {
            command: Command::Learn,
            from: Some(last.output.clone()),
            output: String::new(),
            ..last.clone().of_readings(probe.clone())
        };
        parts.extend(place.make(story, &step, "cut-again", &mut |_| ())?.came_out);
    }
    progress(1.0);
    let same = corrections.iter().all(|one: &MadeAgain| one.differ.is_empty());
    let now = concat!("truepath ", env!("CARGO_PKG_VERSION")).to_owned();
    Ok(Again { then: story.told.by.clone(), now, corrections, parts, same, unit })
}

/// The files of a story in a folder of their own.
pub(super) struct Place(tempfile::TempDir);

/// What making a correction gave.
pub(super) struct Made {
    /// Its files.
    pub(super) files: BTreeMap<String, Vec<u8>>,
    /// How the part came out that it was learned from.
    came_out: Option<CameOut>,
    /// The unit of the program.
    unit: Unit,
}

impl Place {
    /// Writes the files.
    pub(super) fn of(story: &Story) -> Result<Self, Failure> {
        let place = tempfile::tempdir().map_err(|error| Failure::Internal(format!("a folder: {error}")))?;
        let place = Self(place);
        story.files.iter().try_for_each(|(name, bytes)| place.add(name, bytes))?;
        Ok(place)
    }

    /// Writes one more.
    pub(super) fn add(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.0.path().join("then").join(name);
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, bytes));
        written.map_err(|error| InputError::unwritable(&path, &error).into())
    }

    /// Makes a correction again, for the routes whose files it has. Errors name files as the story does.
    pub(super) fn make(
        &self,
        story: &Story,
        step: &Step,
        to: &str,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Made, Failure> {
        let then = self.0.path().join("then");
        self.made(story, step, (&then, to), progress).map_err(|failure| match failure {
            Failure::Input(error) => Failure::Input(error.without_folder(&then)),
            other => other,
        })
    }

    fn made(
        &self,
        story: &Story,
        step: &Step,
        (then, to): (&FilePath, &str),
        progress: &mut dyn FnMut(f64),
    ) -> Result<Made, Failure> {
        let has = |ending: &str| story.within(&step.output).any(|(name, _)| name.ends_with(ending));
        let mut routes: Vec<Route> = Vec::new();
        routes.extend(has("corrected.nc").then_some(Route::Program));
        routes.extend(has(".tpi").then_some(Route::Coprocessor));
        let mut made = Made { files: BTreeMap::new(), came_out: None, unit: Unit::default() };
        let routes = if routes.is_empty() { vec![None] } else { routes.into_iter().map(Some).collect() };
        for (number, route) in routes.into_iter().enumerate() {
            let output = self.0.path().join(format!("{to}-{number}"));
            let which = Which { feature: step.feature.clone(), pass: None };
            let said = Said { which, ..Said::default() };
            let file = |name: &Option<String>| name.as_ref().map(|name| then.join(name));
            let begin = BeginFlags { begin: Begin::At(begun_at(story, step)), ..BeginFlags::default() };
            let (job, probe, dimensions) = (then.join(&step.job), file(&step.probe), file(&step.dimensions));
            match (step.command, &step.from) {
                (Command::Learn, Some(from)) => {
                    let from = then.join(from);
                    let output = output.clone();
                    let part = part_of(story, step);
                    let new_cutter = of_summary(story, step, "new_cutter").is_some();
                    let options = learn::Options {
                        job,
                        probe,
                        dimensions,
                        part,
                        new_cutter,
                        from,
                        output,
                        route,
                        begin,
                        said,
                        ..Default::default()
                    };
                    let summary = learn::run(&options, progress)?;
                    made.unit = summary.correct.unit;
                    made.came_out = Some(CameOut::of(&summary));
                }
                _ => {
                    let output = output.clone();
                    let options =
                        correct::Options { job, probe, dimensions, output, route, begin, said, ..Default::default() };
                    made.unit = correct::run(&options, progress)?.unit;
                }
            }
            let mut files = BTreeMap::new();
            read_all(&output, "", &mut files)?;
            // Texts name files as they were asked for: from the folder of the story.
            let own = format!("{}{}", then.display(), std::path::MAIN_SEPARATOR);
            files.values_mut().for_each(|bytes| without(bytes, own.as_bytes()));
            // The first route is the one that summaries and histories are of.
            for (name, bytes) in files {
                made.files.entry(name).or_insert(bytes);
            }
        }
        Ok(made)
    }
}

/// The number of the part that a correction was learned from, as its summary has it.
fn part_of(story: &Story, step: &Step) -> Option<u32> {
    of_summary(story, step, "part")?.as_u64()?.try_into().ok()
}

/// What the fit of a correction began at in place of what its job states: no store is asked again.
fn begun_at(story: &Story, step: &Step) -> Option<Belief> {
    serde_json::from_value(of_summary(story, step, "believed")?).ok()
}

/// A value of the summary of a correction; of several contours that of the first that has it.
fn of_summary(story: &Story, step: &Step, name: &str) -> Option<Value> {
    let summary: Value = serde_json::from_slice(story.files.get(&inside(&step.output, SUMMARY))?).ok()?;
    let contours = summary.get("contours").and_then(Value::as_array).into_iter().flatten();
    std::iter::once(&summary).chain(contours).find_map(|of| of.get(name).cloned())
}

/// Takes a text out of bytes, wherever it stands.
fn without(bytes: &mut Vec<u8>, text: &[u8]) {
    while let Some(at) = bytes.windows(text.len()).position(|window| window == text) {
        bytes.drain(at..at + text.len());
    }
}

/// The files of a folder.
fn read_all(folder: &FilePath, within: &str, files: &mut BTreeMap<String, Vec<u8>>) -> Result<(), InputError> {
    let unreadable = |error| InputError::unreadable(folder, &error);
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name =
            inside(within, &path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
        if path.is_dir() {
            read_all(&path, &name, files)?;
        } else {
            files.insert(name, std::fs::read(&path).map_err(|error| InputError::unreadable(&path, &error))?);
        }
    }
    Ok(())
}

/// What was made again beside what was written then.
fn compared(story: &Story, step: &Step, made: &Made) -> MadeAgain {
    let (mut same, mut differ) = (Vec::new(), BTreeMap::new());
    for (name, then) in story.within(&step.output) {
        let Some(now) = made.files.get(name) else { continue };
        match difference(name, then, now) {
            None => same.push(name.to_owned()),
            Some(how) => drop(differ.insert(name.to_owned(), how)),
        }
    }
    let then = story.within(&step.output).find(|(name, _)| *name == SUMMARY).map(|(_, bytes)| bytes);
    let promised = Promised::of(made.files.get(SUMMARY).map(Vec::as_slice));
    let promised_then = Promised::of(then);
    MadeAgain { command: step.command, folder: step.output.clone(), same, differ, promised, promised_then }
}

/// How a file differs from what was written then.
fn difference(name: &str, then: &[u8], now: &[u8]) -> Option<String> {
    if then == now {
        return None;
    }
    if name.ends_with(SUMMARY) {
        let [then, now] = [then, now].map(serde_json::from_slice::<Value>);
        let (Ok(then), Ok(now)) = (then, now) else { return Some("is no JSON".to_owned()) };
        let mut found = Vec::new();
        numbers("", &then, &now, &mut found);
        if found.is_empty() {
            return None;
        }
        let few: Vec<&str> = found.iter().take(5).map(String::as_str).collect();
        return Some(format!("{} numbers differ: {}", found.len(), few.join(", ")));
    }
    if name.ends_with("difference.txt") && words(then).eq(words(now)) {
        return None;
    }
    let [then_lines, now_lines] = [then, now].map(|bytes| bytes.split(|byte| *byte == b'\n'));
    let line = then_lines.clone().zip(now_lines).take_while(|(a, b)| a == b).count() + 1;
    Some(format!("{} bytes then, {} now, from line {line} on", then.len(), now.len()))
}

/// The words of a text, of files without the folders above them: they may lie elsewhere now.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = text.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.rsplit(|byte| *byte == b'/').next().unwrap_or(word))
}

/// The numbers that two summaries both have and that differ. Texts may name files that now lie elsewhere; an older program says less.
pub(super) fn numbers(at: &str, then: &Value, now: &Value, found: &mut Vec<String>) {
    match (then, now) {
        (Value::Object(then), Value::Object(now)) => {
            for (key, then) in then {
                if let Some(now) = now.get(key) {
                    numbers(&format!("{at}/{key}"), then, now, found);
                }
            }
        }
        (Value::Array(then), Value::Array(now)) => {
            for (number, (then, now)) in then.iter().zip(now).enumerate() {
                numbers(&format!("{at}/{number}"), then, now, found);
            }
        }
        (Value::Number(a), Value::Number(b)) if a != b => found.push(format!("{at} {a} -> {b}")),
        (Value::Bool(a), Value::Bool(b)) if a != b => found.push(format!("{at} {a} -> {b}")),
        _ => {}
    }
}
