//! `correct`: from a probe file to the corrected program or the correction image.

mod identify;
mod several;

use std::path::{Path as FilePath, PathBuf};

use clap::{ArgGroup, Args};
use truepath_correction::correct::correct_pass;
use truepath_correction::learning::History;
use truepath_correction::second_pass;
use truepath_correction::summary::CorrectSummary;
use truepath_correction::warnings::misread;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_ground::output::OutputFolder;
use truepath_job::feature::listing;
use truepath_job::job::{PartFlags, ROUTES, Route, Said, one_of};
use truepath_job::pass::Pass;
use truepath_job::signing::SignFlags;
use truepath_program::first_pass_of;
use truepath_report::page::render;
use truepath_report::pages;
use truepath_report::pages::{Points, REPORT};

use super::begin::BeginFlags;
pub use super::correction_files::FILES;
use super::correction_files::{HISTORY, commit, write_contour, write_program};
use super::history::refuse_replacing;
use super::pocket;
use super::readings::{Readings, apart};
#[cfg(not(target_family = "wasm"))]
use super::store::keep::keep;
use crate::terminal::Terminal;
pub use identify::{Identified, Point, identify};
use truepath_report::next::after_correction;

/// What is corrected.
#[derive(Clone, Debug, Default, Args)]
#[command(group = ArgGroup::new("measured").required(true).multiple(true))]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE", group = "measured")]
    pub probe: Option<PathBuf>,
    /// Widths, diameters and distances measured on that part, beside the probe file or in its place.
    #[arg(long, value_name = "FILE.toml", group = "measured", conflicts_with = "first_pass")]
    pub dimensions: Option<PathBuf>,
    /// From tool and material data alone: the same as truepath pocket.
    #[arg(long, group = "measured", conflicts_with_all = ["probe", "dimensions", "route", "first_pass"])]
    pub no_probe: bool,
    /// Folder for the corrected program (or image), tables, summary, report and picture.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Correct in the program text or in the coprocessor; the job says it otherwise.
    #[arg(long, value_parser = one_of(&ROUTES))]
    pub route: Option<Route>,
    /// The probe file is of the first of two passes, with this job (written by truepath split).
    #[arg(long, value_name = "FIRST-PASS.toml")]
    pub first_pass: Option<PathBuf>,
    /// Half the width of the tolerance of the wall at every height, mm, or with its unit (0.0005in, 12um), in place
    /// of the limits of the job: says whether one pass holds it.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, conflicts_with = "no_probe")]
    pub tolerance: Option<String>,
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

/// Corrects and prints what is expected.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let Options { job, output, force, said, .. } = options;
    if options.no_probe {
        let options = pocket::Options { force: *force, which: said.which.clone(), ..Default::default() };
        return pocket::compensate(&options, job, output, terminal);
    }
    let summary = terminal.watch("correcting", |progress| run(options, progress))?;
    terminal.warn_all(&summary.warnings);
    #[cfg(not(target_family = "wasm"))]
    keep((job, options.begin.store.as_deref()), output, "correct", terminal);
    terminal.tell(&summary, || words(&summary, output) + &after_correction(&summary, job, Some(output)).to_string())
}

pub(super) fn words(s: &CorrectSummary, output: &FilePath) -> String {
    let (before, after) = (&s.surface.before, &s.surface.after);
    let (unit, name) = (s.unit, s.unit.name());
    let mut text = s.feature.as_ref().map(|feature| listing(feature, unit)).unwrap_or_default();
    if !s.contours.is_empty() {
        text += &several::table(&s.contours, unit);
    }
    text += &format!(
        "{} used, {} set aside; wall follows the {} force, {} milling\n\
         \n\
         {}\n\
         \n\
         largest wall error, by the model       {:>8}\n\
         on the next part, 1 sigma              {:>8.4} {name}\n\
         \x20 of it by what the points leave open  {:>8.4} {name}\n\
         \x20 where the largest error is expected  {:>8.4} {name}\n\
         left over the height, beyond X and Y   {:>8.4} {name}\n\
         floor {}\n\
         \n\
         at every height, with what the points leave open (± 2 sigma)\n\
         \x20 without correction: the worst          {:>8.4} ± {:.4} {name}, 95 % within {:.4} ± {:.4} {name}, mean over the height {:.4} {name}\n\
         \x20 with it: the worst                     {:>8.4} ± {:.4} {name}, 95 % within {:.4} ± {:.4} {name}, mean over the height {:.4} {name}\n\
         \x20 {}\n\
         \n\
         deepest cut at any height              {:>8.4} {name}\n\
         largest correction                     {:>8.4} {name}\n\
         \n\
         identified                      value      sigma   before\n",
        counted(s.points_used, "point"),
        s.points_rejected + s.points_outlying,
        s.wall_law,
        s.milling,
        s.floor.promise(unit, after),
        s.floor.fall(unit, s.max_error_before_mm, s.max_error_after_mm),
        unit.of(s.max_sigma_mm),
        unit.of(s.max_sigma_by_points_mm),
        unit.of(s.sigma_at_max_error_mm),
        unit.of(s.axial_form_error_mm),
        s.floor.words(unit),
        unit.of(before.profile.profile_mm),
        unit.of(2.0 * before.profile.sigma_mm),
        unit.of(before.p95_mm),
        unit.of(2.0 * before.p95_sigma_mm),
        unit.of(before.mean_mm),
        unit.of(after.profile.profile_mm),
        unit.of(2.0 * after.profile.sigma_mm),
        unit.of(after.p95_mm),
        unit.of(2.0 * after.p95_sigma_mm),
        unit.of(after.mean_mm),
        after.worst_words(unit),
        unit.of(s.worst_gouge_mm),
        unit.of(s.max_correction_mm),
    );
    for (parameter, p) in &s.identified {
        let seen = if p.observable { "" } else { "  not decided by the points" };
        // What is identified is told in the units of the job's keys, but for lengths.
        let [value, sigma, prior] =
            [p.value + 0.0, p.sigma, p.prior].map(|v| if p.unit == "mm" { unit.of(v) } else { Unit::default().of(v) });
        let own = if p.unit == "mm" { name } else { p.unit };
        text += &format!("  {parameter:<24} {value:>10.4} {sigma:>10.4} {prior:>8.4} {own:<5}{seen}\n");
    }
    text += &format!("\nwritten to {}; to look at: {}\n", output.display(), output.join(REPORT).display());
    if let Some(name) = &s.corrected_program {
        let load = output.join(name);
        text += &format!("to load at the machine: {} (corrected.nc holds the same)\n", load.display());
    }
    text
}

/// Corrects and writes the outputs.
///
/// # Errors
/// As [`correct_pass`], and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<CorrectSummary, Failure> {
    let mut job = options.said.read(&options.job)?;
    job.signer = options.sign.signer()?;
    job.override_part(&PartFlags { tolerance: options.tolerance.clone(), ..PartFlags::default() })?;
    // clap has seen to it that there is one of them.
    let readings = Readings::read(options.probe.as_deref(), options.dimensions.as_deref())?;
    let first = options.first_pass.as_deref().map(|first| Pass::read(options.said.read(first)?)).transpose()?;
    let pass = match first {
        Some(_) => Pass::read(job)?,
        None => match <[Pass; 1]>::try_from(options.begin.passes(Pass::every(job)?)) {
            Ok([only]) => only,
            Err(walls) => {
                let to = (options.output.as_path(), options.force, options.route);
                return several::run(walls, &readings, to, progress);
            }
        },
    };
    let (pass, first, measurement) = match first {
        None => {
            let (pass, measurement) = readings.of_one(pass)?;
            (pass, None, measurement)
        }
        Some(first) => {
            let (first, measurement) = readings.of_any_depth(first)?;
            let pass = if pass.plan.is_some() { pass.at_level(first.level())? } else { pass };
            (pass, Some(first), measurement)
        }
    };
    let folder = OutputFolder::create(&options.output, options.force, FILES)?;
    if first.is_none() {
        refuse_replacing(&options.output.join(HISTORY), readings.path(), &pass, &measurement)?;
    }
    let route = options.route.unwrap_or(pass.job.route);
    let mut remarks = measurement.remarks(&measurement.source);
    if first.is_none() && first_pass_of(pass.program.bytes()).is_some() {
        remarks.push(
            "this job is that of a first pass: the corrected program leaves the stock of the second pass, on the next part. For the second pass of this part correct the job that was split, with --first-pass"
                .into());
    }
    remarks.extend(misread(first.as_ref().unwrap_or(&pass), first.is_some(), &measurement.contacts));
    let (pass, mut done, points) = match &first {
        None => {
            let done = correct_pass(&pass, &measurement, &remarks, &[route], progress)?;
            (pass, done, Points::ThisPass)
        }
        Some(first) => {
            let (done, surface) =
                second_pass::correct_second_pass(&pass, first, &measurement, &remarks, &[route], progress)?;
            folder.write("first-pass-surface.csv", &surface.table())?;
            (pass.over(surface)?, done, Points::FirstPass)
        }
    };
    done.summary.warnings.extend(apart(&pass, &measurement, &done.identified)?);
    // A second pass has no next part.
    let history = if first.is_none() { Some(History::first(&pass, &measurement, &done)?) } else { None };
    write_program(&folder, &pass, &done)?;
    write_contour(&folder, "", &measurement, &done, history.as_ref())?;
    let page = pages::corrected(&pass, &measurement, &done, points)?;
    commit(folder, &readings, &done.summary, &render(&page)?)?;
    Ok(done.summary)
}
