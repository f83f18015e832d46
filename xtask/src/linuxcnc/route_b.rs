//! Route B on the simulated machine: LinuxCNC sends its setpoints to the virtual board and drives by its answers.
//!
//! A corner milled through the board has to be, to the last nanometre, what `truepath replay` makes of the recorded
//! setpoints; a board that stands, is late or is reset in the cut has to stop the machine, without a jump.
//!
//! Limits: a slow servo period, because the emulator stands as long as a busy computer lets it.

use std::cell::RefCell;
use std::fs;

use super::check::case::Case;
use super::check::equal::{Replay, compare};
use super::check::link;
use super::machine::board::{PERIOD_US, VirtualBoard, slow_down};
use super::machine::sample::Sample;
use super::machine::session::{self, End};
use super::notes::{self, Notes};
use super::parts::{PARTS, Parts};
use super::recording::{JOINTS, Recording, Row};
use super::{install, suite};
use crate::step::{Failure, Outcome, Passed};

/// What checks a scenario.
type Check = fn(&Case);
/// Scenarios with what has to come of each, and whether it is replayed.
const SCENARIOS: [(&str, Check, bool); 5] = [
    ("board-corner", link::milled, true),
    ("board-pocket", link::milled, true),
    ("board-stopped", link::lost, false),
    ("board-late", link::lost, false),
    ("board-reset", link::reset, false),
];

/// Runs them all.
pub fn run() -> Outcome {
    install::component_if_changed()?;
    let sample = Sample::fresh("board")?;
    let parts = Parts::make(&sample)?;
    sample.ready()?;
    slow_down(&sample)?;
    let ini = fs::read_to_string(sample.ini()).map_err(|e| Failure::found(e.to_string()))?;
    let settings = suite::settings(&ini);
    let board = VirtualBoard::start(&sample, &parts.truepath, &PARTS.map(|part| parts.image(part)), &settings)?;
    let names = SCENARIOS.map(|(name, ..)| name);
    let folder = session::run(&sample, "board", &names, End::Regular)?;
    drop(board);
    let (recording, noted) = (Recording::read(&folder)?, notes::read(&folder)?);
    let (mut failed, mut compared) = (0, 0);
    for (name, check, replayed) in SCENARIOS {
        let found = match noted.iter().find(|notes| notes.name == name) {
            Some(notes) => {
                let rows = recording.between(notes.from, notes.to);
                let mut found = judged(notes, rows, check);
                // Where an answer is missing the correction stood, which a replay does not.
                let missed =
                    rows.last().map_or(0, |row| row.link_misses) - rows.first().map_or(0, |row| row.link_misses);
                if replayed && missed == 0 {
                    compared += 1;
                    match milled(&sample, &parts, &settings, notes, rows) {
                        Ok(corrected) => println!("{name}: {corrected} corrected periods as truepath replay has them"),
                        Err(Failure::Found(why) | Failure::Missing(why)) => found.push(why),
                    }
                }
                let number = |pin: &str| notes.number(&format!("truepath.{pin}")).unwrap_or(0.0);
                println!(
                    "{name}: {} periods, {} without an answer, {} late, longest {:.1} ms",
                    rows.len(),
                    number("link-misses"),
                    number("link-late"),
                    number("link-time-max") / 1e6
                );
                found
            }
            None => vec!["it was not run".to_owned()],
        };
        failed += usize::from(!found.is_empty());
        found.iter().for_each(|finding| eprintln!("{name}: {finding}"));
    }
    if compared == 0 {
        return Err(Failure::found(
            "answers were missing in every part, so none was compared: is the computer too busy?",
        ));
    }
    if failed == 0 { Ok(Passed::Done) } else { Err(Failure::found(format!("{failed} of {} scenarios", names.len()))) }
}

fn judged(notes: &Notes, rows: &[Row], check: fn(&Case)) -> Vec<String> {
    let found = RefCell::new(notes.failed.iter().map(|why| format!("the driver gave up: {why}")).collect());
    let case = Case { notes, rows, found };
    check(&case);
    case.found.into_inner()
}

/// Periods with a correction that are those of the replay; all are, or there is an error.
fn milled(sample: &Sample, parts: &Parts, settings: &[String], notes: &Notes, rows: &[Row]) -> Result<usize, Failure> {
    let pin = |name: &str| {
        let lacks = || Failure::found("the driver did not note the frame");
        notes.number(&format!("truepath.{name}")).ok_or_else(lacks)
    };
    let mut origin = [0; JOINTS];
    for (nm, axis) in origin.iter_mut().zip(["x", "y", "z"]) {
        *nm = (pin(&format!("offset-{axis}"))? * 1e6).round() as i64;
    }
    let replay = Replay {
        truepath: &parts.truepath,
        image: &parts.image(notes.word("program")),
        folder: &sample.folder.join("recordings"),
        period_us: PERIOD_US,
        origin,
        turn: [pin("frame-cosine")? as i64, pin("frame-sine")? as i64],
        settings,
    };
    compare(rows, &notes.name, notes.number("serial").unwrap_or(0.0) as u32, &replay).map(|equality| equality.corrected)
}
