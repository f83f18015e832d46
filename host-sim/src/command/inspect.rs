//! `inspect`: the accuracy of the wall from measurements alone (P18), no model, and the verdict on the part.

use std::path::PathBuf;

use clap::Args;
use truepath_core::probe::{Contact, CutWith};
use truepath_core::units::Offset;
use truepath_correction::inspection::{Extent, PointVerdict, Reach, Rule, SetAside, Touched, coverage, judge};
use truepath_correction::misfit::noticed;
use truepath_correction::warnings::misread;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::mm;
use truepath_job::feature::listing;
use truepath_job::job::{JobFile, PartFlags, ProbeFlags, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::page::render;
use truepath_report::pages::{REPORT, inspected};
use truepath_report::{InspectSummary, inspect_summary, judged_points_csv, points_csv};

use crate::terminal::Terminal;

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
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// The probe file.
    #[arg(long, value_name = "FILE")]
    pub probe: PathBuf,
    /// Folder for report.html, the points as a table, the summary and the probe file as it is.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// What is said of the part in place of the job.
    #[command(flatten)]
    pub part: PartFlags,
    /// What is said of the probe file in place of the job.
    #[command(flatten)]
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

/// Inspects and prints the report.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let inspection = run(options)?;
    terminal.warn_all(&inspection.summary.warnings);
    terminal.tell(&inspection, || words(&inspection))
}

fn words(inspection: &Inspection) -> String {
    let mut text = inspection.summary.feature.as_ref().map(listing).unwrap_or_default();
    let judged = inspection.summary.tolerance.is_some();
    text.push_str("  line     s mm       X mm       Y mm   height mm   error mm");
    text.push_str(if judged { "  verdict\n" } else { "\n" });
    for p in &inspection.contacts {
        text += &format!(
            "{:>6} {:>8.2} {:>10.4} {:>10.4} {:>11.3} {:>10.*}{}\n",
            p.line,
            p.s_mm,
            p.x_mm,
            p.y_mm,
            p.height_mm,
            inspection.decimals,
            p.error_mm,
            p.verdict.map_or("", word)
        );
    }
    let s = &inspection.summary;
    text += &format!(
        "\n{} points; material left is positive\nmean {:.4} mm (a wear offset removes it), largest {:.d$}, smallest {:.d$}, rms {:.4}, spread over height {:.4} mm\n",
        s.points,
        s.mean_error_mm,
        s.max_error_mm,
        s.min_error_mm,
        s.rms_error_mm,
        s.spread_over_height_mm,
        d = inspection.decimals
    );
    text += &s.statements.join("\n");
    text + &format!("\nverdict: {}\n", s.verdict.text)
}

const fn word(verdict: PointVerdict) -> &'static str {
    match verdict {
        PointVerdict::Pass => "  pass",
        PointVerdict::Fail => "  FAIL",
        PointVerdict::Open => "  undecided",
    }
}

/// Compares a probe file with the wall of the job. A part that fails is no error: the command did its work, and the verdict
/// is in the summary.
///
/// # Errors
/// Whatever is wrong with job, program or probe file, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<Inspection, Failure> {
    let mut job = JobFile::read(&options.job)?;
    job.override_probe(&options.probe_flags)?;
    job.override_part(&options.part)?;
    job.which = options.which.clone();
    // What a part was cut with does not matter for how far its wall is off.
    let pass = Pass::read(job)?.cut_with(CutWith::Anything);
    let file = Source::read(&options.probe)?;
    let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
    let mut misreadings = misread(&pass, false, &measurement.contacts);
    misreadings.extend(noticed(&pass, &measurement).filter(|_| !measurement.taken_as_is));
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
    if let Some(out) = &options.output {
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
