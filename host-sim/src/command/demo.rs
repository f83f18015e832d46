//! `demo`: the whole story on three parts. Each is milled by the plant, which is no model of the core, touched with a
//! probe, corrected, and milled again with the corrected program.

use std::collections::VecDeque;
use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_chart::view::View;
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::codes::F003;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Milled, Score};
use truepath_report::page::render;
use truepath_report::pages::{REPORT, demonstrated};
use truepath_report::plot::Wall;
use truepath_report::{correction_csv, plot, points_csv, wall_csv};
use truepath_trial::virtual_mill;

use crate::terminal::Terminal;

/// Where the story goes, and what becomes of files that lie there already: they are replaced as long as they are what
/// would be written now, and one that is not stops the command.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Folder for the programs, probe files, corrections, reports and pictures.
    #[arg(short, long, value_name = "DIR", default_value = "out/demo")]
    pub output: PathBuf,
    /// Keep the files of an earlier run: stop when there are some.
    #[arg(long)]
    pub keep: bool,
    /// Replace the files of an earlier run, edited ones too.
    #[arg(long, conflicts_with = "keep")]
    pub force: bool,
}

/// Tells the story and prints what came of it.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let outcomes = terminal.watch("milling, probing, correcting, milling again", |progress| run(options, progress))?;
    terminal.tell(&outcomes, || words(&outcomes))
}

fn words(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "Each part was milled on a virtual machine, touched with a probe, corrected, and milled again.\n\
         Largest error of the wall, as the virtual machine left it, mm:\n\n\
         part                                                          points   mean over the height   at any height\n",
    );
    for o in outcomes {
        text += &format!(
            "{:<62}{:>6}{:>14.3} -> {:.3}{:>11.3} -> {:.3}\n",
            o.title, o.points, o.before_mm, o.after_mm, o.worst_height_before_mm, o.worst_height_after_mm
        );
    }
    let worst = outcomes.iter().max_by(|a, b| a.left_over_the_height().total_cmp(&b.left_over_the_height()));
    if let Some(o) = worst.filter(|o| o.left_over_the_height() > 0.0) {
        let file = |name: &str| o.folder.join(name).display().to_string();
        let tolerance = (o.before_mm / 8.0 * 1e3).round() / 1e3;
        text += &format!(
            "\nA helical tooth makes the wall at each height at another instant, which no shift in X and Y cures. What does:\n  \
             truepath plan {} --probe {} --tolerance {tolerance}\n",
            file("job.toml"),
            file("probe.txt")
        );
    }
    text += "\nA virtual machine repeats exactly; on a real one add what it does not repeat (the floor, in docs/learning.md).\n";
    text += "\nLook at the reports (open them in a browser):\n";
    for o in outcomes {
        text += &format!("  {}\n", o.folder.join(REPORT).display());
    }
    text += "Pictures (before-after.svg), corrected programs (corrected.nc) and images for the coprocessor (correction.tpi) lie\n\
             beside them.\n";
    text
}

/// A part of the story.
struct Story {
    name: &'static str,
    title: &'static str,
    program: &'static str,
    job: &'static str,
    plant: &'static str,
    /// Places to probe, mm along the contour.
    places: &'static [f64],
    /// Heights to probe, fractions of the engaged depth.
    levels: &'static [f64],
}

const STORIES: &[Story] = &[
    Story {
        name: "corner",
        title: "The corner of the 2018 and 2023 papers, mean force",
        program: include_str!("../../demo/corner/program.nc"),
        job: include_str!("../../demo/corner/job.toml"),
        plant: include_str!("../../demo/corner/plant.toml"),
        places: &[30.0, 75.0],
        levels: &[0.5],
    },
    Story {
        name: "corner-helix",
        title: "The same corner, helical cutter with edge forces and bending",
        program: include_str!("../../demo/corner-helix/program.nc"),
        job: include_str!("../../demo/corner-helix/job.toml"),
        plant: include_str!("../../demo/corner-helix/plant.toml"),
        places: &[20.0, 32.0, 49.0, 68.0, 80.0],
        levels: &[0.1, 0.5, 0.9],
    },
    Story {
        name: "pocket",
        title: "A finishing pass round a pocket",
        program: include_str!("../../demo/pocket/program.nc"),
        job: include_str!("../../demo/pocket/job.toml"),
        plant: include_str!("../../demo/pocket/plant.toml"),
        places: &[12.0, 45.0, 92.0, 145.0, 180.0],
        levels: &[0.1, 0.5, 0.9],
    },
];

const FILES: &[&str] = &[
    "program.nc",
    "job.toml",
    "plant.toml",
    "probe.txt",
    "corrected.nc",
    "difference.txt",
    "correction.tpi",
    "correction.csv",
    "wall.csv",
    "summary.json",
    "before-after.svg",
    "points.csv",
    REPORT,
];

/// One line of the table.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Outcome {
    /// Folder of the part.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Probe points taken.
    pub points: usize,
    /// Largest wall error of the first part, mean over height, mm.
    pub before_mm: f64,
    /// Largest error of the first part at any height, mm.
    pub worst_height_before_mm: f64,
    /// Largest error of the corrected part at any height, mm.
    pub worst_height_after_mm: f64,
    /// What the model expected to remain, mm.
    pub expected_after_mm: f64,
    /// Largest wall error of the corrected part, as milled by the plant, mm.
    pub after_mm: f64,
    /// before/after.
    pub factor: f64,
    /// Root mean square before, mm.
    pub rms_before_mm: f64,
    /// Root mean square after, mm.
    pub rms_after_mm: f64,
    /// What no XY correction can remove: spread over the height, after, mm.
    pub axial_form_mm: f64,
    /// Folder with the files.
    pub folder: PathBuf,
}

impl Outcome {
    /// What the corrected part is worse at some height than in the mean over it, mm.
    fn left_over_the_height(&self) -> f64 {
        self.worst_height_after_mm - self.after_mm
    }
}

/// The folder of a part on its way.
struct Part<'a> {
    story: &'a Story,
    place: PathBuf,
    folder: OutputFolder,
    options: &'a Options,
}

impl<'a> Part<'a> {
    fn create(story: &'a Story, options: &'a Options) -> Result<Self, InputError> {
        let place = options.output.join(story.name);
        let folder = OutputFolder::create(&place, !options.keep, FILES)?;
        let part = Self { story, place, folder, options };
        // Before the work: these are what a user edits.
        for (name, text) in part.inputs() {
            part.write(name, text.as_bytes())?;
        }
        Ok(part)
    }

    fn inputs(&self) -> [(&'static str, &'static str); 3] {
        [("program.nc", self.story.program), ("job.toml", self.story.job), ("plant.toml", self.story.plant)]
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), InputError> {
        let there = self.place.join(name);
        if !self.options.force && files::read(&there).is_ok_and(|found| found != bytes) {
            let found = format!("{} is not what the demonstration writes", there.display());
            let help =
                "name another folder with -o, or add --force to replace what was edited or is of another version";
            return Err(InputError::new(F003, found, "a file as it was written", help).in_file(&there));
        }
        self.folder.write(name, bytes)
    }
}

/// Tells the story; every part gets a folder, all of them when everything is done. `progress` is told the share done, 0…1.
///
/// # Errors
/// Outputs that cannot be written, files that are in their way.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<Vec<Outcome>, Failure> {
    // The first one is dropped last: it made the folder around them and takes it away again when nothing came to lie in it.
    let mut parts = VecDeque::new();
    for story in STORIES {
        parts.push_front(Part::create(story, options)?);
    }
    let mut outcomes = Vec::new();
    for (k, part) in parts.iter().rev().enumerate() {
        let done = |share: f64| (k as f64 + share) / STORIES.len() as f64;
        outcomes.push(tell(part, &mut |share| progress(done(share)))?);
    }
    for part in parts.into_iter().rev() {
        part.folder.commit()?;
    }
    Ok(outcomes)
}

fn tell(part: &Part, progress: &mut dyn FnMut(f64)) -> Result<Outcome, Failure> {
    let story = part.story;
    let source = |name: &str, text: &str| Source::new(format!("demo/{}/{name}", story.name), text.as_bytes().to_vec());
    let job = JobFile::parse(source("job.toml", story.job), FilePath::new(""))?;
    let machine = toml::from_str(story.plant).map_err(|e| Failure::Internal(format!("demo plant: {e}")))?;
    let pass = Pass::new(job, source("program.nc", story.program))?;

    let first = virtual_mill::mill(&pass, &machine, None)?;
    progress(0.3);
    let ball = truepath_ground::units::mm(pass.job.require_probe()?.ball_diameter);
    let probe = virtual_mill::probe(&pass, &first, story.places, story.levels, ball)?;
    let file = source("probe.txt", &probe);
    let measurement = Measurement::read(&pass, &file)?;

    let remarks = measurement.remarks(&file);
    // A user takes one of the routes; the demonstration shows both.
    let routes = [Route::Program, Route::Coprocessor];
    let corrected = correct_pass(&pass, &measurement, &remarks, &routes, &mut |share| progress(0.3 + 0.3 * share))?;
    let text = corrected.program.as_deref().unwrap_or_default();
    let second = virtual_mill::mill(&pass, &machine, Some(&virtual_mill::commanded(&pass, text)?))?;
    progress(0.9);
    let (before, after) = (first.score(), second.score());

    part.write("probe.txt", probe.as_bytes())?;
    part.write("corrected.nc", text)?;
    part.write("difference.txt", corrected.summary.difference("program.nc").as_bytes())?;
    part.write("correction.tpi", corrected.image.as_deref().unwrap_or_default())?;
    part.write("correction.csv", &correction_csv(&corrected.rows)?)?;
    part.write("wall.csv", &wall_csv(&corrected.rows)?)?;
    part.write("summary.json", &json(&corrected.summary)?)?;
    part.write("before-after.svg", &picture(story, (&first, &before), (&second, &after))?)?;
    part.write("points.csv", &points_csv(&measurement, &corrected.identified.observations)?)?;
    let page = demonstrated(story.title, &pass, &measurement, &corrected, [(&first, &before), (&second, &after)])?;
    part.write(REPORT, &render(&page)?)?;
    progress(1.0);
    Ok(outcome(story, &part.place, &measurement, &corrected, &before, &after))
}

fn outcome(
    story: &Story,
    folder: &FilePath,
    measurement: &Measurement,
    corrected: &CorrectedPass,
    before: &Score,
    after: &Score,
) -> Outcome {
    Outcome {
        name: story.name,
        title: story.title,
        points: measurement.contacts.len(),
        before_mm: before.max_error_mm,
        worst_height_before_mm: before.worst_height_mm,
        worst_height_after_mm: after.worst_height_mm,
        expected_after_mm: corrected.summary.max_error_after_mm,
        after_mm: after.max_error_mm,
        factor: before.max_error_mm / after.max_error_mm.max(1e-9),
        rms_before_mm: before.rms_error_mm,
        rms_after_mm: after.rms_error_mm,
        axial_form_mm: after.axial_form_mm,
        folder: folder.to_owned(),
    }
}

fn picture(
    story: &Story,
    (first, before): (&Milled, &Score),
    (second, after): (&Milled, &Score),
) -> Result<Vec<u8>, Failure> {
    let wall = |milled: &Milled, what: &str, score: &Score, colour| {
        Wall::of_milled(format!("{what}: largest error {:.3} mm", score.max_error_mm), colour, milled)
    };
    let walls = [
        wall(first, "first part", before, truepath_chart::style::INK_BEFORE),
        wall(second, "corrected part", after, truepath_chart::style::INK_AFTER),
    ];
    plot::error(&View::default(), story.title, &walls, None, &[])
}
