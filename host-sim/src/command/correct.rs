//! `correct`: from a probe file to the corrected program or the correction image.

use std::path::Path as FilePath;

use truepath_core::checksum::crc32;
use truepath_core::correct::Law;
use truepath_core::cut::{Loop, Path};
use truepath_core::identify::Parameter;
use truepath_core::job;
use truepath_core::probe::Contact;
use truepath_core::units::Offset;

use super::second_pass;
use crate::correction::{Correction, Identified, corrected, identified};
use crate::diagnostics::{Failure, Source};
use crate::job::{Job, Route};
use crate::measurement::Measurement;
use crate::output::OutputFolder;
use crate::pass::{Pass, PathBuffer};
use crate::program::{Difference, Origin, RewriteOptions, Rewritten, rewrite_program};
use crate::report::{CorrectSummary, block_edits, correct_summary, correction_csv, mm, points_csv};

use crate::report::json;

/// Files this command may write.
const FILES: &[&str] = &[
    "corrected.nc",
    "difference.txt",
    "correction.tpi",
    "correction.csv",
    "points.csv",
    "summary.json",
    "correction.svg",
    "probe-raw.txt",
    "first-pass-surface.csv",
];

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
}

/// A correction in memory: everything the command writes follows from it.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// Machine and material.
    pub identified: Identified,
    /// The correction.
    pub correction: Correction,
    /// The summary.
    pub summary: CorrectSummary,
    /// The corrected program, when that is a route.
    pub program: Option<Vec<u8>>,
    /// The image, when that is a route.
    pub image: Option<Vec<u8>>,
    /// `correction.csv`.
    pub table: Vec<u8>,
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
    design(pass, &sampled, identified, &measurement.contacts, remarks, routes, progress)
}

/// What a measurement leaves to be said.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remarks<'a> {
    /// Readings set aside.
    pub(super) set_aside: usize,
    /// Sentences for the summary.
    pub(super) texts: &'a [String],
    /// CRC-32 of the probe file.
    pub(super) probe: u32,
}

impl<'a> Remarks<'a> {
    /// Of a measurement, with sentences about it.
    pub(super) const fn of(measurement: &Measurement, texts: &'a [String]) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc }
    }
}

/// Designs the correction of a pass for an identified machine. `contacts` are those of this pass, empty when it has not
/// been measured.
///
/// # Errors
/// A correction beyond the clamp, a contour that cannot be written.
pub(super) fn design(
    pass: &Pass,
    sampled: &Path,
    identified: Identified,
    contacts: &[Contact],
    remarks: Remarks<'_>,
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Corrected, Failure> {
    progress(0.2);
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let law = job::law(&pass.core, &machine, contacts);
    let correction = corrected(pass, &machine, &identified, law, |share| progress(0.2 + 0.7 * share))?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(remarks.texts.iter().cloned());
    warnings.extend(doubts(pass, &identified, &correction, &machine));
    let mut summary = correct_summary(pass, &identified, &correction, remarks.set_aside, warnings);
    let (mut program, mut image) = (None, None);
    for route in routes {
        match route {
            Route::Program => {
                let written = corrected_program(pass, remarks.probe, &path, &correction)?;
                summary.warnings.extend(kinked(&written.difference));
                summary.program = Some(written.difference);
                program = Some(written.text);
            }
            Route::Coprocessor => image = Some(crate::image::build(pass, &identified, &path, &correction)?),
        }
    }
    let table = correction_csv(&machine, &correction)?;
    let s_mm: Vec<f64> =
        path.samples()[path.first()..path.first() + path.count()].iter().map(|sample| mm(sample.s)).collect();
    let picture = crate::plot::correction(pass, &s_mm, &correction)?;
    progress(1.0);
    Ok(Corrected { identified, correction, summary, program, image, table, picture })
}

/// Corrects and writes the outputs.
///
/// # Errors
/// As [`correct`], and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<CorrectSummary, Failure> {
    let pass = Pass::read(Job::read(options.job)?)?;
    let file = Source::read(options.probe)?;
    let first = options.first_pass.map(|job| Pass::read(Job::read(job)?)).transpose()?;
    let measurement = Measurement::read(first.as_ref().unwrap_or(&pass), &file)?;
    let folder = OutputFolder::create(options.out, options.force, FILES)?;
    let route = options.route.unwrap_or(pass.job.route);
    let remarks = measurement.remarks(&file);
    let done = match &first {
        None => correct(&pass, &measurement, &remarks, &[route], progress)?,
        Some(first) => {
            let (done, surface) = second_pass::correct(&pass, first, &measurement, &remarks, &[route], progress)?;
            folder.write("first-pass-surface.csv", &surface.table())?;
            done
        }
    };
    if let Some(text) = &done.program {
        folder.write("corrected.nc", text)?;
        let difference = done.summary.program.as_ref().map(|d| d.text(pass.program.name()));
        folder.write("difference.txt", difference.unwrap_or_default().as_bytes())?;
    }
    if let Some(bytes) = &done.image {
        folder.write("correction.tpi", bytes)?;
    }
    folder.write("correction.csv", &done.table)?;
    folder.write("points.csv", &points_csv(&measurement.contacts)?)?;
    folder.write("summary.json", &json(&done.summary)?)?;
    folder.write("correction.svg", &done.picture)?;
    folder.write("probe-raw.txt", file.bytes())?;
    folder.commit()?;
    Ok(done.summary)
}

fn corrected_program(pass: &Pass, probe: u32, path: &Path, correction: &Correction) -> Result<Rewritten, Failure> {
    let origin = Origin { job: Some(crc32(pass.job.source().bytes())), probe: Some(probe) };
    let options = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        origin,
        ..RewriteOptions::default()
    };
    rewrite_program(&pass.program, &block_edits(pass, path, &correction.nodes), &options)
}

/// What the user should doubt.
fn doubts(pass: &Pass, identified: &Identified, correction: &Correction, machine: &Loop) -> Vec<String> {
    let mut out = Vec::new();
    if identified.fit().outliers > 0 {
        let lines: Vec<String> = identified
            .observations
            .iter()
            .filter(|o| crate::report::float(o.weight) < 0.3)
            .map(|o| format!("s = {:.2} mm (measured {:.4}, model {:.4} mm)", mm(o.s), mm(o.error), mm(o.predicted)))
            .collect();
        out.push(format!("{} points do not fit and were given little weight: {}", lines.len(), lines.join("; ")));
    }
    if correction.passage.unsettled > 0 {
        out.push(format!(
            "the elastic loop did not settle at {} places (worst residual {:.4} mm): the machine is too soft for this cut",
            correction.passage.unsettled,
            mm(correction.passage.worst_residual)
        ));
    }
    let held = machine.path.samples().iter().filter(|s| s.near_corner).count();
    if held > 0 {
        let line =
            machine.path.samples().iter().find(|s| s.near_corner).and_then(|s| pass.blocks.get(s.block as usize));
        out.push(format!(
            "a sharp inside corner near line {}: the load changes there the moment the direction does, so the correction of the straight wall is held and up to {:.3} mm stay; give the path an arc there",
            line.map_or(0, |b| b.line),
            correction.predicted.iter().map(|p| mm(p.after.mean.abs())).fold(0.0, f64::max)
        ));
    }
    if let Some(limit) = correction.wanted.max_gouge {
        let deepest = correction.predicted.iter().map(|p| -p.after.lowest).max().unwrap_or_default();
        if deepest > limit + Offset::from_um(1) {
            out.push(format!(
                "max_gouge_mm = {} is not kept: {:.4} mm are predicted{}",
                mm(limit),
                mm(deepest),
                if correction.wanted.law == Law::Model { "" } else { " (only law = \"model\" heeds it)" }
            ));
        }
    }
    let far = identified.fit().theta.iter().zip(Parameter::ALL).filter(|(t, _)| crate::report::float(t.abs()) > 2.5);
    for (theta, parameter) in far {
        out.push(format!(
            "{} came out {:.1} standard deviations from what the job says: check the job, or probe more places",
            parameter.name(),
            crate::report::float(theta.abs())
        ));
    }
    let peak = correction.predicted.iter().map(|p| p.before.mean.abs()).max().unwrap_or_default();
    let sigma = correction.sigma.iter().copied().max().unwrap_or_default();
    if sigma.nm() * 8 > peak.nm() {
        out.push(format!(
            "the points leave the corrected wall uncertain by {:.4} mm (one sigma); probe more places, best in the corners",
            mm(sigma)
        ));
    }
    if let Some(reversal) = reversal(pass, machine, correction) {
        out.push(reversal);
    }
    out
}

/// A kink of the written path beyond the one asked for.
fn kinked(difference: &Difference) -> Option<String> {
    (difference.largest_kink_deg > difference.max_kink_deg).then(|| {
        format!(
            "corrected.nc:{}: the corrected path turns by {:.2} degrees on the spot (correct.max_kink_deg = {}): the correction itself changes that fast there",
            difference.largest_kink_line, difference.largest_kink_deg, difference.max_kink_deg
        )
    })
}

/// Where the correction reverses an axis that the program does not reverse, backlash acts.
fn reversal(pass: &Pass, machine: &Loop, correction: &Correction) -> Option<String> {
    let path = machine.path;
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    for axis in 0..2 {
        let backlash = pass.job.backlash[axis];
        if backlash.nm() == 0 {
            continue;
        }
        for (i, pair) in samples.windows(2).enumerate() {
            let nominal = pair[1].point.from(pair[0].point);
            let change = correction.nodes[i + 1].total() - correction.nodes[i].total();
            let (n, c) = if axis == 0 { (nominal.x.nm(), change.x.nm()) } else { (nominal.y.nm(), change.y.nm()) };
            if n.abs() > 1_000 && (n + c).signum() == -n.signum() {
                return Some(format!(
                    "near s = {:.2} mm the correction reverses {} against the program: its backlash of {} mm acts there",
                    mm(pair[0].s),
                    ["X", "Y"][axis],
                    mm(backlash)
                ));
            }
        }
    }
    None
}
