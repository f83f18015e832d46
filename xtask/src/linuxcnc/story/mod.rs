//! The whole story on LinuxCNC: a part milled as it comes, its wall touched, the next one milled with what was learned.
//!
//! Three sessions of the sample machine. In the first, LinuxCNC runs the programs of both parts uncorrected; the plant
//! cuts along the tool path that was recorded. In the second, the touch probe of the sample machine finds those walls:
//! LinuxCNC runs the programs of `truepath probe` and writes their logs. `truepath correct` makes images of them. In the
//! third, `M160` arms them, and the plant cuts along the recorded, corrected path. What a machinist would do, with the
//! plant in the place of the cutter and the steel.
//!
//! The plant shares no physics with the correction, and its machine is not that of the jobs: those only guess.

mod outcome;
mod path;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::Value;

use super::check::equal::{Replay, compare};
use super::install;
use super::machine::sample::Sample;
use super::machine::session::{self, End};
use super::notes::{self, Notes};
use super::recording::Recording;
use super::suite::settings;
use crate::repository::{self, Profile, program, read, root, target};
use crate::step::{Failure, Outcome, Passed};
use outcome::{Part, Told};
use path::Placed;

/// Parts of the sample machine, with the places and heights at which each is touched.
const PARTS: [(&str, &str, &str); 2] = [("corner", "4", "1"), ("pocket", "6", "3")];

/// Tells it; `write` puts table and pictures into the document.
///
/// # Errors
/// Something does not run, or a wall is less than ten times better.
pub fn run(write: bool) -> Outcome {
    install::component_if_changed()?;
    let story = Story::begin()?;
    let uncorrected = story.session("uncorrected", &["uncorrected-corner", "uncorrected-pocket"])?;
    let mut before = Vec::new();
    for ((part, places, heights), (notes, recording)) in PARTS.iter().zip(&uncorrected) {
        before.push(story.mill(part, "before", notes, recording)?);
        story.lay_out_the_probing(part, places, heights)?;
    }
    let touched = story.session("touched", &["touched-corner", "touched-pocket"])?;
    for ((part, ..), (notes, _)) in PARTS.iter().zip(&touched) {
        story.correct(part, notes)?;
    }
    let corrected = story.session("corrected", &["corner", "pocket"])?;
    let mut told = Vec::new();
    for (((name, ..), before), (notes, recording)) in PARTS.iter().zip(before).zip(&corrected) {
        let after = story.mill(name, "after", notes, recording)?;
        let equal = story.replayed(name, notes, recording)?;
        told.push(Part { name, before, after, replayed: equal });
    }
    outcome::tell(&story.truepath, &told, &story.folder, write)?;
    Ok(Passed::Done)
}

/// The machine, the program, and where results go.
struct Story {
    sample: Sample,
    truepath: PathBuf,
    folder: PathBuf,
    settings: Vec<String>,
}

impl Story {
    fn begin() -> Result<Self, Failure> {
        let sample = Sample::fresh("story")?;
        let truepath = repository::truepath(Profile::Dev)?;
        sample.put(&truepath)?;
        sample.ready()?;
        let ini = fs::read_to_string(sample.ini()).map_err(|e| failed(&sample.ini(), &e))?;
        let folder = target().join("linuxcnc/story-results");
        fs::create_dir_all(&folder).map_err(|e| failed(&folder, &e))?;
        Ok(Self { sample, truepath, folder, settings: settings(&ini) })
    }

    /// A run of LinuxCNC: for each scenario its notes, and the recording of all.
    fn session(&self, name: &str, scenarios: &[&str]) -> Result<Vec<(Notes, Recording)>, Failure> {
        self.sample.user.own(&self.sample.folder)?;
        let begin = Instant::now();
        let folder = session::run(&self.sample, name, scenarios, End::Regular)?;
        eprintln!("    {:.0} s", begin.elapsed().as_secs_f64());
        let recording = Recording::read(&folder)?;
        let mut noted = notes::read(&folder)?;
        let mut found = Vec::new();
        for scenario in scenarios {
            let place = noted.iter().position(|n| n.name == *scenario);
            let notes = noted.swap_remove(place.ok_or_else(|| Failure::found(format!("{scenario} was not run")))?);
            if let Some(why) = &notes.failed {
                return Err(Failure::found(format!("{scenario}: {why}")));
            }
            let rows = recording.between(notes.from, notes.to).to_vec();
            found.push((notes, Recording { rows }));
        }
        Ok(found)
    }

    /// The plant's wall along the commanded and along the measured path.
    fn mill(&self, part: &str, when: &str, notes: &Notes, recording: &Recording) -> Result<Told, Failure> {
        let placed = Placed::of(notes)?;
        let mut judged = Vec::new();
        for (kind, text) in [("commanded", path::commanded(recording)), ("measured", path::measured(recording))] {
            let setpoints = self.folder.join(format!("{part}-{when}-{kind}.csv"));
            fs::write(&setpoints, text).map_err(|e| failed(&setpoints, &e))?;
            let out = self.folder.join(format!("{part}-{when}-{kind}"));
            let mut command = program(&self.truepath);
            command.args(["simulate", "--json", "--force", "--probed-wall"]).arg(self.job(part));
            command.arg("--plant").arg(root().join(format!("host-sim/demo/{part}/plant.toml")));
            command.arg("--setpoints").arg(&setpoints).args(placed.arguments()).arg("-o").arg(&out);
            judged
                .push(serde_json::from_str::<Value>(&read(&mut command)?).map_err(|e| Failure::found(e.to_string()))?);
        }
        let wall = self.folder.join(format!("{part}-{when}-measured/probed-wall.csv"));
        self.copy(&wall, &self.programs().join(format!("{part}-wall.csv")))?;
        Told::of(&judged).ok_or_else(|| Failure::found(format!("{part}: no wall was judged")))
    }

    /// The program that touches the wall, in the machine's folder.
    fn lay_out_the_probing(&self, part: &str, places: &str, heights: &str) -> Result<(), Failure> {
        let to = self.programs().join(format!("{part}-probe.ngc"));
        let mut command = program(&self.truepath);
        command.arg("probe").arg(self.job(part)).args(["--dialect", "linuxcnc", "--probe-tool", "9", "--force"]);
        command.args(["--points", places, "--heights", heights, "-o"]).arg(to);
        read(&mut command).map(drop)
    }

    /// An image from the log that LinuxCNC wrote, where the machine finds it.
    fn correct(&self, part: &str, notes: &Notes) -> Result<(), Failure> {
        let log = format!("{part}-probe-log.txt");
        let places = [self.sample.folder.clone(), self.sample.folder.join("sim"), self.programs()];
        let log =
            places.iter().map(|place| place.join(&log)).find(|log| log.exists()).ok_or_else(|| {
                Failure::found(format!("LinuxCNC wrote no {log}; it said: {}", notes.said.join("; ")))
            })?;
        let out = self.folder.join(format!("{part}-correction"));
        let mut command = program(&self.truepath);
        command.arg("correct").arg(self.job(part)).arg("--probe").arg(log);
        command.args(["--route", "coprocessor", "--force", "-o"]).arg(&out);
        read(&mut command)?;
        self.copy(&out.join("correction.tpi"), &self.programs().join(format!("{part}.tpi")))
    }

    /// Periods in which the component added what `truepath replay` adds.
    fn replayed(&self, part: &str, notes: &Notes, recording: &Recording) -> Result<usize, Failure> {
        let placed = Placed::of(notes)?;
        let replay = Replay {
            truepath: &self.truepath,
            image: &self.folder.join(format!("{part}-correction/correction.tpi")),
            folder: &self.folder,
            origin: placed.origin_nm,
            turn: placed.turn,
            settings: &self.settings,
            period_us: 1_000,
        };
        let serial = notes.number("serial").unwrap_or(0.0) as u32;
        compare(&recording.rows, part, serial, &replay).map(|equality| equality.corrected)
    }

    fn programs(&self) -> PathBuf {
        self.sample.folder.join("sim/programs")
    }
    fn job(&self, part: &str) -> PathBuf {
        self.programs().join(format!("{part}.toml"))
    }
    fn copy(&self, from: &Path, to: &Path) -> Result<(), Failure> {
        fs::copy(from, to).map(drop).map_err(|e| failed(from, &e))
    }
}

fn failed(file: &Path, error: &std::io::Error) -> Failure {
    Failure::found(format!("{}: {error}", file.display()))
}
