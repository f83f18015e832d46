//! `correct`: from a measured pass to its correction, written as program or as image, with its figures.

use truepath_core::checksum::crc32;
use truepath_core::cut::{Path, Sample};
use truepath_core::gcode::program_crc;
use truepath_core::identify::Observation;
use truepath_core::image::{DEVICE_NODES, image_bytes};
use truepath_core::job;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Remark;
use truepath_ground::units::mm;
use truepath_job::feed::Schedule;
use truepath_job::job::Route;
use truepath_job::levels::{self, Levels};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_program::{BlockEdit, Origin, RewriteOptions, Rewritten, rewrite_program};

use crate::correction::{
    Correction, DesignRequest, Identification, MeasuredCut, design_correction, identify_together, identify_with,
};
use crate::discrepancy::{Along, Discrepancy, PartCut, is_fitted, relieved};
use crate::edits::block_edits;
use crate::feeds;
use crate::identification::Found;
use crate::remarks::{MeasuredPart, Remarks};
use crate::rows::{CorrectionRow, correction_rows};
use crate::sharp_corners::{self, SharpCorners};
use crate::summary::{CorrectSummary, correct_summary, corrected_name};
use crate::surface::expected::{Surface, Surfaces};
use crate::told::{self, Heard, Told};
use crate::warnings::{beyond_tolerance, cut_corrected, kinked, model_warnings};
use crate::written_out::written_out;

/// A correction in memory: everything the command writes follows from it.
#[derive(Clone, Debug)]
pub struct CorrectedPass {
    /// Machine and material.
    pub identified: Identification,
    /// The correction.
    pub correction: Correction,
    /// Feeds in place of the programmed ones, where the job wants any.
    pub schedule: Option<Schedule>,
    /// What is beside the model along the contour; empty where nothing is known.
    pub beside: Along,
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
    remarks: &[Remark],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<CorrectedPass, Failure> {
    let walls = [MeasuredWall { pass, measurement, remarks }];
    only(correct_every(&walls, routes, progress)?)
}

/// A wall of a part, and what was measured on it.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredWall<'a> {
    /// The pass that cut it.
    pub pass: &'a Pass,
    /// Its points.
    pub measurement: &'a Measurement,
    /// Sentences for its summary.
    pub remarks: &'a [Remark],
}

/// Corrects the walls of one part together: one machine is identified from the points of all, and one program is written
/// with the corrections of all, which every result carries.
///
/// # Errors
/// As [`correct_pass`].
pub fn correct_every(
    walls: &[MeasuredWall<'_>],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<CorrectedPass>, Failure> {
    let Heard { passes, fits } = as_told(walls)?;
    let walls: Vec<MeasuredWall> =
        walls.iter().zip(&passes).map(|(wall, pass)| MeasuredWall { pass, ..*wall }).collect();
    let mut buffers: Vec<PathBuffer> = walls.iter().map(|_| PathBuffer::default()).collect();
    let mut sampled = Vec::new();
    for (wall, buffer) in walls.iter().zip(&mut buffers) {
        sampled.push(wall.pass.sample(buffer)?);
    }
    let both = walls.iter().zip(&sampled);
    let cuts = both.map(|(wall, path)| MeasuredCut { pass: wall.pass, path, measurement: wall.measurement });
    let cuts: Vec<MeasuredCut> = cuts.collect();
    let (identified, along) = identify_cuts(&cuts, fits.into_iter().next(), |share| progress(0.2 * share))?;
    let identified =
        walls.iter().zip(&sampled).zip(identified).zip(&along).map(|(((wall, path), identified), along)| {
            let remarks = Remarks::of(wall.measurement, wall.remarks, MeasuredPart::Uncorrected);
            let lawful = path.with_law(identified.law());
            let table = identified.table();
            let law = job::law(&wall.pass.core, &identified.machine(&lawful, &table), &wall.measurement.contacts);
            let request = DesignRequest { beside: along, ..DesignRequest::of(law) };
            IdentifiedWall { pass: wall.pass, path, identified, request, remarks }
        });
    correct_identified(identified.collect(), routes, progress)
}

/// Machine and material from the points of the walls of one uncorrected part, as [`correct_every`] takes them: one result for each
/// wall, with its own points.
///
/// # Errors
/// What is wrong with program or measurement, and points that do not fit the job.
pub fn identify_every(
    walls: &[MeasuredWall<'_>],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Identification>, Failure> {
    let Heard { passes, fits } = as_told(walls)?;
    let mut buffers: Vec<PathBuffer> = walls.iter().map(|_| PathBuffer::default()).collect();
    let mut sampled = Vec::new();
    for (pass, buffer) in passes.iter().zip(&mut buffers) {
        sampled.push(pass.sample(buffer)?);
    }
    let parts = walls.iter().zip(&passes).zip(&sampled);
    let cuts = parts.map(|((wall, pass), path)| MeasuredCut { pass, path, measurement: wall.measurement });
    let cuts: Vec<MeasuredCut> = cuts.collect();
    Ok(identify_cuts(&cuts, fits.into_iter().next(), progress)?.0)
}

/// Machine and material of an uncorrected part with the points of each wall, and what is beside them along each; their plain fit may be
/// there.
fn identify_cuts(
    cuts: &[MeasuredCut<'_>],
    fit: Option<Found>,
    mut progress: impl FnMut(f64),
) -> Result<(Vec<Identification>, Vec<Along>), Failure> {
    let identified = identify_with(cuts, fit, |share| progress(0.5 * share))?;
    let (identified, along, _) = beside(cuts, identified, |share| progress(0.5 + 0.5 * share));
    Ok((identified, along))
}

/// A pass as the points of an uncorrected part have it: its cutter's runout, the stock that roughing left.
///
/// # Errors
/// What is wrong with program or measurement.
pub fn as_its_points_tell(pass: Pass, measurement: &Measurement) -> Result<Pass, Failure> {
    let passes = as_told(&[MeasuredWall { pass: &pass, measurement, remarks: &[] }])?.passes;
    Ok(passes.into_iter().next().unwrap_or(pass))
}

/// The passes of walls of an uncorrected part, which begin at what the shop believes only where the points of all agree with it.
///
/// # Errors
/// What is wrong with program or measurement.
pub fn as_they_agree(walls: Vec<(Pass, Measurement)>) -> Result<Vec<(Pass, Measurement)>, Failure> {
    let passes: Vec<&Pass> = walls.iter().map(|(pass, _)| pass).collect();
    let agreed = told::agreed(&passes, &|k| {
        walls.get(k).map_or_else(|| Ok(Vec::new()), |(_, measurement)| measurement.observations())
    })?;
    Ok(agreed.into_iter().zip(walls).map(|(pass, (_, measurement))| (pass, measurement)).collect())
}

/// Machine and material of an uncorrected part, and what is beside them: along the contour, and at any place, where the job wants it.
///
/// # Errors
/// As [`identify_together`].
pub fn identify_beside(
    pass: &Pass,
    path: &Path,
    measurement: &Measurement,
    mut progress: impl FnMut(f64),
) -> Result<(Identification, Along, Option<Discrepancy>), Failure> {
    let cuts = [MeasuredCut { pass, path, measurement }];
    let identified = identify_together(&cuts, |share| progress(0.5 * share))?;
    let (identified, along, discrepancy) = beside(&cuts, identified, |share| progress(0.5 + 0.5 * share));
    let none = || Failure::Internal("a cut without what its points say".to_owned());
    let identified = identified.into_iter().next().ok_or_else(none)?;
    Ok((identified, along.into_iter().next().unwrap_or_default(), discrepancy))
}

/// The passes of walls of an uncorrected part as their points have them: [`told`].
///
/// # Errors
/// What is wrong with program or measurement.
fn as_told(walls: &[MeasuredWall<'_>]) -> Result<Heard, Failure> {
    let passes: Vec<&Pass> = walls.iter().map(|wall| wall.pass).collect();
    told::passes(&passes, true, &|k, _| {
        let wall = walls.get(k).ok_or_else(|| Failure::Internal("points of no wall".to_owned()))?;
        Ok(vec![Told { nodes: Vec::new(), observations: wall.measurement.observations()? }])
    })
}

/// What the walls of an uncorrected part show beside the machine, which is then known better: it with its points, the
/// discrepancy along each, and at any place.
fn beside(
    cuts: &[MeasuredCut<'_>],
    identified: Vec<Identification>,
    mut progress: impl FnMut(f64),
) -> (Vec<Identification>, Vec<Along>, Option<Discrepancy>) {
    let (Some(cut), Some(known)) = (cuts.first(), identified.first()) else { return (identified, Vec::new(), None) };
    if !is_fitted(cut.pass) {
        let none = vec![Along::default(); identified.len()];
        return (identified, none, None);
    }
    let observations: Vec<Vec<Observation>> = identified.iter().map(|one| one.observations.clone()).collect();
    let parts: Vec<PartCut> = cuts
        .iter()
        .zip(&observations)
        .enumerate()
        .map(|(contour, (cut, observations))| PartCut::uncorrected(*cut.path, contour, observations))
        .collect();
    let found = Found { core: known.core, earlier: Vec::new(), observations: observations.concat() };
    let relieved = relieved(&cut.pass.core, found, &parts, &mut progress);
    let along = parts.iter().map(|part| relieved.along(&part.path, part.contour)).collect();
    let core = relieved.found.core;
    let mut rest = relieved.found.observations.into_iter();
    let own = |own: &Vec<Observation>| Identification { core, observations: rest.by_ref().take(own.len()).collect() };
    (observations.iter().map(own).collect(), along, relieved.discrepancy)
}

/// A wall and what is known of the machine that cuts it.
#[derive(Clone, Debug)]
pub struct IdentifiedWall<'a> {
    /// The pass that cuts it.
    pub pass: &'a Pass,
    /// Its path.
    pub path: &'a Path<'a>,
    /// Machine, material, and its points.
    pub identified: Identification,
    /// What the correction is made from beside them.
    pub request: DesignRequest<'a>,
    /// What is said of its measurement.
    pub remarks: Remarks<'a>,
}

/// Designs the corrections of walls for an identified machine and writes them for the routes, in one program.
///
/// # Errors
/// A correction beyond the clamp, a contour that cannot be written.
pub fn correct_identified(
    walls: Vec<IdentifiedWall<'_>>,
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<CorrectedPass>, Failure> {
    progress(0.2);
    let count = walls.len() as f64;
    let mut fed: Vec<(PathBuffer, Vec<Sample>)> = walls.iter().map(|_| Default::default()).collect();
    let mut designed = Vec::new();
    for (at, (wall, fed)) in walls.into_iter().zip(&mut fed).enumerate() {
        let later = &mut |share| progress(0.2 + (at as f64 + share) / count * 0.7);
        designed.push(design(wall, fed, routes, later)?);
    }
    let corrected = write_every(designed, routes)?;
    progress(1.0);
    Ok(corrected)
}

/// The only one of some corrections.
pub(crate) fn only(corrected: Vec<CorrectedPass>) -> Result<CorrectedPass, Failure> {
    corrected.into_iter().next().ok_or_else(|| Failure::Internal("a pass without its correction".to_owned()))
}

/// The image of the probed depth, and those of the others with their numbers.
type Images = (Option<Vec<u8>>, Vec<(u32, Vec<u8>)>);

/// A correction that was designed and not yet written.
struct Designed<'a> {
    pass: &'a Pass,
    /// The path at the feeds it will be cut with.
    path: Path<'a>,
    identified: Identification,
    correction: Correction,
    feeds: feeds::Feeds,
    beside: Along,
    surface: Surfaces,
    sharp_corners: Option<SharpCorners>,
    set_aside: usize,
    probe: u32,
    part: MeasuredPart,
    warnings: Vec<Remark>,
}

/// Designs the correction of a wall; the buffers take the samples of its path at scheduled feeds and in other stock.
fn design<'a>(
    wall: IdentifiedWall<'a>,
    (fed, stocked): &'a mut (PathBuffer, Vec<Sample>),
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Designed<'a>, Failure> {
    let IdentifiedWall { pass, path: sampled, identified, request, remarks } = wall;
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let mut feeds = feeds::planned(pass, &machine, &identified, remarks.part != MeasuredPart::FirstPass, routes)?;
    feeds.compare(pass, &machine, &identified, &request);
    let path = match &feeds.schedule {
        Some(schedule) => pass.sample_fed(fed, Some(schedule))?.with_law(identified.law()),
        None => path,
    };
    // Where touches have shown other stock, the correction is designed for that.
    let (path, in_stock) = request.beside.in_stock(&path, stocked);
    let request = DesignRequest { beside: &in_stock, ..request };
    let machine = identified.machine(&path, &table);
    let correction = design_correction(pass, &machine, &identified, &request, progress)?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(remarks.texts.iter().cloned());
    let unit = pass.unit();
    warnings.extend(
        unit.remarks(|unit| model_warnings((pass, unit), remarks.measurement, &identified, &correction, &machine)),
    );
    let mut sharp_corners = SharpCorners::of(pass, &path, &correction);
    if let Some(corners) = &mut sharp_corners {
        if remarks.part == MeasuredPart::Uncorrected {
            corners.with_arcs = sharp_corners::with_arcs(pass, &identified);
        }
        warnings.push(unit.remark(|unit| corners.text(unit)));
    }
    let sigma_mm = mm(correction.sigma_by_points.iter().copied().max().unwrap_or_default());
    warnings.extend(unit.remarks(|unit| feeds.warnings(sigma_mm, unit)));
    let wall = |nodes| Surface::predicted(&machine, &identified, request.beside, nodes);
    let surface = Surfaces { before: wall(&[]), after: wall(&correction.nodes) };
    warnings.extend(beyond_tolerance(pass, &remarks, &surface.after));
    Ok(Designed {
        sharp_corners,
        pass,
        path,
        surface,
        correction,
        feeds,
        beside: request.beside.clone(),
        set_aside: remarks.set_aside,
        probe: remarks.probe,
        part: remarks.part,
        warnings,
        identified,
    })
}

impl Designed<'_> {
    /// What the lines of every depth that is cut alike become, with the place of the depth in the program, in `edits`;
    /// `pass` is its own, or the same of the program written out.
    fn edits(&self, pass: &Pass, edits: &mut Vec<([u32; 2], Vec<BlockEdit>)>) -> Result<Levels, Failure> {
        levels::each(pass, &self.path, |_, pass, path| {
            let place = pass.job.numbers.part.map_or([0, 0], |part| [part.run, part.first_block]);
            edits.push((place, block_edits(pass, path, &self.correction.nodes, self.feeds.schedule.as_ref())));
            Ok(())
        })
    }
}

/// Writes corrections for the routes: their images, and one program with all of them.
fn write_every(mut designed: Vec<Designed<'_>>, routes: &[Route]) -> Result<Vec<CorrectedPass>, Failure> {
    let mut levels: Vec<Levels> = vec![Levels::default(); designed.len()];
    let mut images: Vec<Images> = vec![Images::default(); designed.len()];
    let mut written = None;
    for route in routes {
        match route {
            Route::Program => {
                let passes: Vec<&Pass> = designed.iter().map(|one| one.pass).collect();
                let rewritten = match written_program(&designed, &passes, &mut levels, None) {
                    Ok(rewritten) => rewritten,
                    Err(failure) => {
                        let (flat, said) = written_out(&passes, &failure).ok_or(failure)?;
                        let original = passes.first().map(|pass| program_crc(pass.program.bytes()));
                        let flat: Vec<&Pass> = flat.iter().collect();
                        let rewritten = written_program(&designed, &flat, &mut levels, original)?;
                        designed.iter_mut().take(1).for_each(|one| one.warnings.push(said.as_str().into()));
                        rewritten
                    }
                };
                designed
                    .iter_mut()
                    .take(1)
                    .for_each(|one| one.warnings.extend(kinked(&rewritten.difference).map(Remark::from)));
                written = Some(rewritten);
            }
            Route::Coprocessor => {
                for ((one, levels), (image, others)) in designed.iter().zip(&mut levels).zip(&mut images) {
                    *levels = levels::each(one.pass, &one.path, |number, other, path| {
                        let bytes = written_image(other, &one.identified, path, &one.correction)?;
                        if number == one.pass.level() {
                            *image = Some(bytes);
                        } else {
                            others.push((number, bytes));
                        }
                        Ok(())
                    })?;
                }
            }
        }
    }
    let done = designed.into_iter().zip(levels).zip(images);
    Ok(done.map(|((one, levels), images)| one.done(levels, images, written.as_ref())).collect())
}

impl Designed<'_> {
    /// The result, for what was written.
    fn done(self, levels: Levels, (image, other_images): Images, written: Option<&Rewritten>) -> CorrectedPass {
        let Self { pass, path, identified, correction, feeds, mut warnings, .. } = self;
        warnings.extend(levels.left.into_iter().map(Remark::from));
        if self.part == MeasuredPart::Uncorrected {
            warnings.extend(pass.unit().remarks(|unit| cut_corrected(&identified, &correction, unit)));
        }
        let summary = CorrectSummary {
            corrected_program: written.map(|_| corrected_name(pass.program.name())),
            program: written.map(|rewritten| rewritten.difference.clone()),
            feed: feeds.summary,
            sharp_corners: self.sharp_corners,
            feature: pass.feature(&levels.written),
            ..correct_summary(pass, &identified, &path, &correction, self.surface, self.set_aside, warnings)
        };
        let table = identified.table();
        let rows = correction_rows(&identified.machine(&path, &table), &correction);
        CorrectedPass {
            identified,
            correction,
            schedule: feeds.schedule,
            beside: self.beside,
            summary,
            program: written.map(|rewritten| rewritten.text.clone()),
            image,
            other_images,
            rows,
        }
    }
}

/// The program with all corrections. `passes` are those of `designed`, or the same of the program with its subprograms and
/// loops written out, whose `original` has this CRC-32.
fn written_program(
    designed: &[Designed<'_>],
    passes: &[&Pass],
    levels: &mut [Levels],
    original: Option<u32>,
) -> Result<Rewritten, Failure> {
    let mut edits = Vec::new();
    for ((one, pass), levels) in designed.iter().zip(passes).zip(levels) {
        *levels = one.edits(pass, &mut edits)?;
    }
    let (Some(pass), Some(one)) = (passes.first(), designed.first()) else {
        return Err(Failure::Internal("no contour to be written".to_owned()));
    };
    // Several contours may be cut in turn, depth by depth.
    edits.sort_by_key(|(place, _)| *place);
    let edits: Vec<BlockEdit> = edits.into_iter().flat_map(|(_, edits)| edits).collect();
    let origin = Origin { program: original, job: Some(crc32(pass.job.source().bytes())), probe: Some(one.probe) };
    let options = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        origin,
        ..RewriteOptions::default()
    };
    rewrite_program(&pass.program, &edits, &options)
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
    pass.job.signed(bytes)
}
