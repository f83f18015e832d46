//! `inspect`: the accuracy of the wall from measurements alone (P18), no model, and the verdict on the part.

use std::path::Path as FilePath;

use truepath_core::probe::{Contact, CutWith};
use truepath_core::units::Offset;
use truepath_correction::inspection::{Extent, PointVerdict, Reach, Rule, SetAside, Touched, coverage, judge};
use truepath_correction::warnings::misread;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::mm;
use truepath_job::job::{Job, PartFlags, ProbeFlags, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::page::render;
use truepath_report::pages::{REPORT, inspected};
use truepath_report::{InspectSummary, inspect_summary, judged_points_csv, points_csv};

/// One contact, for the list that is printed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Point {
    /// Line of the probe file.
    pub line: u32,
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Contact, mm.
    pub x_mm: f64,
    /// Contact, mm.
    pub y_mm: f64,
    /// Height above the cutter's tip, mm.
    pub height_mm: f64,
    /// Wall error, mm: positive, material left.
    pub error_mm: f64,
    /// Whether it is within the tolerance; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<PointVerdict>,
}

/// The report.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Inspection {
    /// Totals.
    pub summary: InspectSummary,
    /// Every contact, in the order of the contour.
    pub contacts: Vec<Point>,
    /// Decimals of a millimetre with which deviations are told in words.
    #[serde(skip)]
    pub decimals: usize,
}

/// Files this command may write.
const FILES: &[&str] = &["points.csv", "summary.json", "probe-raw.txt", REPORT];

/// What is inspected.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// The probe file.
    pub probe: &'a FilePath,
    /// Output folder, if anything is to be written.
    pub out: Option<&'a FilePath>,
    /// Replace existing files.
    pub force: bool,
    /// What the command line says of the part.
    pub part: PartFlags,
    /// What the command line says of the probe file.
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    pub which: Which,
}

/// Compares a probe file with the wall of the job. A part that fails is no error: the command did its work, and the verdict
/// is in the summary.
///
/// # Errors
/// Whatever is wrong with job, program or probe file, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<Inspection, Failure> {
    let mut job = Job::read(options.job)?;
    job.override_probe(&options.probe_flags)?;
    job.override_part(&options.part)?;
    job.which = options.which.clone();
    // What a part was cut with does not matter for how far its wall is off.
    let pass = Pass::read(job)?.cut_with(CutWith::Anything);
    let file = Source::read(options.probe)?;
    let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
    let misreadings = misread(&pass, false, &measurement.contacts);
    let told: Vec<String> = pass.warnings.iter().chain(&misreadings).cloned().collect();
    let warnings = [pass.warnings.clone(), measurement.remarks(&file), misreadings].concat();
    let (part, contour) = (&pass.job.part, pass.path_contour());
    let rule = part.tolerance.map(|tolerance| Rule { tolerance, uncertainty: part.uncertainty });
    let depth = pass.job.numbers.cut.axial_depth;
    let wall = Extent { length: pass.core.contour.length, depth, closed: contour.is_closed() };
    let reach = Reach {
        along: part.reach.unwrap_or(pass.job.numbers.tool.diameter),
        height: part.reach_height.unwrap_or(Offset::from_nm(depth.nm() / 4)),
    };
    let height =
        |c: &Contact| Offset::from_nm((truepath_ground::units::float(c.height) * depth.nm() as f64).round() as i64);
    let places: Vec<Touched> = measurement.contacts.iter().map(|c| Touched { s: c.s, height: height(c) }).collect();
    let coverage = coverage(&places, wall, reach);
    let deviations: Vec<Offset> = measurement.contacts.iter().map(|c| c.error).collect();
    let aside = SetAside::of(measurement.rejected.iter().map(|r| &r.reason), pass.job.numbers.tool.diameter);
    let judgement = judge(rule, &deviations, aside, &coverage);
    let contacts = measurement.contacts.iter().enumerate().map(|(at, c)| Point {
        line: c.line,
        s_mm: mm(c.s),
        x_mm: c.point.x.nm() as f64 / 1e6,
        y_mm: c.point.y.nm() as f64 / 1e6,
        height_mm: truepath_ground::units::float(c.height) * mm(depth),
        error_mm: mm(c.error),
        verdict: judgement.points.get(at).copied(),
    });
    let contacts = contacts.collect();
    let summary = inspect_summary(&pass, &measurement, &judgement, coverage, warnings);
    let inspection = Inspection { contacts, summary, decimals: judgement.decimals };
    if let Some(out) = options.out {
        let folder = OutputFolder::create(out, options.force, FILES)?;
        let points = match inspection.summary.tolerance {
            Some(_) => judged_points_csv(&measurement, &judgement.points)?,
            None => points_csv(&measurement, &[])?,
        };
        folder.write("points.csv", &points)?;
        folder.write("summary.json", &json(&inspection.summary)?)?;
        folder.write("probe-raw.txt", file.bytes())?;
        let page = inspected(&pass, &measurement, &judgement, &inspection.summary, &told)?;
        folder.write(REPORT, &render(&page)?)?;
        folder.commit()?;
    }
    Ok(inspection)
}
