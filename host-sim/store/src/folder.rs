//! What a folder holds for the store: the histories of one part, one for each of its contours, and what lies beside them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use truepath_correction::learning::{HISTORY, History};
use truepath_correction::shop::Said;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::files;
use truepath_ground::units::nm;

use crate::codes::O005;
use crate::rows::json;

/// The folder of several contours.
const CONTOURS: &str = "contours";
/// Folders below a given one that are looked through.
const DEEPEST: usize = 8;

/// A history with what lies beside it.
#[derive(Clone, Debug)]
pub struct Found {
    /// Where it lies.
    pub path: PathBuf,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What they say.
    pub history: History,
    /// What was identified from its parts, by name: value and one standard deviation.
    pub identified: BTreeMap<String, (f64, f64)>,
    /// What their points say whatever was believed before, as JSON; `None` where nothing beside it says so.
    pub said: Option<String>,
    /// The length of the contour, nm; 0 where no table beside it says it.
    pub cut_nm: i64,
}

/// The histories of one part.
#[derive(Clone, Debug)]
pub struct PartFolder {
    /// Its folder.
    pub folder: PathBuf,
    /// They, in the order of their names.
    pub contours: Vec<Found>,
}

impl Found {
    /// Reads the history of a folder and what lies beside it.
    ///
    /// # Errors
    /// `F001` and those of [`History::read`].
    fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(HISTORY);
        let source = Source::read(&path)?;
        let history = History::read(&source)?;
        let bytes = source.bytes().to_vec();
        let summary = summary(folder).unwrap_or_default();
        let (identified, said) = (identified(&summary).unwrap_or_default(), said(&summary));
        Ok(Self { bytes, history, identified, said, cut_nm: cut_nm(folder), path })
    }
}

impl PartFolder {
    /// The folder of one part, as `truepath correct` or `truepath learn` wrote it; `None` where there is no history in it.
    ///
    /// # Errors
    /// A history that cannot be read.
    pub fn read(folder: &Path) -> Result<Option<Self>, Failure> {
        let mut places = Vec::new();
        if files::is_file(&folder.join(HISTORY)) {
            places.push(folder.to_owned());
        } else {
            places.extend(subfolders(&folder.join(CONTOURS)).into_iter().filter(|f| files::is_file(&f.join(HISTORY))));
        }
        let contours = places.iter().map(|place| Found::read(place)).collect::<Result<Vec<_>, _>>()?;
        Ok((!contours.is_empty()).then(|| Self { folder: folder.to_owned(), contours }))
    }

    /// The folders of parts in and below some folders, in the order of their names.
    ///
    /// # Errors
    /// `O005` for a folder without any.
    pub fn every(folders: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
        let mut all = Vec::new();
        for folder in folders {
            let before = all.len();
            search(folder, DEEPEST, &mut all);
            if all.len() == before {
                let found = format!("{} holds no {HISTORY}, nor does a folder below it", folder.display());
                return Err(O005.error(found, "the history of a part").in_file(folder).into());
            }
        }
        // A folder that was named and lies below another one comes once.
        let mut known = BTreeSet::new();
        all.retain(|folder| known.insert(files::canonical(folder).unwrap_or_else(|_| folder.clone())));
        Ok(all)
    }
}

fn search(folder: &Path, deepest: usize, all: &mut Vec<PathBuf>) {
    let of_contours = |f: &PathBuf| files::is_file(&f.join(HISTORY));
    if files::is_file(&folder.join(HISTORY)) || subfolders(&folder.join(CONTOURS)).iter().any(of_contours) {
        all.push(folder.to_owned());
    }
    if deepest == 0 {
        return;
    }
    for inner in subfolders(folder) {
        if inner.file_name().is_some_and(|name| name != CONTOURS) {
            search(&inner, deepest - 1, all);
        }
    }
}

/// Folders in a folder, in the order of their names; links are not followed, as they may lead in a circle.
fn subfolders(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let real = |entry: &std::fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
    let mut inner: Vec<PathBuf> = entries.filter_map(Result::ok).filter(real).map(|entry| entry.path()).collect();
    inner.sort();
    inner
}

/// `summary.json`; `None` where there is none, as it is not what a part is known by.
fn summary(folder: &Path) -> Option<serde_json::Value> {
    serde_json::from_slice(&files::read(&folder.join("summary.json")).ok()?).ok()
}

/// What a summary says was identified.
fn identified(summary: &serde_json::Value) -> Option<BTreeMap<String, (f64, f64)>> {
    let of = |(name, of): (&String, &serde_json::Value)| {
        Some((name.clone(), (of.get("value")?.as_f64()?, of.get("sigma")?.as_f64()?)))
    };
    Some(summary.get("identified")?.as_object()?.iter().filter_map(of).collect())
}

/// What its points say; `None` where it cannot be what points say.
fn said(summary: &serde_json::Value) -> Option<String> {
    let said = Said::read(summary.get("points_say")?.clone()).ok()?;
    json(&said).ok()
}

/// The last arc length of `correction.csv`, nm; 0 where there is none.
fn cut_nm(folder: &Path) -> i64 {
    let read = || {
        let bytes = files::read(&folder.join("correction.csv")).ok()?;
        let text = std::str::from_utf8(&bytes).ok()?;
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let column = lines.next()?.split(',').position(|name| name == "s_mm")?;
        let mm: f64 = lines.next_back()?.split(',').nth(column)?.parse().ok()?;
        (0.0..=1e7).contains(&mm).then(|| nm(mm).nm())
    };
    read().unwrap_or(0)
}
