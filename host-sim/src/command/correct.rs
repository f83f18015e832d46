//! `correct`: from a probe file to the corrected program or the correction image.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_core::cut::Path;
use truepath_core::job;
use truepath_core::units::Offset;

use super::correction_files::{FILES, HISTORY, write};
use super::doubts::{cut_corrected, doubts, kinked, misread};
use super::feeds;
use super::levels::{self, Levels};
use super::page::{self, Points, REPORT};
use super::remarks::Remarks;
use super::replaced::refuse_replacing;
use super::second_pass;
use crate::correction::{Correction, Identified, Wish, corrected, identified};
use crate::diagnostics::{Failure, Source};
use crate::feed::Schedule;
use crate::job::{Job, ProbeFlags, Route, Which};
use crate::learning::History;
use crate::measurement::Measurement;
use crate::output::OutputFolder;
use crate::pass::{Pass, PathBuffer};
use crate::program::{BlockEdit, Origin, RewriteOptions, Rewritten, first_pass_of, rewrite_program};
use crate::report::page::render;
use crate::report::{
    CorrectSummary, block_edits, correct_summary, correction_csv, correction_rows, json, mm, wall_csv,
};

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

/// A correction in memory: everything the command writes follows from it.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// Machine and material.
    pub identified: Identified,
    /// The correction.
    pub correction: Correction,
    /// Feeds in place of the programmed ones, where the job wants any.
    pub schedule: Option<Schedule>,
    /// Wall error beside the model, one entry per sample of the contour; empty where none is known.
    pub residual: Vec<Offset>,
    /// Its standard deviation, the same way.
    pub residual_sigma: Vec<Offset>,
    /// The summary.
    pub summary: CorrectSummary,
    /// The corrected program, when that is a route.
    pub program: Option<Vec<u8>>,
    /// The image of the probed depth, when that is a route.
    pub image: Option<Vec<u8>>,
    /// Images of the other depths with their numbers.
    pub other_images: Vec<(u32, Vec<u8>)>,
    /// `correction.csv` and `wall.csv`.
    pub tables: [Vec<u8>; 2],
    /// `correction.svg`.
    pub picture: Vec<u8>,
}

/// Corrects a pass from a measurement, in memory, for one or both routes.
///
/// # Errors
/// What is wrong with program or measurement, and a correction beyond the clamp.
pub fn correct(
    pass: &Pass,
    measurement: &Measurement,
    remarks: &[String],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Corrected, Failure> {
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let identified = identified(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let remarks = Remarks::of(measurement, remarks);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let law = job::law(&pass.core, &identified.machine(&path, &table), &measurement.contacts);
    let mut done = design(pass, &sampled, identified, &Wish::of(law), remarks, routes, progress)?;
    done.summary.warnings.extend(cut_corrected(&done.identified, &done.correction));
    Ok(done)
}

/// Designs the correction of a pass for an identified machine and writes it for the routes.
///
/// # Errors
/// A correction beyond the clamp, a contour that cannot be written.
pub(super) fn design(
    pass: &Pass,
    sampled: &Path,
    identified: Identified,
    wish: &Wish<'_>,
    remarks: Remarks<'_>,
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Corrected, Failure> {
    progress(0.2);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let mut feeds = feeds::planned(pass, &machine, &identified, remarks.of_this_pass, routes)?;
    feeds.compare(pass, &machine, &identified, wish);
    let mut fed = PathBuffer::default();
    let path = match &feeds.schedule {
        Some(schedule) => pass.sample_fed(&mut fed, Some(schedule))?.with_law(identified.law()),
        None => path,
    };
    let machine = identified.machine(&path, &table);
    let correction = corrected(pass, &machine, &identified, wish, |share| progress(0.2 + 0.7 * share))?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(remarks.texts.iter().cloned());
    warnings.extend(doubts(pass, &identified, &correction, &machine));
    warnings.extend(feeds.doubts(mm(correction.sigma.iter().copied().max().unwrap_or_default())));
    let mut summary = correct_summary(pass, &identified, &correction, remarks.set_aside, warnings);
    summary.place(&path, &correction);
    summary.feed = feeds.summary;
    let (mut program, mut image, mut other_images) = (None, None, Vec::new());
    let mut levels = Levels::default();
    for route in routes {
        match route {
            Route::Program => {
                let mut edits = Vec::new();
                levels = levels::each(pass, &path, |_, pass, path| {
                    edits.extend(block_edits(pass, path, &correction.nodes, feeds.schedule.as_ref()));
                    Ok(())
                })?;
                let written = corrected_program(pass, remarks.probe, &edits)?;
                summary.warnings.extend(kinked(&written.difference));
                summary.program = Some(written.difference);
                program = Some(written.text);
            }
            Route::Coprocessor => {
                levels = levels::each(pass, &path, |number, other, path| {
                    let bytes = crate::image::build(other, &identified, path, &correction)?;
                    if number == pass.level() {
                        image = Some(bytes);
                    } else {
                        other_images.push((number, bytes));
                    }
                    Ok(())
                })?;
            }
        }
    }
    summary.warnings.append(&mut levels.left);
    summary.feature = pass.feature(&levels.written);
    let rows = correction_rows(&machine, &correction);
    let tables = [correction_csv(&rows)?, wall_csv(&rows)?];
    let picture = crate::plot::predicted_error(&crate::plot::View::default(), &rows, &[])?;
    progress(1.0);
    Ok(Corrected {
        identified,
        correction,
        schedule: feeds.schedule,
        residual: wish.residual.to_vec(),
        residual_sigma: wish.residual_sigma.to_vec(),
        summary,
        program,
        image,
        other_images,
        tables,
        picture,
    })
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
    folder.write(REPORT, &render(&page::corrected(&pass, &measurement, &done, points)?)?)?;
    folder.commit()?;
    Ok(done.summary)
}

fn corrected_program(pass: &Pass, probe: u32, edits: &[BlockEdit]) -> Result<Rewritten, Failure> {
    let origin = Origin { job: Some(crc32(pass.job.source().bytes())), probe: Some(probe) };
    let options = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        origin,
        ..RewriteOptions::default()
    };
    rewrite_program(&pass.program, edits, &options)
}
