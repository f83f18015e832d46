//! What a pack holds: the steps of a part's way, and its files by name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use truepath_core::checksum::crc32;

/// Version of `story.json`.
pub const VERSION: u32 = 1;

/// A story.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Story {
    /// What was done.
    pub told: Told,
    /// The files by name, `/` between folders.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// `story.json`: what was done with the files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Told {
    /// Version of this file.
    pub version: u32,
    /// The program that packed it, with its version.
    pub by: String,
    /// Whether names and comments were taken out.
    pub anonymous: bool,
    /// Corrections that can be made again, each after those it goes on from.
    pub steps: Vec<Step>,
    /// The probe file, or the file of dimensions, of the part that was cut with the last of them, where that was measured and not
    /// learned from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cut_again: Option<String>,
    /// Folders of corrections that are kept and not made again, with the reason.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub kept: BTreeMap<String, String>,
    /// CRC-32 of every other file.
    pub files: BTreeMap<String, String>,
}

/// One correction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// The command.
    pub command: Command,
    /// The job.
    pub job: String,
    /// The probe file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probe: Option<String>,
    /// The file of dimensions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dimensions: Option<String>,
    /// The folder that was written.
    pub output: String,
    /// The folder of the correction that the part was cut with, of `learn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// The feature that was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feature: Option<String>,
}

/// The command that made a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Command {
    /// `truepath correct`.
    Correct,
    /// `truepath learn`.
    Learn,
}

impl Step {
    /// The files that were measured.
    pub fn readings(&self) -> impl Iterator<Item = &String> {
        self.probe.iter().chain(&self.dimensions)
    }

    /// The same from other readings: a file of dimensions by its name, else a probe file.
    #[must_use]
    pub fn of_readings(self, file: String) -> Self {
        let (probe, dimensions) = if file.ends_with(".toml") { (None, Some(file)) } else { (Some(file), None) };
        Self { probe, dimensions, ..self }
    }
}

impl Command {
    /// Its word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Correct => "correct",
            Self::Learn => "learn",
        }
    }
}

impl Story {
    /// Of steps and files.
    pub fn new(by: String, steps: Vec<Step>, cut_again: Option<String>, files: BTreeMap<String, Vec<u8>>) -> Self {
        let sums = sums(&files);
        let told =
            Told { version: VERSION, by, anonymous: false, steps, cut_again, kept: BTreeMap::new(), files: sums };
        Self { told, files }
    }

    /// The files of a folder, by their names in it.
    pub fn within<'a>(&'a self, folder: &'a str) -> impl Iterator<Item = (&'a str, &'a [u8])> {
        let inside = move |name: &'a str| match folder {
            "" => Some(name),
            folder => name.strip_prefix(folder)?.strip_prefix('/'),
        };
        self.files.iter().filter_map(move |(name, bytes)| Some((inside(name)?, bytes.as_slice())))
    }
}

/// CRC-32 of files.
pub fn sums(files: &BTreeMap<String, Vec<u8>>) -> BTreeMap<String, String> {
    files.iter().map(|(name, bytes)| (name.clone(), format!("{:08x}", crc32(bytes)))).collect()
}
