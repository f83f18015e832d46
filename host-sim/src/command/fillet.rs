//! `fillet`: small arcs on the sharp inside corners of the path, so that the correction has a way to turn on.
//!
//! The program and the job written are used in the place of the original ones, from the first part on: milled, touched,
//! corrected.

use std::path::PathBuf;

use clap::Args;
use truepath_correction::fillet::{Corner, rewritten};
use truepath_correction::summary::name_with;
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::{self, Remark, Unit};
use truepath_ground::output::OutputFolder;
use truepath_ground::units::{mm, nm, rounded};
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;

use crate::command::rewritten_job::job_of;
use crate::terminal::Terminal;

/// Its job.
const JOB: &str = "filleted.toml";
/// Radii that arcs may have on the path, mm.
const RADII: [f64; 2] = [0.02, 100.0];

/// What gets arcs.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// Radius of the wall's corners that the drawing allows, mm, or with its unit (0.1in): larger than the cutter's
    /// by the radius that the arcs will have on its path, best by a third of the cutter's or more.
    #[arg(long, value_name = "LENGTH", value_parser = length::flag)]
    pub corner_radius: f64,
    /// Folder for the program, part.filleted.nc by the name of the original, and filleted.toml.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The feature of the job, or of the markers in the program; otherwise every contour gets arcs.
    #[arg(long, value_name = "ID")]
    pub feature: Option<String>,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
}

/// What was written.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Report {
    /// The program to mill.
    pub program: PathBuf,
    /// Its job.
    pub job: PathBuf,
    /// The corners, in the order of the program.
    pub corners: Vec<Corner>,
    /// The unit in which they are told of.
    #[serde(skip)]
    pub unit: Unit,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// Writes, and prints what to do next.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let report = run(options)?;
    terminal.warn_all(&report.warnings);
    terminal.tell(&report, || words(&report))
}

fn words(report: &Report) -> String {
    let (unit, name) = (report.unit, report.unit.name());
    let mut text = String::new();
    for corner in report.corners.iter().filter(|corner| corner.radius_mm > 0.0) {
        text += &format!(
            "line {}: a corner of {:.1} degrees gets an arc of {} {name} on the path; up to {:.3} {name} more stay in the corner of the wall\n",
            corner.line,
            corner.turn_deg,
            unit.of(rounded(corner.radius_mm, 4)),
            unit.of(corner.left_mm)
        );
    }
    let (program, job) = (report.program.display(), report.job.display());
    text + &format!(
        "{program}: in place of the program from now on, if the drawing allows corners that are so round\n\
         next:\n\
         1. mill {program} on the first part\n\
         2. truepath probe {job} ..., or your own probing routine\n\
         3. truepath correct {job} --probe FILE -o DIR\n"
    )
}

/// Writes program and job.
///
/// # Errors
/// A radius no larger than the cutter's, whatever is wrong with job or program, a contour without a sharp inside corner that an arc has room in, and
/// outputs that cannot be written.
pub fn run(options: &Options) -> Result<Report, Failure> {
    let mut job = JobFile::read(&options.job)?;
    job.which.feature.clone_from(&options.feature);
    let contours = Pass::every(job)?;
    let passes: Vec<&Pass> = contours.iter().collect();
    let Some(pass) = passes.first() else { return Err(Failure::Internal("a program of no contour".to_owned())) };
    let cutter = mm(pass.core.setup.radius);
    let radius = options.corner_radius - cutter;
    if !(RADII[0]..=RADII[1]).contains(&radius) {
        let (unit, name) = (pass.unit(), pass.unit().name());
        let [wanted, own] = [options.corner_radius, cutter].map(|radius| unit.of(radius));
        let found = format!("--corner-radius {wanted} {name} with a cutter of {own} {name} radius");
        let [least, most] = RADII.map(|radius| unit.of(rounded(cutter + radius, 4)));
        let help = "give the radius of the wall's corners that the drawing allows; a cutter that is as wide as they are leaves them sharp on its path";
        return Err(InputError::new(C001, found, format!("{least} to {most} {name}"), help).into());
    }
    let (written, corners, said) = rewritten(&passes, nm(radius))?;
    let mut warnings: Vec<Remark> = Vec::new();
    for said in contours.iter().flat_map(|contour| &contour.warnings) {
        if !warnings.contains(said) {
            warnings.push(said.clone());
        }
    }
    warnings.extend(said.into_iter().map(Remark::from));
    warnings.extend(corners.iter().filter_map(|corner| beside(corner, radius, pass.unit()).map(Remark::from)));
    let name = name_with(pass.program.name(), "filleted");
    let side = pass.core.setup.wall;
    let wall = passes.iter().all(|other| other.core.setup.wall == side).then_some(side);
    if wall.is_none() && pass.job.numbers.wall.is_none() {
        warnings.push("the contours have their walls on different sides, which G41 and G42 said that are no longer in the program: write wall into a [[feature]] for each of them in filleted.toml".into());
    }
    let folder = OutputFolder::create(&options.output, options.force, &["*.filleted*", JOB])?;
    let said = "The program with arcs on its sharp inside corners, written by truepath fillet";
    let text = job_of(pass, &written, (&name, &options.output), None, wall, said)?;
    folder.write(&name, &written.text)?;
    folder.write(JOB, text.as_bytes())?;
    folder.commit()?;
    Ok(Report {
        program: options.output.join(&name),
        job: options.output.join(JOB),
        corners,
        unit: pass.unit(),
        warnings,
    })
}

/// What is said of a corner that did not get the radius.
fn beside(corner: &Corner, wanted: f64, unit: Unit) -> Option<String> {
    let line = corner.line;
    if corner.radius_mm == 0.0 {
        return Some(format!("line {line}: the lines beside this corner are too short for an arc: it stays sharp"));
    }
    let smaller = corner.radius_mm < wanted - 1e-6;
    smaller.then(|| {
        format!(
            "line {line}: this corner gets an arc of only {:.3} {} on the path, as the lines beside it are short",
            unit.of(corner.radius_mm),
            unit.name()
        )
    })
}
