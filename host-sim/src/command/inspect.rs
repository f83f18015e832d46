//! `inspect`: the accuracy of the wall from measurements alone (P18), no model, and the verdict on the part.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use truepath_core::probe::{Contact, CutWith};
use truepath_core::units::Offset;
use truepath_correction::inspection::{
    Extent, Judgement, NamedWall, PointVerdict, Reach, Rule, SetAside, State, Touched, coverage, judge, judge_every,
};
use truepath_correction::misfit::noticed;
use truepath_correction::remarks::said_of_every;
use truepath_correction::warnings::misread;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::{OutputFolder, json, write_file};
use truepath_ground::units::mm;
use truepath_job::feature::listing;
use truepath_job::job::{PartFlags, Said};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::page::render_all;
use truepath_report::pages::{self, REPORT};
use truepath_report::{
    InspectSummary, QifWall, aqdef, inspect_summary, judged_points_csv, points_csv, qif, statements,
};

use super::correction_files::{CONTOURS, contour_name, contour_place};
use super::readings::{DIMENSIONS, PROBE, Readings};
use crate::terminal::Terminal;
use truepath_report::next::correct;

/// One contact, for the list that is printed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Point {
    /// The contour it is on, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
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
    /// The unit in which people are told: that of the program.
    #[serde(skip)]
    pub unit: Unit,
    /// Decimals with which deviations are told in words, as those of a millimetre.
    #[serde(skip)]
    pub decimals: usize,
    /// What is said of the part, in that unit: the verdict, and what it rests on.
    #[serde(skip)]
    pub said: (String, Vec<String>),
}

/// Files this command may write.
const FILES: &[&str] = &["points.csv", "summary.json", PROBE, DIMENSIONS, REPORT, CONTOURS];

/// What is inspected.
#[derive(Clone, Debug, Default, Args)]
#[command(group = ArgGroup::new("written").multiple(true), group = ArgGroup::new("measured").required(true).multiple(true))]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// The probe file.
    #[arg(long, value_name = "FILE", group = "measured")]
    pub probe: Option<PathBuf>,
    /// Widths, diameters and distances measured on the part, beside the probe file or in its place.
    #[arg(long, group = "measured", value_name = "FILE.toml")]
    pub dimensions: Option<PathBuf>,
    /// Folder for report.html, the points as a table, the summary and the probe file as it is.
    #[arg(short, long, value_name = "DIR", group = "written")]
    pub output: Option<PathBuf>,
    /// File for the readings in Q-DAS ASCII transfer format (AQDEF), for a shop's statistics.
    #[arg(long, value_name = "FILE.dfq", group = "written")]
    pub aqdef: Option<PathBuf>,
    /// File for the inspection as a QIF 3 results document, for measuring software and quality systems.
    #[arg(long, value_name = "FILE.qif", group = "written")]
    pub qif: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "written")]
    pub force: bool,
    /// What is said of the part in place of the job.
    #[command(flatten)]
    pub part: PartFlags,
    /// What is said in place of the job.
    #[command(flatten)]
    pub said: Said,
}

/// Inspects and prints the report.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let inspection = run(options)?;
    terminal.warn_all(&inspection.summary.warnings);
    let Options { job, probe, dimensions, .. } = options;
    terminal
        .tell(&inspection, || words(&inspection) + &correct(job, probe.as_deref(), dimensions.as_deref()).to_string())
}

fn words(inspection: &Inspection) -> String {
    let (unit, name) = (inspection.unit, inspection.unit.name());
    let mut text = inspection.summary.feature.as_ref().map(|feature| listing(feature, unit)).unwrap_or_default();
    let judged = inspection.summary.tolerance.is_some();
    text += &format!("  line     s {name}       X {name}       Y {name}   height {name}   error {name}");
    text.push_str(if judged { "  verdict\n" } else { "\n" });
    let mut contour = None;
    for p in &inspection.contacts {
        if p.contour != contour {
            contour.clone_from(&p.contour);
            text += &format!("{}\n", contour.as_deref().unwrap_or_default());
        }
        text += &format!(
            "{:>6} {:>8.2} {:>10.4} {:>10.4} {:>11.3} {:>10.*}{}\n",
            p.line,
            unit.of(p.s_mm),
            unit.of(p.x_mm),
            unit.of(p.y_mm),
            unit.of(p.height_mm),
            inspection.decimals,
            unit.of(p.error_mm),
            p.verdict.map_or("", word)
        );
    }
    let s = &inspection.summary;
    text += &format!(
        "\n{}; material left is positive\nmean {:.4} {name} (a wear offset removes it), largest {:.d$}, smallest {:.d$}, rms {:.4}, spread over height {:.4} {name}\n",
        counted(s.points, "point"),
        unit.of(s.mean_error_mm),
        unit.of(s.max_error_mm),
        unit.of(s.min_error_mm),
        unit.of(s.rms_error_mm),
        unit.of(s.spread_over_height_mm),
        d = inspection.decimals
    );
    let wall = &s.surface;
    text += &format!(
        "{} (2 sigma); 95 % of the points within {:.4} {name}\nthe worst {}\n",
        wall.words(unit),
        unit.of(wall.p95_mm),
        wall.worst_words(unit)
    );
    let (verdict, statements) = &inspection.said;
    text += &statements.join("\n");
    text + &format!("\nverdict: {verdict}\n")
}

const fn word(verdict: PointVerdict) -> &'static str {
    match verdict {
        PointVerdict::Pass => "  pass",
        PointVerdict::Fail => "  FAIL",
        PointVerdict::Open => "  undecided",
    }
}

/// Compares a probe file with the walls of the job. A part that fails is no error: the command did its work, and the verdict
/// is in the summary.
///
/// # Errors
/// Whatever is wrong with job, program or probe file, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<Inspection, Failure> {
    let mut job = options.said.read(&options.job)?;
    job.override_part(&options.part)?;
    // What a part was cut with does not matter for how far its wall is off.
    let walls: Vec<Pass> = Pass::every(job)?.into_iter().map(|pass| pass.cut_with(CutWith::Anything)).collect();
    let readings = Readings::read(options.probe.as_deref(), options.dimensions.as_deref())?;
    let several = walls.len() > 1;
    let measured = readings.of_every(walls)?;
    let folder = options.output.as_ref().map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let mut inspected = Vec::new();
    for (pass, measurement) in measured.iter().filter(|(_, measurement)| !measurement.contacts.is_empty()) {
        inspected.push(one(pass, measurement, several)?);
    }
    if let Some(folder) = &folder {
        for wall in &inspected {
            let place = contour_place(wall.pass, several);
            let points = match wall.summary.tolerance {
                Some(_) => judged_points_csv(wall.measurement, &wall.judgement.points)?,
                None => points_csv(wall.measurement, &[])?,
            };
            folder.write(&format!("{place}points.csv"), &points)?;
            if several {
                folder.write(&format!("{place}summary.json"), &json(&wall.summary)?)?;
            }
        }
        readings.keep(folder)?;
    }
    if let Some(target) = &options.aqdef {
        let names: Vec<String> = inspected.iter().map(|wall| contour_name(wall.pass)).collect();
        let named = inspected.iter().zip(&names);
        let walls = named.map(|(wall, name)| (several.then_some(name.as_str()), wall.pass, wall.measurement));
        write_file(target, options.force, aqdef(&walls.collect::<Vec<_>>()).as_bytes())?;
    }
    let mut pages = Vec::new();
    for wall in &inspected {
        let page = pages::inspected(
            wall.pass,
            wall.measurement,
            [&wall.judgement, &wall.in_inches],
            &wall.summary,
            &wall.told,
        )?;
        pages.push((contour_name(wall.pass), page));
    }
    let inspection = together(&inspected, &measured)?;
    if let Some(target) = &options.qif {
        write_file(target, options.force, document(&inspected, inspection.summary.verdict.state).as_bytes())?;
    }
    if let Some(folder) = folder {
        folder.write("summary.json", &json(&inspection.summary)?)?;
        folder.write(REPORT, &render_all(&pages)?)?;
        folder.commit()?;
    }
    Ok(inspection)
}

/// A wall that was touched, and what is said of it.
struct Inspected<'a> {
    pass: &'a Pass,
    measurement: &'a Measurement,
    rule: Option<Rule>,
    aside: SetAside,
    judgement: Judgement,
    /// The same in inches.
    in_inches: Judgement,
    summary: InspectSummary,
    /// Warnings without one for every reading set aside.
    told: Vec<Remark>,
    contacts: Vec<Point>,
}

fn one<'a>(pass: &'a Pass, measurement: &'a Measurement, several: bool) -> Result<Inspected<'a>, Failure> {
    let mut misreadings = misread(pass, false, &measurement.contacts);
    misreadings.extend(noticed(pass, measurement).filter(|_| !measurement.taken_as_is));
    let told: Vec<Remark> = pass.warnings.iter().chain(&misreadings).cloned().collect();
    let warnings = [pass.warnings.clone(), measurement.remarks(&measurement.source), misreadings].concat();
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
    // Files are in millimetres, the page has both units.
    let judged = |unit| judge(rule, &deviations, aside, &coverage, unit);
    let (judgement, in_inches) = (judged(Unit::Millimetre), judged(Unit::Inch));
    let name = several.then(|| contour_name(pass));
    let contacts = measurement.contacts.iter().enumerate().map(|(at, c)| Point {
        contour: name.clone(),
        line: c.line,
        s_mm: mm(c.s),
        x_mm: c.point.x.nm() as f64 / 1e6,
        y_mm: c.point.y.nm() as f64 / 1e6,
        height_mm: truepath_ground::units::float(c.height) * mm(depth),
        error_mm: mm(c.error),
        verdict: judgement.points.get(at).copied(),
    });
    let contacts = contacts.collect();
    let summary = inspect_summary(pass, measurement, &judgement, coverage, warnings);
    let summary = InspectSummary { contour: name, ..summary };
    Ok(Inspected { pass, measurement, rule, aside, judgement, in_inches, summary, told, contacts })
}

/// The inspection as a QIF document.
fn document(inspected: &[Inspected<'_>], state: State) -> String {
    let walls = inspected.iter().map(|wall| QifWall {
        name: wall.summary.contour.as_deref(),
        pass: wall.pass,
        measurement: wall.measurement,
        judgement: &wall.judgement,
    });
    qif(&walls.collect::<Vec<_>>(), state)
}

/// The report on all walls of a part.
fn together(inspected: &[Inspected<'_>], measured: &[(Pass, Measurement)]) -> Result<Inspection, Failure> {
    let nothing = || Failure::Internal("no wall was inspected".to_owned());
    if let ([one], [_]) = (inspected, measured) {
        let (summary, contacts) = (one.summary.clone(), one.contacts.clone());
        let unit = one.pass.unit();
        let judged = if unit == Unit::Inch { &one.in_inches } else { &one.judgement };
        let statements = statements(judged, &summary.surface, summary.feature.as_ref(), unit);
        let told = Judgement { statements, ..judged.clone() };
        return Ok(inspection(summary, contacts, unit, told));
    }
    let rule = inspected.first().and_then(|wall| wall.rule);
    let deviations: Vec<Offset> =
        inspected.iter().flat_map(|wall| wall.measurement.contacts.iter().map(|c| c.error)).collect();
    let mut aside = inspected.iter().fold(SetAside::default(), |so_far, wall| so_far.and(wall.aside));
    let mut warnings = Vec::new();
    let (mut walls, mut all_said) = (Vec::new(), Vec::new());
    for (pass, measurement) in measured {
        let name = contour_name(pass);
        let own = inspected.iter().find(|wall| std::ptr::eq(wall.pass, pass));
        if own.is_none() {
            let reasons = measurement.rejected.iter().map(|r| &r.reason);
            aside = aside.and(SetAside::of(reasons, pass.job.numbers.tool.diameter));
            warnings.push(format!("{name} was not touched: nothing is said of it").into());
        }
        let said = own.map_or_else(|| measurement.remarks(&measurement.source), |wall| wall.summary.warnings.clone());
        all_said.push((name.clone(), said));
        walls.push((name, own.and_then(|wall| wall.summary.coverage.as_ref())));
    }
    warnings.extend(said_of_every(all_said.iter().map(|(name, said)| (name.as_str(), &said[..]))));
    let walls: Vec<NamedWall<'_>> = walls.iter().map(|(name, coverage)| (name.as_str(), *coverage)).collect();
    let unit = measured.first().map(|(pass, _)| pass.unit()).unwrap_or_default();
    let judged = |unit| judge_every(rule, &deviations, aside, &walls, unit);
    let judgement = judged(Unit::Millimetre);
    let contacts = inspected.iter().flat_map(|wall| wall.contacts.clone()).collect();
    let contours = inspected.iter().map(|wall| wall.summary.clone()).collect();
    let summary = InspectSummary::of_every(contours, &judgement, warnings).ok_or_else(nothing)?;
    Ok(inspection(summary, contacts, unit, judged(unit)))
}

/// The report, with what is told to people in a unit.
fn inspection(summary: InspectSummary, contacts: Vec<Point>, unit: Unit, told: Judgement) -> Inspection {
    let Judgement { verdict, statements, decimals, .. } = told;
    Inspection { summary, contacts, unit, decimals, said: (verdict.text, statements) }
}
