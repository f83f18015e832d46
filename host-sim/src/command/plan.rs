//! `plan`: which passes hold a tolerance at every height of the wall, in least time.

use std::path::{Path as FilePath, PathBuf};
use std::sync::mpsc::channel;

use clap::Args;
use truepath_core::checksum::crc32;
use truepath_correction::plan::choice::{Plan, Planner, Wanted};
use truepath_correction::plan::wall::WallFigures;
use truepath_correction::planned::PlannedDepth;
use truepath_correction::summary::name_with;
use truepath_ground::codes::{C001, J004, J008};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::limits::Limits;
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{JobFile, ProbeFlags, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::{planned_map_csv, planned_page};

use crate::terminal::Terminal;

/// Files this command may write.
const FILES: &[&str] = &["summary.json", REPORT, PROGRAM, "difference.txt", "wall-map.csv", NAMED];
/// The written program, beside the one of its own name.
const PROGRAM: &str = "planned.nc";
/// Stands for that name when the folder is claimed.
const NAMED: &str = "*.planned*";
/// The page.
const REPORT: &str = "report.html";
/// Half the width of a tolerance.
const TOLERANCE: Limits = Limits::within("0.0001", "10", "mm");
/// Share of parts that have to be within it.
const CONFIDENCE: Limits = Limits::within("50", "99.9", "%");

/// What is planned.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE")]
    pub probe: PathBuf,
    /// Half the width of the tolerance of the wall at every height, mm; without it that of `[part]`.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub tolerance: Option<String>,
    /// Percent of the machines that the points allow whose wall has to be within the tolerance.
    #[arg(long, value_name = "PERCENT", default_value = "95")]
    pub confidence: String,
    /// Folder for the summary, the page and the program.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write the program of a choice, by its number in the table, or of the one recommended.
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "recommended", requires = "output")]
    pub write: Option<String>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// What is said of the probe file in place of the job.
    #[command(flatten)]
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

/// A plan, and what the user should know.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PlanSummary {
    /// Version of this file.
    pub version: u32,
    /// The plan.
    #[serde(flatten)]
    pub plan: Plan,
    /// The choice whose program was written.
    pub written: Option<Written>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// A written program.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Written {
    /// Number of the choice.
    pub choice: usize,
    /// The file to load at the machine.
    pub program: PathBuf,
    /// The wall that it leaves, as the identified machine cuts it.
    pub wall: WallFigures,
    /// Largest distance of a commanded place from the programmed path, mm.
    pub largest_correction_mm: f64,
    /// Where the passes stand.
    pub depths: Vec<PlannedDepth>,
}

/// Plans and prints the choices.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = terminal.watch("planning", |progress| run(options, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary))
}

fn words(summary: &PlanSummary) -> String {
    let plan = &summary.plan;
    let um = |mm: f64| mm * 1e3;
    let mut text = format!(
        "as programmed: {:.1} um at the worst place of the wall (mean over the height {:.1} um), {:.2} min\n\
         wanted: {:.1} um at every height, with {:.0} %\n\n\
         \x20      time     profile error   within   passes\n\
         \x20      ratio    um, 2 sigma\n",
        um(plan.as_programmed.profile_mm),
        um(plan.as_programmed.mean_mm),
        plan.minutes,
        um(plan.tolerance_mm),
        plan.confidence * 100.0
    );
    for (k, choice) in plan.choices.iter().enumerate() {
        let mark = if plan.recommended == Some(k + 1) { '*' } else { ' ' };
        text += &format!(
            "{mark} {}  {:>6.2}  {:>7.1} ± {:<6.1} {:>5.0} %   {}; most of it {}\n",
            k + 1,
            choice.time_ratio,
            um(choice.predicted.profile_mm),
            um(2.0 * choice.predicted.sigma_mm),
            choice.within_tolerance * 100.0,
            choice.process,
            choice.limited_by,
        );
    }
    text += &match (plan.recommended, plan.choices.last()) {
        (Some(k), _) => format!("\n* choice {k} is the fastest that holds the tolerance\n"),
        (None, Some(best)) => {
            let needed = best.predicted.profile_mm + 2.0 * best.predicted.sigma_mm;
            format!(
                "\nnone holds it: the best is expected within {:.1} um with 2 sigma, {:.1} um beyond the tolerance\n",
                um(needed),
                um((needed - plan.tolerance_mm).max(0.0))
            )
        }
        (None, None) => "\nno process keeps the limits of [plan]\n".to_owned(),
    };
    match &summary.written {
        Some(written) => {
            let name = written.program.display();
            text += &format!(
                "\nchoice {} written: {name}, {} passes\nnext: mill a new part with it, touch its wall, and see what truepath inspect says\n",
                written.choice,
                written.depths.iter().map(|depth| depth.passes.len()).sum::<usize>()
            );
        }
        None if !plan.choices.is_empty() => text += "next: --write N -o DIR writes the program of a choice\n",
        None => {}
    }
    text
}

/// Plans, and writes summary and table where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program, probe file or options, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<PlanSummary, Failure> {
    let mut job = JobFile::read(&options.job)?;
    job.override_probe(&options.probe_flags)?;
    job.which = options.which.clone();
    let wanted = wanted(options, &job)?;
    let pass = Pass::read(job)?;
    if pass.surface.is_some() {
        let found = "stock.surface is given: the allowance is not even";
        let help = "plan the job of the whole, even allowance";
        let error = InputError::new(J008, found, "a job with stock.allowance_mm", help);
        return Err(error.at(pass.job.source(), pass.job.span("stock.surface")).into());
    }
    let file = Source::read(&options.probe)?;
    let (pass, measurement) = Measurement::of_one(pass, &file)?;
    let folder = options.output.as_ref().map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let planner = Planner::new(&pass, &measurement, |share| progress(0.1 * share))?;
    let (limits, said) = planner.possible(wanted.limits);
    let wanted = Wanted { limits, ..wanted };
    // The search uses all cores; the bar belongs to this thread.
    let (tell, told) = channel();
    let searching = &planner;
    let plan = std::thread::scope(|scope| {
        let work = scope.spawn(move || {
            searching.plan(&wanted, &move |share| {
                let _ = tell.send(share);
            })
        });
        told.iter().for_each(|share| progress(0.1 + 0.8 * share));
        work.join().unwrap_or_else(|_| Err(Failure::Internal("the search for a plan broke off".to_owned())))
    })?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(measurement.remarks(&file));
    warnings.extend(said);
    let chosen = options.write.as_deref().map(|text| chosen(text, &plan)).transpose()?;
    let mut summary = PlanSummary { version: 1, plan, written: None, warnings };
    let Some(folder) = folder else { return Ok(summary) };
    if let Some(number) = chosen {
        let cuts = &summary.plan.choices[number - 1].cuts;
        let written = planner.write(cuts, crc32(file.bytes()), &mut |share| progress(0.9 + 0.1 * share))?;
        let name = name_with(pass.program.name(), "planned");
        for file in [PROGRAM, &name] {
            folder.write(file, &written.program.text)?;
        }
        folder.write("difference.txt", written.program.report.as_bytes())?;
        folder.write("wall-map.csv", &planned_map_csv(&written.map)?)?;
        summary.warnings.extend(written.program.warnings);
        summary.written = Some(Written {
            choice: number,
            program: options.output.clone().unwrap_or_default().join(name),
            wall: written.wall,
            largest_correction_mm: written.largest_correction_mm,
            depths: written.program.depths,
        });
    }
    folder.write("summary.json", &json(&summary)?)?;
    folder.write(REPORT, planned_page(&summary.plan, &program_name(&pass)).as_bytes())?;
    folder.commit()?;
    Ok(summary)
}

/// The number of the choice that is to be written.
fn chosen(text: &str, plan: &Plan) -> Result<usize, Failure> {
    let number = if text == "recommended" { plan.recommended } else { text.parse().ok() };
    number.filter(|n| (1..=plan.choices.len()).contains(n)).ok_or_else(|| {
        let found = match text {
            "recommended" => "--write without a number, and no choice holds the tolerance".to_owned(),
            text => format!("--write on the command line is {text:?}"),
        };
        let expected = format!("the number of a choice, 1 to {}", plan.choices.len());
        InputError::new(C001, found, expected, "look at the table without --write, and write its number").into()
    })
}

fn program_name(pass: &Pass) -> String {
    let name = FilePath::new(pass.program.name()).file_name();
    name.map_or_else(|| pass.program.name().to_owned(), |name| name.to_string_lossy().into_owned())
}

fn wanted(options: &Options, job: &JobFile) -> Result<Wanted, Failure> {
    let flag = |name: &str, text: &str, limits: Limits, help: &str| {
        let number = Decimal::parse(text).filter(|n| limits.admits(*n)).map(Decimal::as_f64);
        number.ok_or_else(|| {
            let found = format!("{name} on the command line is {text:?}");
            Failure::from(InputError::new(C001, found, limits.phrase(), help))
        })
    };
    let tolerance_mm = match &options.tolerance {
        Some(text) => flag("--tolerance", text, TOLERANCE, "write --tolerance 0.02 for ±0.02 mm at every height")?,
        None => match job.part.tolerance {
            Some(tolerance) => {
                truepath_ground::units::mm(tolerance.upper).min(-truepath_ground::units::mm(tolerance.lower))
            }
            None => {
                let help = "write --tolerance 0.02 for ±0.02 mm, or tolerance_mm under [part] of the job";
                let error = InputError::new(J004, "no tolerance to plan for", "half the width of one", help);
                return Err(error.in_file(&options.job).into());
            }
        },
    };
    let confidence =
        flag("--confidence", &options.confidence, CONFIDENCE, "write --confidence 95 for 95 of 100 parts")? / 100.0;
    Ok(Wanted { tolerance_mm, confidence, limits: job.plan })
}
