//! From a folder of files to a story: which corrections are in it, and which job, program and probe files they were made from.

use std::collections::BTreeMap;
use std::path::{Component, Path as FilePath, PathBuf};

use serde_json::Value;
use truepath_core::gcode::program_crc;
use truepath_correction::learning::History;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_story::codes::{U003, U004, U005};
use truepath_story::container::MOST_UNPACKED;
use truepath_story::contents::{Command, Step, Story};
use truepath_story::nameless::named;

use super::super::correction_files::{CONTOURS, HISTORY};
use super::super::readings::{DIMENSIONS, PROBE as RAW};

/// What tells a folder with a correction.
pub(super) const SUMMARY: &str = "summary.json";
/// Files of a correction that are packed: what it says and does, without pages and pictures, which are made from these.
const PACKED: [&str; 13] = [
    HISTORY,
    SUMMARY,
    "corrected.nc",
    "difference.txt",
    "correction.tpi",
    "correction.csv",
    "milled.csv",
    "wall.csv",
    "points.csv",
    RAW,
    DIMENSIONS,
    SURFACE,
    "plant.toml",
];
/// The probe file as the demonstration keeps it.
const DEMONSTRATED: &str = "probe.txt";
/// What the second pass of a split allowance keeps of the first.
const SURFACE: &str = "first-pass-surface.csv";
/// Files that are looked through at most, and folders below each other.
const MOST_SEEN: usize = 20_000;
const DEEPEST: usize = 8;

/// Files by their names below the folder that holds all of them.
struct Files {
    root: PathBuf,
    names: BTreeMap<String, PathBuf>,
}

/// A job file.
struct Job {
    name: String,
    /// The program it names, and its CRC-32 as summaries have it.
    program_crc: String,
    /// All files it names.
    named: Vec<String>,
}

/// A folder with a correction.
struct Corrected {
    folder: String,
    summary: Value,
    histories: Vec<History>,
}

/// The story in files and folders.
///
/// # Errors
/// `U004` where there is none, `U005` where a file is missing or two could be meant, `U003` for too much.
pub(super) fn gathered(inputs: &[PathBuf], cut_again: Option<&FilePath>) -> Result<Story, Failure> {
    let mut all: Vec<PathBuf> = inputs.to_vec();
    all.extend(cut_again.map(FilePath::to_owned));
    let files = Files::below(&all)?;
    let jobs = files.jobs()?;
    let corrected = files.corrections()?;
    if jobs.is_empty() || corrected.is_empty() {
        let what = if jobs.is_empty() { "job with a program" } else { "correction (summary.json and correction.csv)" };
        return Err(U004.error(format!("no {what} is in {}", files.root.display()), "a job and a correction").into());
    }
    let mut kept = BTreeMap::new();
    let mut steps = Vec::new();
    let mut wanted: Vec<String> = Vec::new();
    for one in &corrected {
        match files.step(one, &jobs, &corrected)? {
            Ok(step) => {
                let job = jobs.iter().find(|job| job.name == step.job);
                wanted.extend(job.into_iter().flat_map(|job| job.named.iter().cloned()));
                wanted.push(step.job.clone());
                wanted.extend(step.readings().cloned());
                steps.push((one.part(), step));
            }
            Err(why) => drop(kept.insert(one.folder.clone(), why)),
        }
        wanted.extend(files.of_correction(&one.folder));
    }
    if steps.is_empty() {
        let why = kept.values().next().cloned().unwrap_or_default();
        return Err(U004.error(format!("no correction can be made again: {why}"), "one of correct or learn").into());
    }
    steps.sort_by_key(|(part, _)| *part);
    let cut_again = cut_again.map(|file| files.name_of(file)).transpose()?;
    wanted.extend(cut_again.clone());
    wanted.sort_unstable();
    wanted.dedup();
    let mut contents = BTreeMap::new();
    let mut size = 0;
    for name in wanted {
        let bytes = files.read(&name)?.bytes().to_vec();
        size += bytes.len() as u64;
        if size > MOST_UNPACKED {
            return Err(U003.error("too much for one pack", format!("at most {MOST_UNPACKED} bytes")).into());
        }
        contents.insert(name, bytes);
    }
    let by = concat!("truepath ", env!("CARGO_PKG_VERSION")).to_owned();
    let mut story = Story::new(by, steps.into_iter().map(|(_, step)| step).collect(), cut_again, contents);
    story.told.kept = kept;
    Ok(story)
}

impl Files {
    /// All files in and below these; links and hidden ones are passed over.
    fn below(inputs: &[PathBuf]) -> Result<Self, InputError> {
        let mut absolute = Vec::new();
        for input in inputs {
            absolute.push(input.canonicalize().map_err(|error| InputError::unreadable(input, &error))?);
        }
        let folder = |path: &PathBuf| {
            if path.is_dir() { path.clone() } else { path.parent().map(FilePath::to_owned).unwrap_or_default() }
        };
        let mut root = absolute.first().map(folder).unwrap_or_default();
        while !absolute.iter().all(|path| path.starts_with(&root)) {
            if !root.pop() {
                break;
            }
        }
        let mut files = Self { root, names: BTreeMap::new() };
        for path in absolute {
            files.add(&path, 0)?;
        }
        Ok(files)
    }

    fn add(&mut self, path: &FilePath, depth: usize) -> Result<(), InputError> {
        if path.is_file() {
            if let Ok(name) = self.name_of(path) {
                self.names.insert(name, path.to_owned());
            }
            return Ok(());
        }
        if depth > DEEPEST || self.names.len() > MOST_SEEN {
            let found = format!("{} holds too many files or folders", self.root.display());
            return Err(U003.error(found, format!("at most {MOST_SEEN} files, {DEEPEST} folders deep")));
        }
        let entries = std::fs::read_dir(path).map_err(|error| InputError::unreadable(path, &error))?;
        for entry in entries {
            let entry = entry.map_err(|error| InputError::unreadable(path, &error))?;
            let kind = entry.file_type().map_err(|error| InputError::unreadable(path, &error))?;
            if !kind.is_symlink() && !entry.file_name().to_string_lossy().starts_with('.') {
                self.add(&entry.path(), depth + 1)?;
            }
        }
        Ok(())
    }

    /// The name of a file below the common folder.
    fn name_of(&self, path: &FilePath) -> Result<String, InputError> {
        let absolute = path.canonicalize().map_err(|error| InputError::unreadable(path, &error))?;
        let below = absolute.strip_prefix(&self.root).ok();
        let parts =
            below.map(|below| below.components().map(|part| part.as_os_str().to_str()).collect::<Option<Vec<_>>>());
        parts.flatten().map(|parts| parts.join("/")).ok_or_else(|| {
            U005.error(format!("{} has a name that a pack cannot hold", path.display()), "a name in UTF-8")
                .in_file(path)
        })
    }

    fn read(&self, name: &str) -> Result<Source, InputError> {
        match self.names.get(name) {
            Some(path) => Source::read(path),
            None => Err(U005.error(format!("{name} is missing"), format!("it in {}", self.root.display()))),
        }
    }

    /// The jobs with a program among the files.
    fn jobs(&self) -> Result<Vec<Job>, InputError> {
        let mut jobs = Vec::new();
        for name in self.names.keys().filter(|name| name.ends_with(".toml")) {
            let text = String::from_utf8_lossy(self.read(name)?.bytes()).into_owned();
            let named = named(&text);
            let Some((_, program)) = named.iter().find(|(key, _)| *key == "program") else { continue };
            let program = beside(name, program);
            let Some(program) = program.filter(|program| self.names.contains_key(program)) else { continue };
            let program_crc = format!("{:08x}", program_crc(self.read(&program)?.bytes()));
            let others = named.iter().map(|(_, file)| {
                beside(name, file).ok_or_else(|| {
                    let found = format!("{name} names {file}, which lies outside of {}", self.root.display());
                    U005.error(found, "all files of the story in one folder")
                })
            });
            jobs.push(Job { name: name.clone(), program_crc, named: others.collect::<Result<_, _>>()? });
        }
        Ok(jobs)
    }

    /// The folders with a correction.
    fn corrections(&self) -> Result<Vec<Corrected>, Failure> {
        let mut all = Vec::new();
        for name in self.names.keys() {
            let folder = match name.strip_suffix(SUMMARY) {
                Some("") => "",
                Some(folder) if folder.ends_with('/') => folder.trim_end_matches('/'),
                _ => continue,
            };
            let has = |file: &str| self.names.contains_key(&inside(folder, file));
            let contours = format!("{}/", inside(folder, CONTOURS).trim_end_matches('/'));
            let several: Vec<&String> = self.names.keys().filter(|name| name.starts_with(&contours)).collect();
            let of_contour = format!("/{folder}/").contains(&format!("/{CONTOURS}"));
            if of_contour || !(has("correction.csv") || several.iter().any(|name| name.ends_with("/correction.csv"))) {
                continue;
            }
            let Ok(summary) = serde_json::from_slice::<Value>(self.read(name)?.bytes()) else { continue };
            let own = inside(folder, HISTORY);
            let histories = std::iter::once(&own).chain(several).filter(|name| name.ends_with(HISTORY));
            let histories = histories.filter(|name| self.names.contains_key(*name));
            let histories = histories.map(|name| History::read(&self.read(name)?)).collect::<Result<_, _>>()?;
            all.push(Corrected { folder: folder.to_owned(), summary, histories });
        }
        Ok(all)
    }

    /// How a correction was made; the reason where it cannot be made again.
    fn step(&self, one: &Corrected, jobs: &[Job], all: &[Corrected]) -> Result<Result<Step, String>, InputError> {
        if self.names.contains_key(&inside(&one.folder, SURFACE)) {
            return Ok(Err("the second pass of a split allowance".to_owned()));
        }
        let Some(crc) = one.summary.get("program_crc32").and_then(Value::as_str) else {
            return Ok(Err("its summary names no program".to_owned()));
        };
        // Of the same program the job that lies nearest above.
        let shared =
            |job: &Job| folder_of(&job.name).split('/').zip(one.folder.split('/')).take_while(|(a, b)| a == b).count();
        let mut fitting: Vec<&Job> = jobs.iter().filter(|job| job.program_crc == crc).collect();
        fitting.sort_by_key(|job| std::cmp::Reverse(shared(job)));
        let job = match fitting.as_slice() {
            [] => return Ok(Err(format!("no job names the program with the CRC-32 {crc}"))),
            [first, second, ..] if shared(first) == shared(second) => {
                let found = format!(
                    "{} may have been made with {} or {}",
                    inside(&one.folder, SUMMARY),
                    first.name,
                    second.name
                );
                return Err(U005.error(found, "one job of the program"));
            }
            [first, ..] => first.name.clone(),
        };
        let probes = [RAW, DEMONSTRATED].map(|name| inside(&one.folder, name));
        let probe = probes.into_iter().find(|name| self.names.contains_key(name));
        let dimensions = Some(inside(&one.folder, DIMENSIONS)).filter(|name| self.names.contains_key(name));
        if probe.is_none() && dimensions.is_none() {
            return Ok(Err(format!("neither {RAW} nor {DIMENSIONS} is in it")));
        }
        let command = if one.learned() { Command::Learn } else { Command::Correct };
        let from = match command {
            Command::Correct => None,
            Command::Learn => match all.iter().find(|other| one.follows(other)) {
                Some(other) => Some(other.folder.clone()),
                None => return Ok(Err("the correction that its part was cut with is not among the files".to_owned())),
            },
        };
        let feature = one.summary.pointer("/feature/id").and_then(Value::as_str).map(str::to_owned);
        Ok(Ok(Step { command, job, probe, dimensions, output: one.folder.clone(), from, feature }))
    }

    /// The files of a correction that are packed.
    fn of_correction(&self, folder: &str) -> Vec<String> {
        let below = |name: &&String| {
            let own = match folder {
                "" => Some(name.as_str()),
                folder => name.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/')),
            };
            let Some(own) = own else { return false };
            let (place, file) = own.rsplit_once('/').unwrap_or(("", own));
            let image = file.starts_with("correction-pass-") && file.ends_with(".tpi");
            (place.is_empty() || place.starts_with(CONTOURS)) && (PACKED.contains(&file) || image)
        };
        self.names.keys().filter(below).cloned().collect()
    }
}

impl Corrected {
    fn learned(&self) -> bool {
        self.summary.get("promise").is_some()
    }

    /// The number of the part it was made from.
    fn part(&self) -> u64 {
        self.summary.get("part").and_then(Value::as_u64).unwrap_or(1)
    }

    /// Whether the part it was learned from was cut with the correction of another.
    fn follows(&self, other: &Self) -> bool {
        let follows = |own: &History, other: &History| {
            let Some(newest) = own.parts.last() else { return false };
            newest.number >= other.next_number() && newest.correction.as_ref() == Some(&other.next.correction)
        };
        !self.histories.is_empty()
            && self.histories.iter().all(|own| other.histories.iter().any(|other| follows(own, other)))
    }
}

/// A file in a folder, which may be the common one.
pub(super) fn inside(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

pub(super) fn folder_of(name: &str) -> &str {
    name.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// A file that another one names, from the folder of that one; `None` outside of the common folder.
pub(super) fn beside(name: &str, file: &str) -> Option<String> {
    let mut parts: Vec<&str> = folder_of(name).split('/').filter(|part| !part.is_empty()).collect();
    for component in FilePath::new(file).components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => drop(parts.pop()?),
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(parts.join("/"))
}
