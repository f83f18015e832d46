//! `learn`: from the probe file of a part that was cut with a correction to the correction of the next part; of one that was cut with
//! planned passes, to the planned program of the next.

mod planned;
mod several;

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use truepath_correction::as_milled::AsMilled;
use truepath_correction::codes::{Q002, Q003, Q005, Q007};
use truepath_correction::learn::{LearnSummary, learn};
use truepath_correction::surface::touched::TouchedSurface;
use truepath_ground::codes::C001;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::files;
use truepath_ground::output::OutputFolder;
use truepath_ground::units::mm;
use truepath_job::job::{PartFlags, ROUTES, Route, Said, one_of};
use truepath_job::pass::Pass;
use truepath_job::signing::SignFlags;
use truepath_report::correction_csv;
use truepath_report::page::render;
use truepath_report::pages::learned;

pub use self::planned::LearnedPlanSummary;
use super::begin::BeginFlags;
use super::correct::words as correction;
use super::correction_files::{FILES, HISTORY, MILLED, commit, write_contour, write_program};
use super::history::{history_in, holds_planned};
use super::plan_files::PLAN_HISTORY;
use super::readings::Readings;
#[cfg(not(target_family = "wasm"))]
use super::store::keep::keep;
use crate::terminal::Terminal;
use truepath_report::next::after_correction;

/// What is learned from.
#[derive(Clone, Debug, Default, Args)]
#[command(group = ArgGroup::new("measured").required(true).multiple(true))]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// What the probe measured on the part cut with the correction in --from.
    #[arg(long, value_name = "FILE", group = "measured")]
    pub probe: Option<PathBuf>,
    /// Widths, diameters and distances measured on that part, beside the probe file or in its place.
    #[arg(long, group = "measured", value_name = "FILE.toml")]
    pub dimensions: Option<PathBuf>,
    /// Number of that part in the order they were cut, where those between it and the last that was learned from were not touched: it
    /// tells how far the cutter may have worn.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub part: Option<u32>,
    /// The next part is cut with a new cutter: its correction is for the force that the parts say a new one needs.
    #[arg(long)]
    pub new_cutter: bool,
    /// Folder that truepath correct, truepath plan or truepath learn wrote that correction into.
    #[arg(long, value_name = "DIR")]
    pub from: PathBuf,
    /// Folder for the correction of the next part; another one than --from.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Correct in the program text or in the coprocessor; the job says it otherwise.
    #[arg(long, value_parser = one_of(&ROUTES))]
    pub route: Option<Route>,
    /// Half the width of the tolerance of the wall at every height, mm, or with its unit (0.0005in, 12um), in place
    /// of the limits of the job: says whether one pass holds it; of planned passes in place of that of the plan.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub tolerance: Option<String>,
    /// Of a part cut with planned passes: search for passes anew, instead of designing the same ones anew.
    #[arg(long)]
    pub replan: bool,
    /// Where the fit begins.
    #[command(flatten)]
    pub begin: BeginFlags,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
    /// Who signs an image.
    #[command(flatten)]
    pub sign: SignFlags,
    /// What is said in place of the job.
    #[command(flatten)]
    pub said: Said,
}

/// Learns and prints what was learned.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    if of_planned(options) {
        planned::tell(&terminal.watch("learning", |progress| run_planned(options, progress))?, terminal)?;
        #[cfg(not(target_family = "wasm"))]
        keep((&options.job, options.begin.store.as_deref()), &options.output, "learn", terminal);
        return Ok(());
    }
    let summary = terminal.watch("learning", |progress| run(options, progress))?;
    terminal.warn_all(&summary.correct.warnings);
    let (job, output) = (&options.job, &options.output);
    #[cfg(not(target_family = "wasm"))]
    keep((job, options.begin.store.as_deref()), output, "learn", terminal);
    terminal.tell(&summary, || {
        words(&summary)
            + &correction(&summary.correct, output)
            + &after_correction(&summary.correct, job, Some(output)).to_string()
    })
}

fn words(s: &LearnSummary) -> String {
    let (v, whole) = (&s.verdict, &s.whole_contour_error_mm);
    let (unit, name) = (s.correct.unit, s.correct.unit.name());
    let (measured, surface) = (&s.measured_surface, &s.whole_surface);
    if !s.contours.is_empty() {
        return several::table(&s.contours, unit);
    }
    let mut text = format!(
        "part {} at {}, error of the target      largest      rms\n\
         \x20 measured                           {:>12.4} {:>8.4} {name}\n\
         \x20 part {} there                       {:>12.4} {:>8.4} {name}\n\
         \x20 promised{}                    {:>12.4}          {name}, {} of {} places within 2 sigma\n\
         \x20 whole contour, by the model        {:>12.4}          {name}, at s = {:.1} {name}, sigma {:.4} {name}\n\
         at any height\n\
         \x20 measured, at the touched heights   {:>12.4} ± {:.4} {name}, 95 % within {:.4} {name}\n\
         \x20   {}\n\
         \x20 whole wall, by the model           {:>12.4} ± {:.4} {name}, 95 % within {:.4} ± {:.4} {name}\n\
         \x20   {}\n",
        v.part,
        counted(v.measured_error_mm.places, "place"),
        unit.of(v.measured_error_mm.max_mm),
        unit.of(v.measured_error_mm.rms_mm),
        v.previous_error_mm.part,
        unit.of(v.previous_error_mm.max_mm),
        unit.of(v.previous_error_mm.rms_mm),
        if v.promise.max_mm < s.correct.floor_mm { ": floor" } else { "       " },
        unit.of(s.correct.floor.or(v.promise.max_mm)),
        v.promise.within_two_sigma,
        v.promise.places,
        unit.of(whole.max_mm),
        unit.of(whole.s_mm),
        unit.of(whole.sigma_mm),
        unit.of(measured.profile_mm),
        unit.of(2.0 * measured.sigma_mm),
        unit.of(measured.p95_mm),
        measured.worst_words(unit),
        unit.of(surface.profile.profile_mm),
        unit.of(2.0 * surface.profile.sigma_mm),
        unit.of(surface.p95_mm),
        unit.of(2.0 * surface.p95_sigma_mm),
        surface.worst_words(unit),
    );
    if let Some(held) = &v.holdout_residual_mm {
        text += &format!(
            "\x20 at {} kept from a first fit the model missed {:.4} {name} before and {:.4} {name} after learning\n",
            counted(held.places.len(), "place"),
            unit.of(held.before_mm),
            unit.of(held.after_mm)
        );
    }
    if let Some(again) = v.used_again.filter(|_| v.rolled_back) {
        text += &format!("  rolled back: {}\n", again.words());
    }
    text + &format!("\ncorrection of part {}\n", v.part.saturating_add(1))
}

/// Whether the part was cut with planned passes.
pub fn of_planned(options: &Options) -> bool {
    holds_planned(&options.from)
}

/// Learns from a part that was cut with planned passes, and writes the outputs.
///
/// # Errors
/// A folder without a history of planned passes, what they cannot be learned from, and outputs that cannot be written.
pub fn run_planned(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<LearnedPlanSummary, Failure> {
    refuse_same_folder(options)?;
    if let Some(part) = options.part {
        let help = "leave it out: a plan is learned from part after part";
        return Err(InputError::new(C001, format!("--part {part}"), "no number for planned passes", help).into());
    }
    if options.new_cutter {
        let help = "leave it out: the plan allows for what parts differ in; touch the part that the new cutter makes and learn from it";
        return Err(InputError::new(C001, "--new-cutter", "no new cutter for planned passes", help).into());
    }
    let mut job = options.said.read(&options.job)?;
    job.signer = options.sign.signer()?;
    job.override_part(&PartFlags { tolerance: options.tolerance.clone(), ..PartFlags::default() })?;
    let tolerance = options.tolerance.as_ref().and(job.part.tolerance);
    let tolerance_mm = tolerance.map(|tolerance| mm(tolerance.upper).min(-mm(tolerance.lower)));
    let to = (options.output.as_path(), options.force);
    let wish = planned::Wish { replan: options.replan, tolerance_mm, route: options.route };
    let Some(probe) = options.probe.as_deref().filter(|_| options.dimensions.is_none()) else {
        let found = "--dimensions of a part that was cut with planned passes";
        let help = "touch it with a probe: planned passes are learned from points at several heights";
        return Err(InputError::new(C001, found, "--probe", help).into());
    };
    planned::run((job, &options.begin), (probe, &options.from), to, wish, progress)
}

/// Learns and writes the outputs.
///
/// # Errors
/// As [`learn`], a folder without a history or with another corrected program, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<LearnSummary, Failure> {
    if options.replan {
        let found = format!("--replan, and {} holds no {PLAN_HISTORY}", options.from.display());
        let help = "leave --replan out, or name a folder of truepath plan --write with --from";
        return Err(InputError::new(C001, found, "a folder of planned passes", help).into());
    }
    refuse_same_folder(options)?;
    let mut job = options.said.read(&options.job)?;
    job.signer = options.sign.signer()?;
    job.override_part(&PartFlags { tolerance: options.tolerance.clone(), ..PartFlags::default() })?;
    let readings = Readings::read(options.probe.as_deref(), options.dimensions.as_deref())?;
    let pass = match <[Pass; 1]>::try_from(Pass::every(job)?) {
        Ok([only]) => only,
        Err(walls) => {
            let to = (options.output.as_path(), options.force, options.route);
            let Options { from, part, new_cutter, .. } = options;
            let measured = several::Measured { readings: &readings, from, part: *part, new_cutter: *new_cutter };
            return several::run(options.begin.passes(walls), &measured, to, progress);
        }
    };
    let history = history_in(&options.from, &options.from)?.of_part(options.part)?;
    let history = history.before_a_new_cutter(options.new_cutter);
    let level = history.facts.level().filter(|_| options.said.which.pass.is_none() && pass.plan.is_some());
    let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass).cut_with(history.cut_with());
    let pass = options.begin.pass(pass);
    let measurement = readings.of_corrected(&pass)?;
    let folder = OutputFolder::create(&options.output, options.force, FILES)?;
    let remarks = measurement.remarks(&measurement.source);
    let routes = [options.route.unwrap_or(pass.job.route)];
    let done = learn(&pass, &history, &measurement, &remarks, &routes, progress).map_err(|failure| match failure {
        Failure::Input(error) if [Q003.code, Q007.code].contains(&error.code()) => {
            error.in_file(readings.path()).into()
        }
        Failure::Input(error) if error.code() == Q002.code && error.line_column().is_none() => {
            error.in_file(&options.from.join(HISTORY)).into()
        }
        failure => failure,
    })?;
    let milled = AsMilled::of(&pass, &history, &done.corrected)?;
    let summary = LearnSummary {
        correct: done.corrected.summary.clone(),
        verdict: done.verdict,
        whole_contour_error_mm: milled.whole_contour(),
        whole_surface: milled.surface,
        measured_surface: TouchedSurface::of_measurement(&pass, &measurement),
        contours: Vec::new(),
    };
    write_program(&folder, &pass, &done.corrected)?;
    write_contour(&folder, "", &measurement, &done.corrected, Some(&done.history))?;
    folder.write(MILLED, &correction_csv(&milled.rows)?)?;
    let page = learned(&pass, &measurement, &done.corrected, &milled, &summary)?;
    commit(folder, &readings, &summary, &render(&page)?)?;
    Ok(summary)
}

/// The old correction must outlive the new one: it is what the measured part was cut with.
fn refuse_same_folder(options: &Options) -> Result<(), InputError> {
    let same = match (files::canonical(&options.from), files::canonical(&options.output)) {
        (Ok(from), Ok(out)) => from == out,
        _ => options.from == options.output,
    };
    if !same {
        return Ok(());
    }
    let found = format!("--from and -o are both {}", options.from.display());
    Err(Q005.error(found, "two folders").in_file(&options.output))
}
