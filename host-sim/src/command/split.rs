//! `split`: for a single part. Half of the allowance is cut with a program of its own, the wall it leaves is probed, and
//! the second half is cut with the corrected program over the actual surface of the first.
//!
//! The first-pass program is the original with its contour moved half the allowance away from the wall; the job written
//! beside it is the original with that program and that allowance, so that the probe file of the first pass can be
//! inspected with it.

use std::path::{Path as FilePath, PathBuf};

use toml_edit::{DocumentMut, value};
use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::Side;
use truepath_core::units::{Offset, Real};

use crate::diagnostics::{Failure, InputError};
use crate::job::Job;
use crate::output::OutputFolder;
use crate::pass::{Pass, PathBuffer};
use crate::program::{Purpose, RewriteOptions, rewrite_program};
use crate::report::{block_edits, mm};

/// The program of the first pass.
const PROGRAM: &str = "first-pass.nc";
/// Its job.
const JOB: &str = "first-pass.toml";

/// What is split.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job of the whole allowance.
    pub job: &'a FilePath,
    /// Output folder.
    pub out: &'a FilePath,
    /// Replace existing files.
    pub force: bool,
}

/// What was written.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Split {
    /// The program to mill first.
    pub program: PathBuf,
    /// Its job.
    pub job: PathBuf,
    /// Stock that each of the two passes takes, mm.
    pub allowance_mm: f64,
    /// Lines and arcs of the first pass.
    pub moves: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Writes program and job of the first pass.
///
/// # Errors
/// Whatever is wrong with job or program, an inside corner without room for the first pass, and outputs that cannot be
/// written.
pub fn run(options: &Options) -> Result<Split, Failure> {
    let pass = Pass::read(Job::read(options.job)?)?;
    if pass.surface.is_some() {
        let help = "split the job of the whole, even allowance";
        let found = "stock.surface is given: part of the allowance has been cut";
        let error = InputError::new("J008", found, "a job with stock.allowance_mm", help);
        return Err(error.at(pass.job.source(), pass.job.span("stock.surface")).into());
    }
    let half = Offset::from_nm(pass.job.numbers.allowance.nm() / 2);
    room(&pass, half)?;
    let folder = OutputFolder::create(options.out, options.force, &[PROGRAM, JOB])?;
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let rewrite = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        purpose: Purpose::FirstPass { left: half },
        ..RewriteOptions::default()
    };
    let written = rewrite_program(&pass.program, &block_edits(&pass, &path, &moved(&path, half)), &rewrite)?;
    folder.write(PROGRAM, &written.text)?;
    folder.write(JOB, job_text(&pass, half)?.as_bytes())?;
    folder.commit()?;
    Ok(Split {
        program: options.out.join(PROGRAM),
        job: options.out.join(JOB),
        allowance_mm: mm(half),
        moves: written.difference.straight_moves + written.difference.arcs,
        warnings: pass.warnings.clone(),
    })
}

/// Every place of the contour moved away from the wall.
fn moved(path: &Path, by: Offset) -> Vec<Node> {
    let contour = &path.samples()[path.first()..path.first() + path.count()];
    contour.iter().map(|sample| Node { chip: -sample.normal.times(by), ..Node::default() }).collect()
}

/// Refuses an inside corner that the path of the first pass would have to cut across.
fn room(pass: &Pass, half: Offset) -> Result<(), Failure> {
    let left = pass.core.setup.wall == Side::Left;
    let refuse = |line: u32, found: String| {
        let help = "give the path an arc there, or leave less stock before this pass";
        let expected = format!("inside arcs of more than half the allowance, {} mm", mm(half));
        let place = pass.program.span_at(line, 1, u32::MAX);
        Err(InputError::new("P020", found, expected, help).at(&pass.program, place).into())
    };
    for (index, block) in pass.blocks.iter().enumerate() {
        // Turning away from the wall is an inside corner of the part.
        let inside = |turn_left: bool| turn_left != left;
        if let Some(radius) = block.curve.signed_radius()
            && inside(radius > Offset::ZERO)
            && radius.abs() <= half
        {
            return refuse(block.line, format!("an inside arc of radius {} mm on the cutter's path", mm(radius.abs())));
        }
        let next = pass.blocks.get(index + 1);
        if let Some(next) = next {
            let (from, to) = (block.curve.end_heading(), next.curve.start_heading());
            let turn = from.cross(to);
            if turn.abs() > SHARP && inside(turn > Real::ZERO) {
                return refuse(next.line, "a sharp inside corner".to_owned());
            }
        }
    }
    Ok(())
}

/// Sine of the turn between two blocks from which on a corner counts as sharp: about 3 degrees.
const SHARP: Real = Real::ratio(5, 100);

/// The job of the first pass: the original text, comments included, with another program and allowance.
fn job_text(pass: &Pass, half: Offset) -> Result<String, Failure> {
    let text = String::from_utf8_lossy(pass.job.source().bytes()).into_owned();
    let mut document: DocumentMut =
        text.parse().map_err(|e| Failure::Internal(format!("the job cannot be edited: {e}")))?;
    document["program"] = value(PROGRAM);
    document["stock"]["allowance_mm"] = value(mm(half));
    Ok(format!(
        "# The first of two passes; the second is corrected with: truepath correct ... --first-pass {JOB}\n{document}"
    ))
}
