//! One run of LinuxCNC with some of the scenarios: started, watched, ended.
//!
//! The Python program that takes the place of the screen goes through the scenarios and records; LinuxCNC ends when it
//! does. A run that takes too long is ended, and what it said is shown.

use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::leftovers;
use super::sample::Sample;
use crate::step::Failure;

const POLL: Duration = Duration::from_millis(50);
/// Lines shown of what a failed run said.
const SHOWN: usize = 60;
/// To start and to end; scenarios have their own limits.
const LIMIT: Duration = Duration::from_secs(420);

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// By itself.
    Regular,
    /// Killed as soon as the scenarios are done, as if the power had failed.
    Killed,
}

/// Goes through scenarios; gives the folder of the recording.
///
/// # Errors
/// LinuxCNC cannot be started, ends early or does not end.
pub fn run(sample: &Sample, name: &str, scenarios: &[&str], end: End) -> Result<PathBuf, Failure> {
    leftovers::clean(&sample.user, &sample.folder)?;
    let recordings = sample.folder.join("recordings").join(name);
    let log = sample.folder.join(format!("{name}.log"));
    let said = File::create(&log).map_err(|e| Failure::found(format!("{}: {e}", log.display())))?;
    let copy = said.try_clone().map_err(|e| Failure::found(format!("{}: {e}", log.display())))?;
    let mut command = sample.user.program("linuxcnc", &sample.folder);
    command.arg("-r").arg(sample.ini()).env("PATH", sample.path());
    command.env("TRUEPATH_SCENARIOS", scenarios.join(",")).env("TRUEPATH_RECORDINGS", &recordings);
    command.env("TRUEPATH_LINKS", sample.folder.join("links"));
    command.stdin(Stdio::null()).stdout(said).stderr(copy).process_group(0);
    let child = command
        .spawn()
        .map_err(|e| Failure::Missing(format!("linuxcnc cannot be started: {e}\n  apt-get install linuxcnc-uspace")))?;
    let outcome = watch(child, &log, &recordings, end);
    let outcome = outcome.and(leftovers::clean(&sample.user, &sample.folder));
    match outcome {
        Ok(()) if recordings.join("notes.json").exists() => Ok(recordings),
        Ok(()) => Err(told(&log, "LinuxCNC ended before the scenarios began")),
        Err(Failure::Found(reason)) => Err(told(&log, &reason)),
        Err(missing) => Err(missing),
    }
}

/// Waits for the end, saying which scenario runs.
fn watch(mut child: Child, log: &Path, recordings: &Path, end: End) -> Result<(), Failure> {
    let limit = Instant::now() + LIMIT;
    let mut shown = 0;
    loop {
        let text = fs::read(log).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let names: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("scenario ")).collect();
        for name in names.iter().skip(shown) {
            eprintln!("    {name}");
        }
        shown = names.len();
        if end == End::Killed && recordings.join("finished").exists() {
            // Everything else is killed with the leftovers.
            return child.kill().and_then(|()| child.wait()).map(drop).map_err(|e| Failure::found(e.to_string()));
        }
        if child.try_wait().map_err(|e| Failure::found(e.to_string()))?.is_some() {
            return Ok(());
        }
        if Instant::now() > limit {
            let _ = child.kill().and_then(|()| child.wait());
            return Err(Failure::found(format!("LinuxCNC did not end within {} s", LIMIT.as_secs())));
        }
        sleep(POLL);
    }
}

/// A failure with the last lines of the log.
fn told(log: &Path, reason: &str) -> Failure {
    let text = fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().collect();
    let last = &lines[lines.len().saturating_sub(SHOWN)..];
    eprintln!("---- {}\n{}\n----", log.display(), last.join("\n"));
    Failure::found(format!("{reason}; see {}", log.display()))
}
