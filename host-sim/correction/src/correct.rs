//! `correct`: from a measured pass to its correction, written as program or as image, with its figures.

use truepath_core::checksum::crc32;
use truepath_core::cut::Path;
use truepath_core::gcode::program_crc;
use truepath_core::image::{DEVICE_NODES, image_bytes};
use truepath_core::job;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::mm;
use truepath_job::feature::Plan;
use truepath_job::feed::Schedule;
use truepath_job::job::Route;
use truepath_job::levels::{self, Levels};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_program::codes::P004;
use truepath_program::{BlockEdit, Origin, RewriteOptions, Rewritten, rewrite_program, unrolled};

use crate::correction::{Correction, DesignRequest, Identification, design_correction, identify};
use crate::edits::block_edits;
use crate::feeds;
use crate::remarks::{MeasuredPart, Remarks};
use crate::rows::{CorrectionRow, correction_rows};
use crate::summary::{CorrectSummary, correct_summary};
use crate::warnings::{cut_corrected, kinked, model_warnings};

/// A correction in memory: everything the command writes follows from it.
#[derive(Clone, Debug)]
pub struct CorrectedPass {
    /// Machine and material.
    pub identified: Identification,
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
    /// The correction along the contour.
    pub rows: Vec<CorrectionRow>,
}

/// Corrects a pass from a measurement, in memory, for one or both routes.
///
/// # Errors
/// What is wrong with program or measurement, and a correction beyond the clamp.
pub fn correct_pass(
    pass: &Pass,
    measurement: &Measurement,
    remarks: &[String],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<CorrectedPass, Failure> {
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let identified = identify(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let remarks = Remarks::of(measurement, remarks, MeasuredPart::Uncorrected);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let law = job::law(&pass.core, &identified.machine(&path, &table), &measurement.contacts);
    correct_identified(pass, &sampled, identified, &DesignRequest::of(law), remarks, routes, progress)
}

/// Designs the correction of a pass for an identified machine and writes it for the routes.
///
/// # Errors
/// A correction beyond the clamp, a contour that cannot be written.
pub fn correct_identified(
    pass: &Pass,
    sampled: &Path,
    identified: Identification,
    request: &DesignRequest<'_>,
    remarks: Remarks<'_>,
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<CorrectedPass, Failure> {
    progress(0.2);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let mut feeds = feeds::planned(pass, &machine, &identified, remarks.part != MeasuredPart::FirstPass, routes)?;
    feeds.compare(pass, &machine, &identified, request);
    let mut fed = PathBuffer::default();
    let path = match &feeds.schedule {
        Some(schedule) => pass.sample_fed(&mut fed, Some(schedule))?.with_law(identified.law()),
        None => path,
    };
    let machine = identified.machine(&path, &table);
    let correction = design_correction(pass, &machine, &identified, request, |share| progress(0.2 + 0.7 * share))?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(remarks.texts.iter().cloned());
    warnings.extend(model_warnings(pass, remarks.measurement, &identified, &correction, &machine));
    warnings.extend(feeds.warnings(mm(correction.sigma.iter().copied().max().unwrap_or_default())));
    let (mut written, mut image, mut other_images) = (None, None, Vec::new());
    let mut levels = Levels::default();
    for route in routes {
        match route {
            Route::Program => {
                let write = |pass: &Pass, levels: &mut Levels, original: Option<u32>| {
                    let mut edits = Vec::new();
                    *levels = levels::each(pass, &path, |_, pass, path| {
                        edits.extend(block_edits(pass, path, &correction.nodes, feeds.schedule.as_ref()));
                        Ok(())
                    })?;
                    written_program(pass, remarks.probe, &edits, original)
                };
                let rewritten = write(pass, &mut levels, None).or_else(|failure| {
                    let (flat, said) = written_out(pass, &failure).ok_or(failure)?;
                    warnings.push(said);
                    write(&flat, &mut levels, Some(program_crc(pass.program.bytes())))
                })?;
                warnings.extend(kinked(&rewritten.difference));
                written = Some(rewritten);
            }
            Route::Coprocessor => {
                levels = levels::each(pass, &path, |number, other, path| {
                    let bytes = written_image(other, &identified, path, &correction)?;
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
    warnings.append(&mut levels.left);
    if remarks.part == MeasuredPart::Uncorrected {
        warnings.extend(cut_corrected(&identified, &correction));
    }
    let (program, difference) = written.map(|rewritten| (rewritten.text, rewritten.difference)).unzip();
    let summary = CorrectSummary {
        program: difference,
        feed: feeds.summary,
        feature: pass.feature(&levels.written),
        ..correct_summary(pass, &identified, &path, &correction, remarks.set_aside, warnings)
    };
    let rows = correction_rows(&machine, &correction);
    progress(1.0);
    Ok(CorrectedPass {
        identified,
        correction,
        schedule: feeds.schedule,
        residual: request.residual.to_vec(),
        residual_sigma: request.residual_sigma.to_vec(),
        summary,
        program,
        image,
        other_images,
        rows,
    })
}

/// The same pass of the program with its subprograms and loops written out, and what is said about it, where a line of
/// the contour is executed several times; `None` where that is not what failed, or the cuts would be others.
fn written_out(pass: &Pass, failure: &Failure) -> Option<(Pass, String)> {
    let Failure::Input(error) = failure else { return None };
    if error.code() != P004.code || !pass.job.features.is_empty() {
        return None;
    }
    let text = unrolled(pass.program.bytes(), pass.job.numbers.program_options())?;
    let mut job = pass.job.clone();
    job.which.pass = pass.plan.as_ref().map(|_| pass.level());
    let flat = Pass::new(job, Source::new(pass.program.name(), text)).ok()?;
    let curves = |pass: &Pass| pass.blocks.iter().map(|b| (b.curve, b.feed)).collect::<Vec<_>>();
    let levels = |pass: &Pass| pass.plan.as_ref().map(Plan::levels);
    (curves(&flat) == curves(pass) && levels(&flat) == levels(pass)).then(|| {
        let said = "lines of the contour are executed several times, each with a correction of its own: the corrected program has its subprograms and loops written out";
        (flat, format!("{}: {said}", pass.program.name()))
    })
}

fn written_program(pass: &Pass, probe: u32, edits: &[BlockEdit], original: Option<u32>) -> Result<Rewritten, Failure> {
    let origin = Origin { program: original, job: Some(crc32(pass.job.source().bytes())), probe: Some(probe) };
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

/// Makes the image of a correction.
///
/// # Errors
/// A correction beyond the clamp somewhere in the feed window, or a contour too large for the coprocessor.
fn written_image(
    pass: &Pass,
    identified: &Identification,
    path: &Path,
    correction: &Correction,
) -> Result<Vec<u8>, Failure> {
    let mut nodes = correction.nodes.clone();
    let mut bytes = vec![0; image_bytes(DEVICE_NODES)];
    let (core, found, blocks) = (&pass.core, &identified.core, &pass.blocks);
    let written = job::to_nominal_feed(core, found, path, blocks, &mut nodes)
        .and_then(|()| job::write_image(core, found, path, blocks, &nodes, &mut bytes))
        .map_err(|error| pass.refused(&error))?;
    bytes.truncate(written.bytes);
    Ok(bytes)
}
