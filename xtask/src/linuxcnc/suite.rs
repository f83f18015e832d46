//! All scenarios on the simulated machine: run, recorded, judged.

use std::fs;
use std::time::Instant;

use super::check::equal::{Equality, Replay, compare};
use super::check::limits::{Extremes, Joint, check};
use super::check::scenario::{ALL, Scenario};
use super::machine::sample::{Sample, number};
use super::machine::session::{self, End};
use super::notes::{self, Notes};
use super::parts::Parts;
use super::recording::{JOINTS, Recording, Row};
use super::{install, timing};
use crate::bench::table::replace;
use crate::repository::root;
use crate::step::{Failure, Outcome, Passed};

/// Servo periods per second of the sample machine.
const HZ: f64 = 1000.0;
/// Where the times stand.
const DOCUMENT: &str = "docs/linuxcnc.md";

/// Runs all scenarios, or one.
pub fn run(only: Option<&str>, write: bool) -> Outcome {
    let wanted: Vec<&Scenario> = ALL.iter().filter(|s| only.is_none_or(|name| name == s.name)).collect();
    if wanted.is_empty() {
        let names: Vec<&str> = ALL.iter().map(|s| s.name).collect();
        return Err(Failure::found(format!("there is no such scenario; there are: {}", names.join(", "))));
    }
    install::component_if_changed()?;
    let sample = Sample::fresh("machine")?;
    let parts = Parts::make(&sample)?;
    sample.ready()?;
    let ini = fs::read_to_string(sample.ini()).map_err(|e| Failure::found(e.to_string()))?;
    let bench = Bench::new(&ini, &parts, &sample)?;
    let mut verdicts = Vec::new();
    let mut rows = Vec::new();
    let names: Vec<&str> = wanted.iter().map(|s| s.name).collect();
    let begin = Instant::now();
    let folder = session::run(&sample, "main", &names, End::Regular)?;
    eprintln!("    {:.0} s", begin.elapsed().as_secs_f64());
    let recording = Recording::read(&folder)?;
    let noted = notes::read(&folder)?;
    for scenario in &wanted {
        let notes = noted.iter().find(|n| n.name == scenario.name);
        verdicts.push(bench.judge(scenario, notes, &recording));
    }
    rows.extend(recording.rows);
    let times = timing::table(&rows);
    println!("\n{times}");
    if write {
        replace(&root().join(DOCUMENT), "times in the servo thread", &times)?;
    }
    told(&verdicts)
}

/// What a scenario came to.
struct Verdict {
    name: &'static str,
    periods: usize,
    equality: Option<Equality>,
    extremes: Extremes,
    found: Vec<String>,
}

/// What recordings are judged by.
struct Bench<'a> {
    joints: [Joint; JOINTS],
    settings: Vec<String>,
    parts: &'a Parts,
    sample: &'a Sample,
}

impl<'a> Bench<'a> {
    fn new(ini: &str, parts: &'a Parts, sample: &'a Sample) -> Result<Self, Failure> {
        let mut joints = Vec::new();
        for joint in 0..JOINTS {
            let read = Joint::read(ini, joint, HZ);
            joints.push(read.ok_or_else(|| Failure::found(format!("the INI file lacks limits of joint {joint}")))?);
        }
        let joints = <[Joint; JOINTS]>::try_from(joints).map_err(|_| Failure::found("joints"))?;
        let settings = settings(ini);
        Ok(Self { joints, settings, parts, sample })
    }

    fn judge(&self, scenario: &Scenario, notes: Option<&Notes>, recording: &Recording) -> Verdict {
        let mut verdict = Verdict {
            name: scenario.name,
            periods: 0,
            equality: None,
            extremes: Extremes::default(),
            found: Vec::new(),
        };
        let Some(notes) = notes else {
            verdict.found.push("it was not run".to_owned());
            return verdict;
        };
        if let Some(why) = &notes.failed {
            verdict.found.push(format!("the driver gave up: {why}"));
        }
        for said in &notes.said {
            // What LinuxCNC stops a machine for.
            if ["following error", "limit"].iter().any(|word| said.contains(word)) {
                verdict.found.push(format!("LinuxCNC said: {said}"));
            }
        }
        let rows = recording.between(notes.from, notes.to);
        verdict.periods = rows.len();
        verdict.extremes = check(rows, &self.joints, &mut verdict.found);
        scenario.check(notes, rows, &mut verdict.found);
        if scenario.replayed {
            match self.replayed(scenario.name, notes, rows) {
                Ok(equality) => verdict.equality = Some(equality),
                Err(Failure::Found(why) | Failure::Missing(why)) => verdict.found.push(why),
            }
        }
        verdict
    }

    fn replayed(&self, name: &str, notes: &Notes, rows: &[Row]) -> Result<Equality, Failure> {
        let pin = |name: &str| notes.number(&format!("truepath.{name}"));
        let lacks = || Failure::found("the driver did not note the frame");
        let mut origin = [0; JOINTS];
        for (nm, axis) in origin.iter_mut().zip(["x", "y", "z"]) {
            *nm = (pin(&format!("offset-{axis}")).ok_or_else(lacks)? * 1e6).round() as i64;
        }
        let turn = [pin("frame-cosine").ok_or_else(lacks)? as i64, pin("frame-sine").ok_or_else(lacks)? as i64];
        let replay = Replay {
            truepath: &self.parts.truepath,
            image: &self.parts.image(notes.word("program")),
            folder: &self.sample.folder.join("recordings"),
            origin,
            turn,
            settings: &self.settings,
        };
        compare(rows, name, notes.number("serial").unwrap_or(0.0) as u32, &replay)
    }
}

/// What the component makes of the INI file, for the replay.
fn settings(ini: &str) -> Vec<String> {
    let nm = |section: &str, key: &str| number(ini, section, key).map(|mm| (mm * 1e6).round() as i64);
    let limits: Vec<String> = (0..6)
        .map(|joint| {
            let section = format!("JOINT_{joint}");
            match (nm(&section, "MIN_LIMIT"), nm(&section, "MAX_LIMIT")) {
                (Some(least), Some(greatest)) => format!("[{least},{greatest}]"),
                _ => format!("[{},{}]", i64::MIN, i64::MAX),
            }
        })
        .collect();
    vec![format!("joint_limits_nm=[{}]", limits.join(","))]
}

/// The table on the terminal, and the outcome.
fn told(verdicts: &[Verdict]) -> Outcome {
    println!(
        "{:<19} {:>8} {:>9} {:>8} {:>9} {:>9} {:>10} {:>10}",
        "scenario", "periods", "corrected", "largest", "velocity", "accel.", "following", "changed by"
    );
    println!(
        "{:<19} {:>8} {:>9} {:>8} {:>9} {:>9} {:>10} {:>10}",
        "", "", "= replay", "mm", "of limit", "of limit", "error mm", "mm"
    );
    for v in verdicts {
        let equal = v.equality.map_or("-".to_owned(), |e| e.corrected.to_string());
        let (e, said) = (v.extremes, if v.found.is_empty() { "" } else { "  FAILED" });
        println!(
            "{:<19} {:>8} {equal:>9} {:>8.4} {:>8.0}% {:>8.0}% {:>10.4} {:>10.4}{said}",
            v.name,
            v.periods,
            e.correction_mm,
            100.0 * e.velocity,
            100.0 * e.acceleration,
            e.following_error_mm,
            e.following_change_mm
        );
    }
    let mut findings = 0;
    for v in verdicts {
        for finding in &v.found {
            eprintln!("{}: {finding}", v.name);
            findings += 1;
        }
    }
    match findings {
        0 => Ok(Passed::Done),
        _ => Err(Failure::found(format!("{findings} findings in {} scenarios", verdicts.len()))),
    }
}
