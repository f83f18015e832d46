//! An independent machine scores corrected programs.
//!
//! The judge is a program with its own physics and none of this repository's code: `make SCENARIO DIR` writes what a
//! user would have after the first part (`program.nc`, `job.toml`, `probe.txt`), `score SCENARIO PROGRAM` cuts a
//! corrected program on the same machine and prints `before_mm` and `after_mm` as JSON. Another one, `judge3/judge3.py`, cuts
//! programs of several passes and looks at every height of the wall: it scores what `truepath plan` writes for the
//! tolerance of its scenario. They are not part of the repository; where they are absent the check is skipped, and says so.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::repository::{self, Profile, may_install, program, read, root, run, succeeds, target};
use crate::step::{Failure, Outcome, Passed};

/// What a scenario has to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Minimum {
    /// Largest wall error after correction, mm.
    After(f64),
    /// Largest wall error before, over that after.
    Factor(f64),
}

/// The committed minimum of each scenario. One that is not listed has to become better, no more.
const MINIMA: &[(&str, Minimum)] = &[
    ("corner-plain", Minimum::After(0.010)),
    ("corner-helix", Minimum::Factor(10.0)),
    ("pocket-climb", Minimum::Factor(25.0)),
];

/// The modules of Python the judge needs.
const MODULES: [&str; 2] = ["numpy", "numba"];

/// What the judge says of a corrected program.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Score {
    before_mm: f64,
    after_mm: f64,
}

impl Score {
    /// From the judge's line of JSON.
    fn read(said: &str) -> Option<Self> {
        Some(Self { before_mm: number(said, "before_mm")?, after_mm: number(said, "after_mm")? })
    }
    fn factor(self) -> f64 {
        self.before_mm / self.after_mm
    }
    fn reaches(self, minimum: Option<Minimum>) -> bool {
        match minimum {
            Some(Minimum::After(limit)) => self.after_mm <= limit,
            Some(Minimum::Factor(least)) => self.factor() >= least,
            None => self.after_mm < self.before_mm,
        }
    }
}

/// Corrects every scenario and compares with the minima. Without a path the judge is looked for as `judge/judge.py`
/// in the folders beside the repository.
pub fn run_all(given: Option<&Path>, profile: Profile) -> Outcome {
    let Some(judge) =
        given.map(|path| root().join(path)).or_else(|| beside("judge/judge.py")).filter(|path| path.is_file())
    else {
        return match given {
            Some(path) => Err(Failure::found(format!("no judge at {}", path.display()))),
            None => Ok(Passed::Skipped("no judge (judge/judge.py) in a folder beside the repository".into())),
        };
    };
    if let Some(reason) = python_lacks() {
        return Ok(Passed::Skipped(reason));
    }
    let scenarios = scenarios(&judge)?;
    let truepath = repository::truepath(profile)?;
    let mut missed = Vec::new();
    println!("{:<20} {:>10} {:>9} {:>8} {:>8}  minimum", "scenario", "before mm", "after mm", "factor", "correct");
    for scenario in &scenarios {
        let name = scenario.file_stem().unwrap_or_default().to_string_lossy();
        let minimum = MINIMA.iter().find(|(listed, _)| *listed == name).map(|m| m.1);
        match correct(&truepath, &judge, scenario, &name) {
            Ok((score, seconds)) => {
                let verdict = if score.reaches(minimum) { "reached" } else { "MISSED" };
                let (before, after, factor) = (score.before_mm, score.after_mm, score.factor());
                println!(
                    "{name:<20} {before:>10.4} {after:>9.4} {factor:>7.1}x {seconds:>6.2} s  {} {verdict}",
                    describe(minimum)
                );
                if !score.reaches(minimum) {
                    missed.push(name.into_owned());
                }
            }
            Err(failure) => {
                let (Failure::Found(reason) | Failure::Missing(reason)) = failure;
                println!("{name:<20} failed: {reason}");
                missed.push(name.into_owned());
            }
        }
    }
    for (listed, _) in MINIMA {
        if !scenarios.iter().any(|s| s.file_stem().is_some_and(|stem| stem == *listed)) {
            println!("{listed:<20} not among the judge's scenarios");
        }
    }
    if let Some(judge) = beside("judge3/judge3.py") {
        plan_all(&truepath, &judge, &mut missed)?;
    }
    if missed.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(format!("missed: {}", missed.join(", ")))) }
}

/// Times better that a planned wall has to be at its worst height, and the machining time it may take for it.
const PLANNED: (f64, f64) = (8.0, 3.5);

/// Plans every scenario for its tolerance and has the written program scored at every height.
fn plan_all(truepath: &Path, judge: &Path, missed: &mut Vec<String>) -> Result<(), Failure> {
    println!(
        "\n{:<20} {:>10} {:>9} {:>8} {:>9} {:>6} {:>8}",
        "every height", "before mm", "after mm", "factor", "tolerance", "time", "plan"
    );
    for scenario in scenarios(judge)? {
        let name = scenario.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match planned(truepath, judge, &scenario, &name) {
            Ok(line) => {
                let (least, most) = PLANNED;
                let reached = line.after <= line.tolerance && line.before / line.after >= least && line.ratio <= most;
                println!(
                    "{name:<20} {:>10.4} {:>9.4} {:>7.1}x {:>9.4} {:>5.2}x {:>6.1} s  {}",
                    line.before,
                    line.after,
                    line.before / line.after,
                    line.tolerance,
                    line.ratio,
                    line.seconds,
                    if reached { "reached" } else { "MISSED" }
                );
                if !reached {
                    missed.push(name);
                }
            }
            Err(failure) => {
                let (Failure::Found(reason) | Failure::Missing(reason)) = failure;
                println!("{name:<20} failed: {reason}");
                missed.push(name);
            }
        }
    }
    Ok(())
}

/// What became of a plan: largest errors at any height, mm, and machining time over that of the program.
struct Planned {
    before: f64,
    after: f64,
    tolerance: f64,
    ratio: f64,
    seconds: f64,
}

fn planned(truepath: &Path, judge: &Path, scenario: &Path, name: &str) -> Result<Planned, Failure> {
    let folder = target().join("judge").join(name);
    let python = |verb: &str| {
        let mut command = program("python3");
        command.arg(judge).arg(verb).arg(scenario);
        command
    };
    let wanted = std::fs::read_to_string(scenario).map_err(|e| Failure::found(format!("{name}: {e}")))?;
    let lacks = || Failure::found(format!("{name}: no figure where one was expected"));
    let tolerance = number(&wanted, "profile_tolerance_mm").ok_or_else(lacks)?;
    read(python("make").arg(&folder))?;
    let mut truepath = Command::new(truepath);
    truepath.current_dir(&folder).args(["plan", "job.toml", "--probe", "probe.txt", "--tolerance"]);
    truepath.arg(tolerance.to_string()).args(["--write", "-o", "planned", "--force"]);
    let start = Instant::now();
    read(&mut truepath)?;
    let seconds = start.elapsed().as_secs_f64();
    let said = read(python("score").arg(folder.join("planned").join("planned.nc")))?;
    let profile = |of: &str| said.split_once(&format!("\"{of}\":")).and_then(|(_, rest)| number(rest, "profile_max"));
    let (before, after) = (profile("before").ok_or_else(lacks)?, profile("after").ok_or_else(lacks)?);
    Ok(Planned { before, after, tolerance, ratio: number(&said, "time_ratio").ok_or_else(lacks)?, seconds })
}

/// Makes the part, corrects it, has it scored. Returns the score and the seconds the correction took.
fn correct(truepath: &Path, judge: &Path, scenario: &Path, name: &str) -> Result<(Score, f64), Failure> {
    let folder = target().join("judge").join(name);
    let python = |verb: &str| {
        let mut command = program("python3");
        command.arg(judge).arg(verb).arg(scenario);
        command
    };
    read(python("make").arg(&folder))?;
    let mut truepath = Command::new(truepath);
    truepath.current_dir(&folder).args(["correct", "job.toml", "--probe", "probe.txt", "-o", "corrected", "--force"]);
    let start = Instant::now();
    read(&mut truepath)?;
    let seconds = start.elapsed().as_secs_f64();
    let said = read(python("score").arg(folder.join("corrected").join("corrected.nc")))?;
    let score = Score::read(&said).ok_or_else(|| Failure::found(format!("the judge said: {}", said.trim())))?;
    Ok((score, seconds))
}

/// A judge in a folder beside the repository; the first by name.
fn beside(name: &str) -> Option<PathBuf> {
    let folders = root().parent()?.read_dir().ok()?;
    let mut found: Vec<PathBuf> = folders.flatten().map(|f| f.path().join(name)).filter(|p| p.is_file()).collect();
    found.sort();
    found.into_iter().next()
}

/// The scenarios beside the judge, by name.
fn scenarios(judge: &Path) -> Result<Vec<PathBuf>, Failure> {
    let folder = judge.with_file_name("scenarios");
    let entries = folder.read_dir().map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
    let mut found: Vec<PathBuf> =
        entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    found.sort();
    if found.is_empty() { Err(Failure::found(format!("no scenario in {}", folder.display()))) } else { Ok(found) }
}

/// Why the judge cannot be run by the Python at hand, after an attempt to install what it needs.
fn python_lacks() -> Option<String> {
    let imports = || succeeds(program("python3").args(["-c", &format!("import {}", MODULES.join(", "))]));
    if imports() {
        return None;
    }
    if may_install() {
        let pip =
            |more: &[&str]| run(program("python3").args(["-m", "pip", "install", "--quiet"]).args(more).args(MODULES));
        // Debian's Python refuses to be installed into without being told so.
        if (pip(&[]).is_ok() || pip(&["--break-system-packages"]).is_ok()) && imports() {
            return None;
        }
    }
    Some(format!("the judge needs python3 with {} (pip install {})", MODULES.join(" and "), MODULES.join(" ")))
}

fn describe(minimum: Option<Minimum>) -> String {
    match minimum {
        Some(Minimum::After(limit)) => format!("<= {limit:.3} mm"),
        Some(Minimum::Factor(least)) => format!(">= {least:.0}x"),
        None => "better".into(),
    }
}

/// The number behind a key in a flat JSON object.
fn number(json: &str, key: &str) -> Option<f64> {
    let (_, behind) = json.split_once(&format!("\"{key}\":"))?;
    behind.split([',', '}']).next()?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_score_is_read_from_the_judges_line() {
        let said = r#"{"name": "corner-plain", "before_mm": 0.2971, "after_mm": 0.0006, "worst_height_after_mm": 0.5}"#;
        assert_eq!(Score::read(said), Some(Score { before_mm: 0.2971, after_mm: 0.0006 }));
        assert_eq!(Score::read("Traceback"), None);
    }

    #[test]
    fn a_minimum_is_missed_by_more_error_or_by_a_smaller_factor() {
        let score = |after_mm: f64| Score { before_mm: 0.3, after_mm };
        assert!(
            score(0.010).reaches(Some(Minimum::After(0.010))) && !score(0.0101).reaches(Some(Minimum::After(0.010)))
        );
        assert!(score(0.02).reaches(Some(Minimum::Factor(10.0))) && !score(0.04).reaches(Some(Minimum::Factor(10.0))));
        assert!(score(0.29).reaches(None) && !score(0.31).reaches(None) && !score(f64::NAN).reaches(None));
    }
}
