//! `probe`: the verification program of a job.

mod dimensions;
mod next;
mod options;

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path as FilePath;

use clap::ValueEnum;
use truepath_correction::verification::{
    Gained, KeptOff, Plan, ProbeDialect, STOCK_HEIGHTS, Settings, Unknown, plan_every, plan_stock, write,
};
use truepath_ground::codes::C001;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::OutputFile;
use truepath_job::job::{Assumed, JobFile};
use truepath_job::pass::Pass;

pub use self::options::Options;
use crate::terminal::Terminal;
use truepath_report::next::{after_verification, shown};

/// Further places that are looked for, when the user does not say how many.
const FURTHER: u32 = 4;

/// Plans, and prints the places.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    if let (true, Some(output)) = (options.dimensions, &options.output) {
        return dimensions::main(options, output, terminal);
    }
    let report = terminal.watch("choosing places", |progress| run(options, progress))?;
    terminal.warn_all(&report.warnings);
    let written = options.output.as_ref().map(|out| {
        let next = match (options.stock, &options.from) {
            (true, _) => {
                "next: run it before the finishing pass, and name its results in the job: [stock] probe = \"FILE\"\n"
                    .to_owned()
            }
            (false, Some(from)) => format!(
                "next: give its results to truepath learn {} --probe FILE --from {} -o DIR\n",
                shown(&options.job),
                shown(from)
            ),
            (false, None) => after_verification(&options.job, out).to_string(),
        };
        format!("written to {}\n{next}", out.display())
    });
    let listed = || match options.next || options.stock {
        true => String::new(),
        false => format!(
            "next: -o FILE writes the program that touches them; or touch them with one of your own, and\n  truepath correct {} --probe FILE -o DIR\n",
            shown(&options.job)
        ),
    };
    terminal.tell(&report, || words(&report) + &written.unwrap_or_else(listed))
}

fn words(report: &Report) -> String {
    let (unit, name) = (report.unit, report.unit.name());
    let mut text = format!(" point      s {name}       X {name}       Y {name}       Z {name}\n");
    let mut last = usize::MAX;
    let mut contour = None;
    for p in &report.points {
        if p.contour != contour {
            contour.clone_from(&p.contour);
            let _ = writeln!(text, " {}", contour.as_deref().unwrap_or_default());
        }
        if p.rank != last {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "       {} (line {}): {}", p.what, p.line, p.why);
            if let Some(gain) = p.gain {
                let _ = writeln!(
                    text,
                    "       corrected wall least certain at s = {:.2} {name}: {:.4} {name} -> {:.4} {name} (one sigma){}",
                    unit.of(gain.worst_s_mm),
                    unit.of(gain.max_sigma_before_mm),
                    unit.of(gain.max_sigma_after_mm),
                    if gain.worth_it { "" } else { ", below the noise of a reading" }
                );
            }
            last = p.rank;
        }
        let _ = writeln!(
            text,
            "{:>6} {:>9.2} {:>10.4} {:>10.4} {:>10.4}  {}",
            p.id,
            unit.of(p.s_mm),
            unit.of(p.x_mm),
            unit.of(p.y_mm),
            unit.of(p.z_mm),
            p.why_height
        );
    }
    if let Some(why) = &report.heights_why {
        let _ = writeln!(text, "\n{why}");
    }
    if !report.unknowns.is_empty() {
        text += "\nuncertainty left of what the job states:";
    }
    for u in &report.unknowns {
        let _ = write!(text, " {} {:.0} %;", u.words, 100.0 * u.remaining);
    }
    let wall = if report.points.iter().any(|p| p.gain.is_some()) {
        "corrected wall where it is least certain"
    } else {
        "predicted wall"
    };
    if let (Some(before), Some(after)) = (report.wall_sigma_before_mm, report.wall_sigma_after_mm) {
        let (before, after) = (unit.of(before), unit.of(after));
        let _ = writeln!(text, "\n{wall}, one sigma: {before:.4} {name} before the touches, {after:.4} {name} after");
    } else {
        text += "\nthe stock is touched, before the finishing pass: name the results in stock.probe of the job\n";
    }
    for kept in &report.kept_off {
        let _ = writeln!(text, "kept off {} {}", counted(kept.places, "place"), kept.words);
    }
    let _ = writeln!(
        text,
        "safe height Z{:.3} {name}, stand-off {:.3} {name} before the wall{}",
        unit.of(report.safe_z_mm),
        unit.of(report.clearance_mm),
        report.probe_format.map_or_else(String::new, |f| format!("; read the results with [probe] format = \"{f}\""))
    );
    text
}

/// A point of the program, for the list that is printed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Point {
    /// Its number in program and results.
    pub id: usize,
    /// The contour it is of; absent where the plan is of one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Line of the part's program.
    pub line: u32,
    /// Nominal contact, mm.
    pub x_mm: f64,
    /// Nominal contact, mm.
    pub y_mm: f64,
    /// Programmed Z, mm.
    pub z_mm: f64,
    /// Unit normal from the wall to the free side.
    pub normal: [f64; 2],
    /// Height above the cutter's tip, mm.
    pub height_mm: f64,
    /// What is there.
    pub what: String,
    /// Why this place: what its touches tell.
    pub why: String,
    /// Why this height.
    pub why_height: &'static str,
    /// How many places were chosen before this one.
    pub rank: usize,
    /// What the touches of its place are expected to bring; absent when nothing was measured before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<Gained>,
}

/// Places looked at and kept off.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Kept {
    /// The reason.
    pub reason: KeptOff,
    /// In words.
    pub words: &'static str,
    /// How many.
    pub places: usize,
}

/// What was planned.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Report {
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// The control; absent when no program was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dialect: Option<ProbeDialect>,
    /// `[probe] format` for the file of results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe_format: Option<&'static str>,
    /// Every touch, in the order of the program.
    pub points: Vec<Point>,
    /// Why the heights are what they are; absent where they are spread evenly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights_why: Option<String>,
    /// Height between places, mm.
    pub safe_z_mm: f64,
    /// Distance of the ball's surface from the wall at the stand-off, mm.
    pub clearance_mm: f64,
    /// What the touches leave of every unknown.
    pub unknowns: Vec<Unknown>,
    /// Standard deviation of the wall before the touches, mm: of the predicted wall, root mean square, or, of further
    /// places, the largest of the corrected wall; absent where the stock is touched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_sigma_before_mm: Option<f64>,
    /// The same after them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_sigma_after_mm: Option<f64>,
    /// Where the plan keeps off.
    pub kept_off: Vec<Kept>,
    /// What the job does not say and was taken from the program or a default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Assumed>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// Plans and writes. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program or choices, and an output that cannot be written.
fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<Report, Failure> {
    // A target that may not be written is refused before the work.
    let file = options.output.as_ref().map(|out| OutputFile::create(out, options.force)).transpose()?;
    let usual = if options.next { FURTHER } else { options.settings.places };
    let heights = options.settings.heights.or(options.stock.then_some(STOCK_HEIGHTS));
    let (places, exactly) = (options.points.unwrap_or(usual), options.points.is_some());
    let settings = Settings { places, exactly, heights, ..options.settings.clone() };
    let mut job = JobFile::read(&options.job)?;
    job.which = options.which.clone();
    let dialect = match options.dialect {
        None if options.output.is_some() => Some(control(&job)?),
        given => given,
    };
    let plan = if options.next {
        job.override_probe(&options.probe_flags)?;
        next::of_files((job, &options.begin), (options.probe.as_deref(), options.from.as_deref()), &settings, progress)?
    } else if options.stock {
        // It is what the touches are to find.
        job.stock_probe = None;
        plan_stock(&Pass::every(job)?, &settings, (options.points, options.stock_margin))?
    } else {
        plan_every(&options.walls(job)?, &settings, progress)?
    };
    if let (Some(dialect), Some(out), Some(mut file)) = (dialect, &options.output, file) {
        let text = write(&plan, dialect, &log_name(out))?;
        file.write_all(text.as_bytes()).map_err(|e| InputError::unwritable(out, &e))?;
        file.commit()?;
    }
    Ok(report(&plan, dialect))
}

/// The control of the part's program.
fn control(job: &JobFile) -> Result<ProbeDialect, InputError> {
    let known = job.probe_control.and_then(|name| ProbeDialect::from_str(name, true).ok());
    known.ok_or_else(|| {
        let found =
            "--dialect is not given, and job and program name no control that a verification program is written for";
        let conversational = job.numbers.dialect.is_klartext();
        let help = if conversational {
            "no verification program is written in conversational language: leave -o out, which lists the places, touch them with a program of your own (TCH PROBE 3 and FN 16) or with --dialect of another control, and give its file, a table of any layout, to --probe"
        } else {
            "add --dialect of the control that the probe is on; grbl for grbl and grblHAL"
        };
        InputError::new(C001, found, "one of haas, fanuc, linuxcnc, grbl", help)
    })
}

/// The report of a plan.
pub fn report(plan: &Plan, dialect: Option<ProbeDialect>) -> Report {
    let points = plan.touches().map(|touch| Point {
        id: touch.id,
        contour: touch.place.contour.clone(),
        s_mm: touch.place.s_mm,
        line: touch.place.line,
        x_mm: touch.place.wall[0],
        y_mm: touch.place.wall[1],
        z_mm: touch.height.z_mm,
        normal: touch.place.normal,
        height_mm: touch.height.above_tip_mm,
        what: touch.place.what.clone(),
        why: touch.place.why.clone(),
        why_height: touch.height.why,
        rank: touch.place.rank,
        gain: touch.place.gain,
    });
    let sigma = plan.wall_sigma_mm.map(|sigma| (!plan.before_the_pass).then_some(sigma));
    Report {
        unit: plan.program.units.into(),
        dialect,
        probe_format: dialect.map(ProbeDialect::probe_format),
        points: points.collect(),
        heights_why: plan.heights_why.clone(),
        safe_z_mm: plan.safe_z_mm,
        clearance_mm: plan.settings.clearance,
        unknowns: plan.unknowns.clone(),
        wall_sigma_before_mm: sigma[0],
        wall_sigma_after_mm: sigma[1],
        kept_off: plan
            .kept_off
            .iter()
            .map(|(reason, places)| Kept { reason: *reason, words: reason.words(), places: *places })
            .collect(),
        assumed: plan.assumed.clone(),
        warnings: plan.warnings.clone(),
    }
}

/// Name of the file of results beside the program, in letters that no control stumbles over.
pub(super) fn log_name(out: &FilePath) -> String {
    let stem = out.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let stem: String = stem.chars().filter(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')).collect();
    let stem = if stem.is_empty() { "verification" } else { &stem };
    format!("{stem}-log.txt")
}
