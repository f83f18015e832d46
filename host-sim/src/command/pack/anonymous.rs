//! A story without names and comments, whose corrections are made anew from what is left.

use std::collections::BTreeMap;

use serde_json::Value;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_job::job::JobFile;
use truepath_story::codes::{U005, U006};
use truepath_story::contents::{Step, Story, sums};
use truepath_story::nameless;

use super::super::readings::{DIMENSIONS, PROBE};
use super::again::{Made, Place, numbers};
use super::gathered::{SUMMARY, beside, inside};

/// New names by old ones.
#[derive(Default)]
struct Renamed(BTreeMap<String, String>);

impl Renamed {
    /// The new name: a word, a number behind the second of its kind, an extension.
    fn of(&mut self, old: &str, word: &str, extension: &str) -> String {
        if let Some(known) = self.0.get(old) {
            return known.clone();
        }
        let numbered = std::iter::once(String::new()).chain((2..).map(|number| format!("-{number}")));
        let mut candidates = numbered.map(|number| format!("{word}{number}{extension}"));
        let taken = |name: &String| self.0.values().any(|known| known == name);
        let name = candidates.find(|name| !taken(name)).unwrap_or_default();
        self.0.insert(old.to_owned(), name.clone());
        name
    }
}

/// Takes names and comments out of a story, and makes its corrections anew.
///
/// # Errors
/// `U006` where the numbers are others without them, and what the commands refuse then.
pub(super) fn anonymous(story: &Story, progress: &mut dyn FnMut(f64)) -> Result<Story, Failure> {
    let mut renamed = Renamed::default();
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut steps = Vec::new();
    for step in &story.told.steps {
        let job = bare_job(story, &step.job, &mut renamed, &mut files)?;
        let mut bare = Step { job, ..step.clone() };
        for (old, new) in [(&step.probe, &mut bare.probe), (&step.dimensions, &mut bare.dimensions)] {
            *new = old.as_ref().map(|old| bare_readings(story, old, &mut renamed, &mut files)).transpose()?;
        }
        let output = renamed.of(&format!("{}/", step.output), "correction", "");
        let from = step.from.as_ref().map(|from| renamed.of(&format!("{from}/"), "correction", ""));
        steps.push(Step { output, from, ..bare });
    }
    let cut_again = match &story.told.cut_again {
        None => None,
        Some(old) => Some(bare_readings(story, old, &mut renamed, &mut files)?),
    };
    let bare = Story::new(story.told.by.clone(), steps, cut_again, files);
    let (place, named) = (Place::of(&bare)?, Place::of(story)?);
    let mut done = bare.clone();
    let count = 2.0 * story.told.steps.len() as f64;
    for (at, (own, old)) in bare.told.steps.iter().zip(&story.told.steps).enumerate() {
        // The routes are those whose files the old one has.
        let routed = Step { output: old.output.clone(), ..own.clone() };
        let (to, at) = (format!("made-{at}"), 2.0 * at as f64);
        let made = place.make(story, &routed, &to, &mut |share| progress((at + share) / count))?;
        let then = named.make(story, old, &to, &mut |share| progress((at + 1.0 + share) / count))?;
        agree(&old.output, &then, &made)?;
        let raw = |name: &str| [PROBE, DIMENSIONS].contains(&name);
        let kept = |name: &str| story.within(&old.output).any(|(other, _)| other == name) || raw(name);
        for (name, bytes) in made.files.into_iter().filter(|(name, _)| kept(name)) {
            let name = inside(&own.output, &name);
            place.add(&name, &bytes)?;
            done.files.insert(name, bytes);
        }
    }
    done.told.anonymous = true;
    done.told.files = sums(&done.files);
    Ok(done)
}

fn bytes_of<'a>(story: &'a Story, name: &str) -> Result<&'a [u8], InputError> {
    let missing = || U005.error(format!("{name} is missing"), "every file that the job names");
    story.files.get(name).map(Vec::as_slice).ok_or_else(missing)
}

/// A probe file or a file of dimensions, renamed and bare; its new name.
fn bare_readings(
    story: &Story,
    old: &str,
    renamed: &mut Renamed,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> Result<String, Failure> {
    let bytes = bytes_of(story, old)?;
    let (name, bare) = if old.ends_with(".toml") {
        (renamed.of(old, "dimensions", ".toml"), nameless::dimensions(bytes))
    } else {
        (renamed.of(old, "probe", ".txt"), nameless::probe(bytes))
    };
    let Some(bare) = bare else {
        let found = format!("{old} is of a format whose names cannot be taken out");
        return Err(U006
            .error(found, "points in columns or in lines, dimensions in a file of [[dimension]] tables")
            .into());
    };
    files.insert(name.clone(), bare);
    Ok(name)
}

/// A job with the files it names, all of them renamed and bare; its new name.
fn bare_job(
    story: &Story,
    old: &str,
    renamed: &mut Renamed,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> Result<String, Failure> {
    let known = renamed.0.contains_key(old);
    let name = renamed.of(old, "job", ".toml");
    if known {
        return Ok(name);
    }
    let text = String::from_utf8_lossy(bytes_of(story, old)?).into_owned();
    let parentheses = !words_in_parentheses(&text);
    let mut names = BTreeMap::new();
    for (key, named) in nameless::named(&text) {
        let file = beside(old, &named).unwrap_or_default();
        let bytes = bytes_of(story, &file)?;
        let extension = named.rsplit_once('.').map_or_else(String::new, |(_, e)| format!(".{}", e.to_lowercase()));
        let (word, bare) = match key {
            "program" => ("program", nameless::program(bytes, parentheses)),
            "from" => {
                let text = nameless::job(&String::from_utf8_lossy(bytes), str::to_owned);
                ("forces", text.map(String::into_bytes).unwrap_or_else(|_| bytes.to_vec()))
            }
            _ => ("stock", nameless::probe(bytes).unwrap_or_else(|| bytes.to_vec())),
        };
        let new = renamed.of(&file, word, &extension);
        files.insert(new.clone(), bare);
        names.insert(named, new);
    }
    let bare = nameless::job(&text, |old| names.get(old).cloned().unwrap_or_else(|| old.to_owned()));
    let bare = bare.map_err(|error| Failure::Internal(format!("a job that was read is no TOML: {error}")))?;
    files.insert(name.clone(), bare.into_bytes());
    Ok(name)
}

/// Whether the control of a job takes parentheses for those of an expression.
fn words_in_parentheses(job: &str) -> bool {
    let job =
        JobFile::parse(truepath_ground::diagnostics::Source::new("job.toml", job.as_bytes().to_vec()), "".as_ref());
    job.is_ok_and(|job| ["siemens", "heidenhain"].contains(&truepath_job::job::dialect_name(job.numbers.dialect)))
}

/// Whether a correction without names has the numbers of the one with them.
fn agree(folder: &str, then: &Made, now: &Made) -> Result<(), InputError> {
    let summary = |made: &Made| made.files.get(SUMMARY).and_then(|bytes| serde_json::from_slice::<Value>(bytes).ok());
    let mut found = Vec::new();
    if let (Some(then), Some(now)) = (summary(then), summary(now)) {
        // What programs differ in are their bytes.
        numbers("", &then, &now, &mut found);
        found.retain(|found| !found.starts_with("/program/"));
    }
    match found.first() {
        None => Ok(()),
        Some(first) => {
            let summary = inside(folder, SUMMARY);
            let found = format!("without names and comments {} numbers of {summary} differ: {first}", found.len());
            Err(U006.error(found, "the same numbers"))
        }
    }
}
