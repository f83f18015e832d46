//! `learn` from a part that was cut with planned passes: the planned program of the next part.

use std::path::Path as FilePath;

use truepath_correction::codes::{Q002, Q003, Q007};
use truepath_correction::plan::choice::Plan;
use truepath_correction::plan::learn::{Passes, PlannedVerdict, learn};
use truepath_correction::surface::touched::TouchedSurface;
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::{PlannedWall, planned_page};

use super::super::history::plan_history_in;
use super::super::plan::{Written, planned_name, program_name, write_files};
use super::super::plan_files::{FILES, PLAN_HISTORY, PROBED, PROGRAM, REPORT};
use crate::terminal::Terminal;

/// What was learned, and the program of the next part.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LearnedPlanSummary {
    /// Version of this file.
    version: u32,
    /// The part that was touched.
    #[serde(flatten)]
    verdict: PlannedVerdict,
    /// Its wall at the touched heights.
    measured_surface: TouchedSurface,
    /// The next part: the process of the part before, designed anew, is the one choice, unless passes were searched for.
    #[serde(flatten)]
    plan: Plan,
    /// Its program.
    written: Written,
    /// What the user should know.
    warnings: Vec<String>,
}

/// What the next part is asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    /// Whether passes are searched for anew.
    pub(super) replan: bool,
    /// Half the width of the tolerance at every height, mm, in place of that of the plan.
    pub(super) tolerance_mm: Option<f64>,
    /// Where its passes are displaced, if that was said.
    pub(super) route: Option<Route>,
}

/// Learns from the points in a file of the part that the planned program in a folder has cut, and prints what was learned.
pub(super) fn main(
    job: JobFile,
    measured: (&FilePath, &FilePath),
    to: (&FilePath, bool),
    wish: Wish,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let summary = terminal.watch("learning", |progress| run(job, measured, to, wish, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary))
}

fn words(summary: &LearnedPlanSummary) -> String {
    let um = |mm: f64| mm * 1e3;
    let (verdict, plan, measured) = (&summary.verdict, &summary.plan, &summary.measured_surface);
    let mut text = format!(
        "part {} at {} points: largest error {:.1} um, rms {:.1} um; {:.1} ± {:.1} um were predicted for the worst place of the wall\n\
         {} (2 sigma), 95 % of the points within {:.4} mm\n  {}\n\
         the model of the parts before misses these points by {:.1} um (rms), that of all parts by {:.1} um\n",
        verdict.part,
        verdict.points,
        um(verdict.measured_max_mm),
        um(verdict.measured_rms_mm),
        um(verdict.promised_mm),
        um(2.0 * verdict.promised_sigma_mm),
        measured.words(),
        measured.p95_mm,
        measured.worst_words(),
        um(verdict.missed_before_mm),
        um(verdict.missed_after_mm),
    );
    if let Some([stretch, load]) = verdict.beside_mm {
        text += &format!(
            "beside the machine, over arc length and height: {:.0} um where the wall differs by place, {:.0} um where the load is alike (one sigma)\n",
            um(stretch),
            um(load)
        );
    }
    if let Some(choice) = summary.written.choice.as_ref().and_then(|one| plan.choices.get(one.choice - 1)) {
        text += &format!(
            "\npart {}: {}\n  profile error {:.1} ± {:.1} um at every height, 95 % of the wall within {:.1} um, mean over the height {:.1} um, {:.0} % within {:.1} um\n  {}\n",
            verdict.part + 1,
            choice.process,
            um(choice.surface.profile.profile_mm),
            um(2.0 * choice.surface.profile.sigma_mm),
            um(choice.surface.p95_mm),
            um(choice.surface.mean_mm),
            choice.within_tolerance * 100.0,
            um(plan.tolerance_mm),
            choice.surface.worst_words(),
        );
    }
    if plan.recommended.is_none() {
        text +=
            "  these passes do not hold the tolerance with the confidence asked for: truepath plan looks for others\n";
    }
    text + &format!(
        "\nwritten: {}, {} passes\n{}next: mill part {} with it; touch it, and learn from there\n",
        summary.written.program.display(),
        summary.written.passes(),
        summary.written.of_images(),
        verdict.part + 1
    )
}

/// Refuses a route that is not the one of the plan.
fn refuse_other_route(said: Option<Route>, of_plan: Route) -> Result<(), InputError> {
    let name = |route: Route| if route == Route::Program { "program" } else { "coprocessor" };
    match said.filter(|said| *said != of_plan) {
        None => Ok(()),
        Some(said) => {
            let found =
                format!("--route {}, and the planned passes of --from are for the {}", name(said), name(of_plan));
            let help = format!("leave --route out, or plan anew with truepath plan --write --route {}", name(said));
            Err(InputError::new(C001, found, format!("the route of the plan, {}", name(of_plan)), help))
        }
    }
}

/// Learns and writes the outputs.
fn run(
    job: JobFile,
    (probe, from): (&FilePath, &FilePath),
    (output, force): (&FilePath, bool),
    wish: Wish,
    progress: &mut dyn FnMut(f64),
) -> Result<LearnedPlanSummary, Failure> {
    let mut history = plan_history_in(from)?;
    refuse_other_route(wish.route, history.next.route())?;
    history.next.tolerance_mm = wish.tolerance_mm.unwrap_or(history.next.tolerance_mm);
    let pass = Pass::read(job)?;
    let level = history.facts.level().filter(|_| pass.job.which.pass.is_none() && pass.plan.is_some());
    let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass).cut_with(history.cut_with());
    let file = Source::read(probe)?;
    let measurement = Measurement::read(&pass, &file)?;
    let folder = OutputFolder::create(output, force, FILES)?;
    let name = planned_name(std::slice::from_ref(&pass));
    let passes = if wish.replan { Passes::Searched(pass.job.plan) } else { Passes::Same };
    let learned = learn(&pass, &history, (&measurement, passes), &[PROGRAM, &name], progress);
    let learned = learned.map_err(|failure| match failure {
        Failure::Input(error) if [Q003.code, Q007.code].contains(&error.code()) => error.in_file(probe).into(),
        Failure::Input(error) if error.code() == Q002.code && error.line_column().is_none() => {
            error.in_file(&from.join(PLAN_HISTORY)).into()
        }
        failure => failure,
    })?;
    let mut warnings = pass.warnings.clone();
    warnings.extend(measurement.remarks(&file));
    if learned.verdict.set_aside {
        warnings.push(format!(
            "part {} is set aside: nothing explains {} of its {} points beside the parts before; the next part is cut by what was known before it",
            learned.verdict.part, learned.verdict.outlying, learned.verdict.points
        ));
    }
    let (walls, numbers) = (std::slice::from_ref(&pass), [learned.chosen]);
    let written = write_files((&folder, output), walls, false, &numbers, learned.written, &mut warnings)?;
    folder.write(PLAN_HISTORY, &learned.history.text()?)?;
    folder.write(PROBED, file.bytes())?;
    folder.write(
        REPORT,
        planned_page(&[PlannedWall { name: None, plan: &learned.plan }], &program_name(&pass)).as_bytes(),
    )?;
    let summary = LearnedPlanSummary {
        version: 1,
        verdict: learned.verdict,
        measured_surface: TouchedSurface::of_measurement(&pass, &measurement),
        plan: learned.plan,
        written: Written { learns: true, ..written },
        warnings,
    };
    folder.write("summary.json", &json(&summary)?)?;
    folder.commit()?;
    Ok(summary)
}
