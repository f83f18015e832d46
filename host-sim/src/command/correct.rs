//! `correct`: from a probe file to the corrected program or the correction image.

use std::path::Path as FilePath;

use truepath_correction::correct::correct;
use truepath_correction::learning::History;
use truepath_correction::second_pass;
use truepath_correction::summary::CorrectSummary;
use truepath_correction::warnings::misread;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{Job, ProbeFlags, Route, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_program::first_pass_of;
use truepath_report::page::render;
use truepath_report::pages;
use truepath_report::pages::{Points, REPORT};

use super::correction_files::{FILES, HISTORY, write};
use super::replaced::refuse_replacing;

/// What is corrected.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// The probe file.
    pub probe: &'a FilePath,
    /// Output folder.
    pub out: &'a FilePath,
    /// Replace existing files.
    pub force: bool,
    /// `--route`, over that of the job.
    pub route: Option<Route>,
    /// The job of the first of two passes: the probe file is of its wall.
    pub first_pass: Option<&'a FilePath>,
    /// What the command line says of the probe file.
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    pub which: Which,
}

/// Corrects and writes the outputs.
///
/// # Errors
/// As [`correct`], and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<CorrectSummary, Failure> {
    let read = |job: &FilePath| {
        let mut job = Job::read(job)?;
        job.override_probe(&options.probe_flags)?;
        job.which = options.which.clone();
        Pass::read(job)
    };
    let pass = read(options.job)?;
    let file = Source::read(options.probe)?;
    let first = options.first_pass.map(read).transpose()?;
    let (pass, first, measurement) = match first {
        None => {
            let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
            (pass, None, measurement)
        }
        Some(first) => {
            let (first, measurement) = Measurement::of_any_depth(first, &file)?;
            let pass = if pass.plan.is_some() { pass.at_level(first.level())? } else { pass };
            (pass, Some(first), measurement)
        }
    };
    let folder = OutputFolder::create(options.out, options.force, FILES)?;
    if first.is_none() {
        refuse_replacing(options.out, options.probe, &pass, &measurement)?;
    }
    let route = options.route.unwrap_or(pass.job.route);
    let mut remarks = measurement.remarks(&file);
    if first.is_none() && first_pass_of(pass.program.bytes()).is_some() {
        remarks.push(
            "this job is that of a first pass: the corrected program leaves the stock of the second pass, on the next part. For the second pass of this part correct the job that was split, with --first-pass"
                .to_owned(),
        );
    }
    remarks.extend(misread(first.as_ref().unwrap_or(&pass), first.is_some(), &measurement.contacts));
    let (pass, done, points) = match &first {
        None => {
            let done = correct(&pass, &measurement, &remarks, &[route], progress)?;
            (pass, done, Points::ThisPass)
        }
        Some(first) => {
            let (done, surface) = second_pass::correct(&pass, first, &measurement, &remarks, &[route], progress)?;
            folder.write("first-pass-surface.csv", &surface.table())?;
            (pass.over(surface)?, done, Points::FirstPass)
        }
    };
    folder.write("probe-raw.txt", file.bytes())?;
    folder.write("summary.json", &json(&done.summary)?)?;
    if first.is_none() {
        folder.write(HISTORY, &History::first(&pass, &measurement, &done)?.text()?)?;
    }
    write(&folder, &pass, &measurement, &done)?;
    folder.write(REPORT, &render(&pages::corrected(&pass, &measurement, &done, points)?)?)?;
    folder.commit()?;
    Ok(done.summary)
}
