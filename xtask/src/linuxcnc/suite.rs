//! All scenarios on the simulated machine: run, recorded, judged.

use std::fs;
use std::time::Instant;

use super::check::equal::{Equality, Replay, compare};
use super::check::limits::{Joint, check};
use super::check::scenario::{ALL, KILLED, SPENT, Scenario};
use super::machine::sample::{Sample, number};
use super::machine::session::{self, End};
use super::notes::{self, Notes};
use super::parts::Parts;
use super::recording::{JOINTS, Recording, Row};
use super::verdict::{self, Verdict};
use super::{install, timing};
use crate::repository::{program, root, run as run_command};
use crate::step::{Failure, Outcome};
use crate::table::replace;

/// Servo periods per second of the sample machine.
const HZ: f64 = 1000.0;
/// Where the times stand.
const DOCUMENT: &str = "docs/linuxcnc.md";

/// Runs all scenarios, or one.
pub fn run(only: Option<&str>, write: bool) -> Outcome {
    let asked: Vec<&str> = only.map(|names| names.split(',').collect()).unwrap_or_default();
    let mut wanted: Vec<&Scenario> = ALL.iter().filter(|s| only.is_none() || asked.contains(&s.name)).collect();
    if wanted.iter().any(|s| s.name == SPENT) && !wanted.iter().any(|s| s.name == KILLED) {
        // There has to be something that was armed before.
        wanted.extend(ALL.iter().filter(|s| s.name == KILLED));
    }
    if wanted.is_empty() {
        let names: Vec<&str> = ALL.iter().map(|s| s.name).collect();
        return Err(Failure::found(format!("there is no such scenario; there are: {}", names.join(", "))));
    }
    operators_component()?;
    install::component_if_changed()?;
    let sample = Sample::fresh("machine")?;
    let parts = Parts::make(&sample)?;
    sample.ready()?;
    let ini = fs::read_to_string(sample.ini()).map_err(|e| Failure::found(e.to_string()))?;
    let bench = Bench::new(&ini, &parts, &sample)?;
    let mut verdicts = Vec::new();
    let mut rows = Vec::new();
    // Killed last, and the machine started once more behind it.
    let (again, first): (Vec<&Scenario>, Vec<&Scenario>) = wanted.into_iter().partition(|s| s.name == SPENT);
    let end = if first.iter().any(|s| s.name == KILLED) { End::Killed } else { End::Regular };
    for (name, scenarios, end) in [("main", first, end), ("again", again, End::Regular)] {
        let names: Vec<&str> = scenarios.iter().map(|s| s.name).collect();
        if names.is_empty() {
            continue;
        }
        let begin = Instant::now();
        let folder = session::run(&sample, name, &names, end)?;
        eprintln!("    {:.0} s", begin.elapsed().as_secs_f64());
        let (recording, noted) = (Recording::read(&folder)?, notes::read(&folder)?);
        for scenario in scenarios {
            let notes = noted.iter().find(|n| n.name == scenario.name);
            verdicts.push(bench.judge(scenario, notes, &recording));
        }
        rows.extend(recording.rows);
    }
    let times = timing::table(&rows);
    println!("\n{times}");
    let outcome = verdict::tell(&verdicts)?;
    // Only what passed is documented.
    if write {
        replace(&root().join(DOCUMENT), "times in the servo thread", &times)?;
        replace(&root().join(DOCUMENT), "scenarios", &verdict::document(&verdicts))?;
    }
    Ok(outcome)
}

/// What a servo period of a scenario with a correction costs on the simulated machine, function by function: medians, µs.
pub fn typical_times(scenario: &str) -> Result<Vec<(&'static str, f64)>, Failure> {
    install::component_if_changed()?;
    let sample = Sample::fresh("times")?;
    let _parts = Parts::make(&sample)?;
    sample.ready()?;
    let folder = session::run(&sample, "times", &[scenario], End::Regular)?;
    Ok(timing::typical(&Recording::read(&folder)?.rows))
}

/// The tests of the operator's component, which need no LinuxCNC: Python's own `unittest`.
fn operators_component() -> Result<(), Failure> {
    let folder = root().join("linuxcnc/tests");
    // Without the folders of compiled files, which would lie among the sources.
    run_command(program("python3").args(["-B", "-m", "unittest", "discover", "--quiet", "-s"]).arg(folder))
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
        let mut verdict = Verdict { name: scenario.name, ..Verdict::default() };
        let Some(notes) = notes else {
            verdict.found.push("it was not run".to_owned());
            return verdict;
        };
        if let Some(why) = &notes.failed {
            verdict.found.push(format!("the driver gave up: {why}"));
        }
        verdict.said.clone_from(&notes.said);
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
            period_us: 1_000,
        };
        compare(rows, name, notes.number("serial").unwrap_or(0.0) as u32, &replay)
    }
}

/// What the component makes of the INI file, for the replay.
pub(super) fn settings(ini: &str) -> Vec<String> {
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
    let cap = |key| number(ini, "TRUEPATH", key).map(|mm| format!("{:.0}", mm * 1e6));
    let caps = [
        ("correction_slew_nm_per_s", cap("MAX_CORRECTION_VEL")),
        ("correction_acceleration_nm_per_s2", cap("MAX_CORRECTION_ACCEL")),
    ];
    let caps = caps.into_iter().filter_map(|(name, value)| Some(format!("{name}={}", value?)));
    caps.chain([format!("joint_limits_nm=[{}]", limits.join(","))]).collect()
}
