//! Five points of the demonstration's corner, in every format, and what reads them.
#![allow(dead_code)]

use std::path::Path;

use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

const PROGRAM: &str = include_str!("../../../../demo/corner/program.nc");
const JOB: &str = include_str!("../../../../demo/corner/job.toml");

/// Bytes of a probe file of `data/probe`.
pub fn file(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/probe").join(name);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The corner probed in a format, with the ball of the job replaced.
pub fn pass(format: &str, ball: &str) -> Pass {
    let job = JOB.replace("format = \"linuxcnc\"", format);
    let job = job.replace("ball_diameter_mm = 6.0", &format!("ball_diameter_mm = {ball}"));
    let job = JobFile::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("program.nc", PROGRAM.as_bytes().to_vec())).unwrap()
}

pub fn read(format: &str, ball: &str, bytes: Vec<u8>) -> Result<Measurement, Failure> {
    Measurement::read(&pass(format, ball), &Source::new("probe.txt", bytes))
}

pub fn named(format: &str) -> String {
    format!("format = \"{format}\"")
}

pub const MACHINE: &str = "format = \"columns\"\ncolumns = \"z,x,y\"\nseparator = \"semicolon\"\ndecimal = \"comma\"\n\
                       frame = \"machine\"\npoint = \"surface\"\nwork_offset_mm = [-372.5, -250.25, -412]";
pub const SURFACE: &str = "format = \"columns\"\npoint = \"surface\"";

/// The bytes of a file with a part of it replaced.
pub fn replaced(name: &str, from: &str, to: &str) -> Vec<u8> {
    let text = file(name);
    let text: String = text.iter().map(|b| char::from(*b)).collect();
    assert!(text.contains(from), "{name} has no `{from}`");
    text.replace(from, to).chars().map(|c| c as u8).collect()
}
