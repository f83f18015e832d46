//! `correct`: from a measured pass to its correction, written as program or as image, with its figures.

use truepath_core::checksum::crc32;
use truepath_core::cut::Path;
use truepath_core::job;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::feed::Schedule;
use truepath_job::job::Route;
use truepath_job::levels::{self, Levels};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_program::{BlockEdit, Origin, RewriteOptions, Rewritten, rewrite_program};

use crate::correction::{Correction, DesignRequest, Identification, design_correction, identify};
use crate::edits::block_edits;
use crate::rows::{CorrectionRow, correction_rows};
use crate::summary::Remarks;
use crate::summary::{CorrectSummary, correct_summary};
use crate::warnings::{cut_corrected, kinked, model_warnings};
use crate::{feeds, image};

/// A correction in memory: everything the command writes follows from it.
#[derive(Clone, Debug)]
pub struct Corrected {
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
pub fn correct(
    pass: &Pass,
    measurement: &Measurement,
    remarks: &[String],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Corrected, Failure> {
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let identified = identify(pass, &sampled, measurement, |share| progress(0.2 * share))?;
    let remarks = Remarks::of(measurement, remarks);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let law = job::law(&pass.core, &identified.machine(&path, &table), &measurement.contacts);
    let mut done = design(pass, &sampled, identified, &DesignRequest::of(law), remarks, routes, progress)?;
    done.summary.warnings.extend(cut_corrected(&done.identified, &done.correction));
    Ok(done)
}

/// Designs the correction of a pass for an identified machine and writes it for the routes.
///
/// # Errors
/// A correction beyond the clamp, a contour that cannot be written.
pub fn design(
    pass: &Pass,
    sampled: &Path,
    identified: Identification,
    request: &DesignRequest<'_>,
    remarks: Remarks<'_>,
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Corrected, Failure> {
    progress(0.2);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let mut feeds = feeds::planned(pass, &machine, &identified, remarks.of_this_pass, routes)?;
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
    warnings.extend(model_warnings(pass, &identified, &correction, &machine));
    warnings.extend(feeds.warnings(mm(correction.sigma.iter().copied().max().unwrap_or_default())));
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
                    let bytes = image::build(other, &identified, path, &correction)?;
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
    progress(1.0);
    Ok(Corrected {
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
