//! `probe`: the verification program of a job.

use std::path::Path as FilePath;

use truepath_correction::verification::{Gained, KeptOff, Plan, ProbeDialect, Settings, Unknown, plan, write};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::OutputFile;
use truepath_job::job::{Job, ProbeFlags, Which};
use truepath_job::pass::Pass;

use super::probe_next;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// The control and the program to write; without them the places are listed only.
    pub program: Option<(ProbeDialect, &'a FilePath)>,
    /// Replace an existing file.
    pub force: bool,
    /// Choices.
    pub settings: Settings,
    /// What was measured, when further places are asked for.
    pub measured: Option<Evidence<'a>>,
    /// Feature and pass, when there are several.
    pub which: Which,
}

/// What was measured: one of the two at least.
#[derive(Clone, Debug)]
pub struct Evidence<'a> {
    /// A probe file.
    pub probe: Option<&'a FilePath>,
    /// What the command line says of it.
    pub flags: ProbeFlags,
    /// A folder of `correct` or `learn`, with its history.
    pub from: Option<&'a FilePath>,
}

/// A point of the program, for the list that is printed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Point {
    /// Its number in program and results.
    pub id: usize,
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Line of the part's program.
    pub line: u32,
    /// Nominal contact, mm.
    pub x_mm: f64,
    /// Nominal contact, mm.
    pub y_mm: f64,
    /// Programmed Z, mm.
    pub z_mm: f64,
    /// Unit normal from the wall to the free side.
    pub normal: [f64; 2],
    /// Height above the cutter's tip, mm.
    pub height_mm: f64,
    /// What is there.
    pub what: String,
    /// Why this place: what its touches tell.
    pub why: String,
    /// Why this height.
    pub why_height: &'static str,
    /// How many places were chosen before this one.
    pub rank: usize,
    /// What the touches of its place are expected to bring; absent when nothing was measured before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<Gained>,
}

/// Places looked at and kept off.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Kept {
    /// The reason.
    pub reason: KeptOff,
    /// In words.
    pub words: &'static str,
    /// How many.
    pub places: usize,
}

/// What was planned.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Report {
    /// The control; absent when no program was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dialect: Option<ProbeDialect>,
    /// `[probe] format` for the file of results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe_format: Option<&'static str>,
    /// Every touch, in the order of the program.
    pub points: Vec<Point>,
    /// Height between places, mm.
    pub safe_z_mm: f64,
    /// Distance of the ball's surface from the wall at the stand-off, mm.
    pub clearance_mm: f64,
    /// What the touches leave of every unknown.
    pub unknowns: Vec<Unknown>,
    /// Standard deviation of the wall before the touches, mm: of the predicted wall, root mean square, or, of further
    /// places, the largest of the corrected wall.
    pub wall_sigma_before_mm: f64,
    /// The same after them.
    pub wall_sigma_after_mm: f64,
    /// Where the plan keeps off.
    pub kept_off: Vec<Kept>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Plans and writes. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program or choices, and an output that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<Report, Failure> {
    // A target that may not be written is refused before the work.
    let mut file = options.program.map(|(_, out)| OutputFile::create(out, options.force)).transpose()?;
    let mut job = Job::read(options.job)?;
    job.which = options.which.clone();
    if let Some(measured) = &options.measured {
        job.override_probe(&measured.flags)?;
    }
    let pass = Pass::read(job)?;
    let plan = match &options.measured {
        None => plan(&pass, &options.settings, progress)?,
        Some(measured) => probe_next::of_files(pass, (measured.probe, measured.from), &options.settings, progress)?,
    };
    if let (Some((dialect, out)), Some(mut file)) = (options.program, file.take()) {
        let text = write(&plan, dialect, &log_name(out))?;
        std::io::Write::write_all(&mut file, text.as_bytes()).map_err(|e| InputError::unwritable(out, &e))?;
        file.commit()?;
    }
    Ok(report(&plan, options.program.map(|(dialect, _)| dialect)))
}

/// The report of a plan.
pub fn report(plan: &Plan, dialect: Option<ProbeDialect>) -> Report {
    let points = plan.touches().map(|touch| Point {
        id: touch.id,
        s_mm: touch.place.s_mm,
        line: touch.place.line,
        x_mm: touch.place.wall[0],
        y_mm: touch.place.wall[1],
        z_mm: touch.height.z_mm,
        normal: touch.place.normal,
        height_mm: touch.height.above_tip_mm,
        what: touch.place.what.clone(),
        why: touch.place.why.clone(),
        why_height: touch.height.why,
        rank: touch.place.rank,
        gain: touch.place.gain,
    });
    Report {
        dialect,
        probe_format: dialect.map(ProbeDialect::probe_format),
        points: points.collect(),
        safe_z_mm: plan.safe_z_mm,
        clearance_mm: plan.settings.clearance,
        unknowns: plan.unknowns.clone(),
        wall_sigma_before_mm: plan.wall_sigma_mm[0],
        wall_sigma_after_mm: plan.wall_sigma_mm[1],
        kept_off: plan
            .kept_off
            .iter()
            .map(|(reason, places)| Kept { reason: *reason, words: reason.words(), places: *places })
            .collect(),
        warnings: plan.warnings.clone(),
    }
}

/// Name of the file of results beside the program, in letters that no control stumbles over.
fn log_name(out: &FilePath) -> String {
    let stem = out.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let stem: String = stem.chars().filter(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')).collect();
    let stem = if stem.is_empty() { "verification" } else { &stem };
    format!("{stem}-log.txt")
}
