//! The command-line program as the bench calls it, and what it says.

use std::path::PathBuf;

use crate::repository::{self, Profile, program, read, target};
use crate::step::Failure;

/// The program, in debug or release.
pub struct Program(PathBuf);

/// What a run gave, from its JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// Setpoints sent.
    pub setpoints: u64,
    /// Answers compared.
    pub answers: u64,
    /// Parts armed.
    pub armed: u64,
    /// Fingerprint of all answers.
    pub digest: String,
    /// All of it.
    pub json: String,
}

impl Program {
    /// Builds it.
    pub fn build(release: bool) -> Result<Self, Failure> {
        let profile = if release { Profile::Bits } else { Profile::Dev };
        Ok(Self(repository::truepath(profile)?))
    }

    /// `truepath hil`; an error holds what it said, the first differing tick included.
    pub fn hil(&self, arguments: &[&str]) -> Result<Run, Failure> {
        let json = read(program(&self.0).arg("hil").args(arguments).arg("--json"))?;
        Run::parse(json).ok_or_else(|| Failure::found("truepath hil said something else than a report"))
    }
}

impl Program {
    /// `truepath hil --trust`: how much was tried, how much of it refused.
    pub fn trust(&self, arguments: &[&str]) -> Result<(usize, usize), Failure> {
        let json = read(program(&self.0).arg("hil").args(arguments).arg("--json"))?;
        let count = |text| json.matches(text).count();
        match (count("\"given\":"), count("\"refused\": \"")) {
            (0, _) => Err(Failure::found("truepath hil --trust said something else than a report")),
            counts => Ok(counts),
        }
    }
}

impl Run {
    fn parse(json: String) -> Option<Self> {
        let number = |key| value(&json, key)?.parse().ok();
        let digest = value(&json, "digest")?.trim_matches('"').to_owned();
        Some(Self {
            setpoints: number("setpoints")?,
            answers: number("answers")?,
            armed: number("armed")?,
            digest,
            json,
        })
    }
    /// A number by its key; the first with that name.
    pub fn number(&self, key: &str) -> u64 {
        value(&self.json, key).and_then(|v| v.parse().ok()).unwrap_or(0)
    }
}

/// What stands behind a key.
fn value<'j>(json: &'j str, key: &str) -> Option<&'j str> {
    let (_, behind) = json.split_once(&format!("\"{key}\":"))?;
    behind.split([',', '}', '\n']).next().map(str::trim)
}

/// The parts of the demonstration.
pub struct Parts(PathBuf);

impl Parts {
    /// Makes them.
    pub fn make(truepath: &Program) -> Result<Self, Failure> {
        let folder = target().join("hil");
        read(program(&truepath.0).args(["demo", "--force", "-o"]).arg(&folder))?;
        Ok(Self(folder))
    }
    /// A file of a part.
    pub fn file(&self, part: &str, name: &str) -> String {
        self.0.join(part).join(name).display().to_string()
    }
    /// Its image.
    pub fn image(&self, part: &str) -> String {
        self.file(part, "correction.tpi")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_read_from_the_report() {
        let json =
            "{\n  \"setpoints\": 12,\n  \"answers\": 11,\n  \"digest\": \"00ff\",\n  \"armed\": 2,\n  \"lost\": 7\n}\n";
        let run = Run::parse(json.to_owned()).unwrap();
        assert_eq!((run.setpoints, run.answers, run.armed, run.digest.as_str()), (12, 11, 2, "00ff"));
        assert_eq!((run.number("lost"), run.number("late")), (7, 0));
        assert_eq!(Run::parse("{}".to_owned()), None);
    }
}
