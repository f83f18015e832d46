//! `split`: for a single part. Half of the allowance is cut with a program of its own, the wall it leaves is probed, and
//! the second half is cut with the corrected program over the actual surface of the first.
//!
//! The first-pass program is the original with every pass along the wall moved half the allowance away from it; the job written
//! beside it is the original with that program and that allowance, so that the probe file of the first pass can be
//! inspected with it.

use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_core::units::Offset;
use truepath_correction::first_pass;
use truepath_ground::codes::J008;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::OutputFolder;
use truepath_ground::units::mm;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_program::{Purpose, RewriteOptions, rewrite_program};

use crate::command::rewritten_job::job_of;
use crate::terminal::Terminal;

/// The program of the first pass.
const PROGRAM: &str = "first-pass.nc";
/// Its job.
const JOB: &str = "first-pass.toml";

/// What is split.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job of the whole allowance.
    pub job: PathBuf,
    /// Folder for first-pass.nc and first-pass.toml.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The feature of the job, or of the markers in the program; needed when there are several to correct.
    #[arg(long, value_name = "ID")]
    pub feature: Option<String>,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
}

/// What was written.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Split {
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// The program to mill first.
    pub program: PathBuf,
    /// Its job.
    pub job: PathBuf,
    /// Stock that each of the two passes takes, mm.
    pub allowance_mm: f64,
    /// Lines and arcs of the first pass.
    pub moves: usize,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// Splits, and prints what to do next.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let split = run(options)?;
    terminal.warn_all(&split.warnings);
    terminal.tell(&split, || words(&split, &options.job))
}

fn words(split: &Split, job: &FilePath) -> String {
    let (program, first, job) = (split.program.display(), split.job.display(), job.display());
    format!(
        "{program}: the contour {:.3} {name} away from the wall in {}; the second pass takes the other {:.3} {name}\n\
         next:\n\
         1. mill {program} and leave the part clamped\n\
         2. probe its wall: truepath probe {first} ..., or your own probing routine\n\
         3. truepath correct {job} --first-pass {first} --probe FILE -o DIR\n\
         4. mill the corrected program\n",
        split.unit.of(split.allowance_mm),
        counted(split.moves, "move"),
        split.unit.of(split.allowance_mm),
        name = split.unit.name()
    )
}

/// Writes program and job of the first pass.
///
/// # Errors
/// Whatever is wrong with job or program, an inside corner without room for the first pass, and outputs that cannot be
/// written.
pub fn run(options: &Options) -> Result<Split, Failure> {
    let mut job = JobFile::read(&options.job)?;
    job.which.feature = options.feature.clone();
    let pass = Pass::read(job)?;
    if let Some(key) = pass.job.measured_stock() {
        let help = "split the job of the whole, even allowance";
        let found = format!("{key} is given: the allowance is not even");
        let error = InputError::new(J008, found, "a job with stock.allowance_mm alone", help);
        return Err(error.at(pass.job.source(), pass.job.span(key)).into());
    }
    let half = Offset::from_nm(pass.job.numbers.allowance.nm() / 2);
    let edits = first_pass::edits(&pass, half)?;
    let folder = OutputFolder::create(&options.output, options.force, &[PROGRAM, JOB])?;
    let rewrite = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        purpose: Purpose::FirstPass { left: half },
        ..RewriteOptions::default()
    };
    let written = rewrite_program(&pass.program, &edits, &rewrite)?;
    folder.write(PROGRAM, &written.text)?;
    let said =
        format!("The first of two passes; the second is corrected with: truepath correct ... --first-pass {JOB}");
    folder.write(
        JOB,
        job_of(&pass, &written, (PROGRAM, &options.output), Some(half), Some(pass.core.setup.wall), &said)?.as_bytes(),
    )?;
    folder.commit()?;
    Ok(Split {
        unit: pass.unit(),
        program: options.output.join(PROGRAM),
        job: options.output.join(JOB),
        allowance_mm: mm(half),
        moves: written.difference.straight_moves + written.difference.arcs,
        warnings: pass.warnings.clone(),
    })
}
