//! `learn` from a part that was cut with planned passes: the planned program of the next part.

use std::path::Path as FilePath;

use truepath_correction::codes::{Q002, Q003, Q007, Q010};
use truepath_correction::plan::choice::Plan;
use truepath_correction::plan::learn::{Passes, PlannedCut, PlannedVerdict, learn};
use truepath_correction::remarks::said_of_every;
use truepath_correction::surface::touched::TouchedSurface;
use truepath_ground::codes::C001;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::{OutputFolder, json};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_report::{PlannedWall, planned_page};

use super::super::begin::BeginFlags;
use super::super::correction_files::{contour_name, contour_place};
use super::super::history::{PlannedContours, planned_in};
use super::super::plan::{Written, planned_name, program_name, write_files};
use super::super::plan_files::{FILES, PLAN_HISTORY, PROBED, PROGRAM, REPORT};
use crate::terminal::Terminal;

/// What was learned, and the program of the next part.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LearnedPlanSummary {
    /// Version of this file.
    version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    unit: Unit,
    /// What was learned, where one contour was planned.
    #[serde(flatten)]
    learned: Option<LearnedContour>,
    /// What was learned of each of several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    contours: Vec<LearnedContour>,
    /// The program of the next part.
    written: Written,
    /// What the user should know.
    warnings: Vec<Remark>,
}

/// What was learned of a contour.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LearnedContour {
    /// Its name, of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    contour: Option<String>,
    /// The part that was touched.
    #[serde(flatten)]
    verdict: PlannedVerdict,
    /// Its wall at the touched heights.
    measured_surface: TouchedSurface,
    /// The next part: the process of the part before, designed anew, is the one choice, unless passes were searched for.
    #[serde(flatten)]
    plan: Plan,
    /// The number of the choice that is written.
    #[serde(skip)]
    chosen: usize,
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

/// Prints what was learned.
pub(super) fn tell(summary: &LearnedPlanSummary, terminal: &Terminal) -> Result<(), Failure> {
    terminal.warn_all(&summary.warnings);
    terminal.tell(summary, || words(summary))
}

fn words(summary: &LearnedPlanSummary) -> String {
    let mut text: String = summary.learned.iter().map(|one| of_contour(one, summary.unit)).collect();
    for one in &summary.contours {
        text += &format!("{}\n{}\n", one.contour.as_deref().unwrap_or_default(), of_contour(one, summary.unit));
    }
    let next =
        summary.learned.iter().chain(&summary.contours).map(|one| one.verdict.part + 1).next().unwrap_or_default();
    text + &format!(
        "\nwritten: {}, {}\n{}next: mill part {next} with it; touch it, and learn from there\n",
        summary.written.program.display(),
        counted(summary.written.passes(), "pass"),
        summary.written.of_images(),
    )
}

fn of_contour(one: &LearnedContour, unit: Unit) -> String {
    let (small, um, mm) = (|mm: f64| unit.small(mm), unit.small_name(), unit.name());
    let (verdict, plan, measured) = (&one.verdict, &one.plan, &one.measured_surface);
    let mut text = format!(
        "part {} at {}: largest error {:.1} {um}, rms {:.1} {um}; {:.1} ± {:.1} {um} were predicted for the worst place of the wall\n\
         {} (2 sigma), 95 % of the points within {:.4} {mm}\n  {}\n\
         the model of the parts before misses these points by {:.1} {um} (rms), that of all parts by {:.1} {um}\n",
        verdict.part,
        counted(verdict.points, "point"),
        small(verdict.measured_max_mm),
        small(verdict.measured_rms_mm),
        small(verdict.promised_mm),
        small(2.0 * verdict.promised_sigma_mm),
        measured.words(unit),
        unit.of(measured.p95_mm),
        measured.worst_words(unit),
        small(verdict.missed_before_mm),
        small(verdict.missed_after_mm),
    );
    if let Some([stretch, load]) = verdict.beside_mm {
        text += &format!(
            "beside the machine, over arc length and height: {:.0} {um} where the wall differs by place, {:.0} {um} where the load is alike (one sigma)\n",
            small(stretch),
            small(load)
        );
    }
    if let Some(choice) = plan.choices.get(one.chosen - 1) {
        text += &format!(
            "\npart {}: {}\n  profile error {:.1} ± {:.1} {um} at every height, 95 % of the wall within {:.1} {um}, mean over the height {:.1} {um}, {:.0} % within {:.1} {um}\n  {}\n",
            verdict.part + 1,
            choice.process_in(unit),
            small(choice.surface.profile.profile_mm),
            small(2.0 * choice.surface.profile.sigma_mm),
            small(choice.surface.p95_mm),
            small(choice.surface.mean_mm),
            choice.within_tolerance * 100.0,
            small(plan.tolerance_mm),
            choice.surface.worst_words(unit),
        );
    }
    if plan.recommended.is_none() {
        text +=
            "  these passes do not hold the tolerance with the confidence asked for: truepath plan looks for others\n";
    }
    text
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

/// Learns from the points in a file of the part that the planned program in a folder has cut, and writes the outputs.
pub(super) fn run(
    (job, begin): (JobFile, &BeginFlags),
    (probe, from): (&FilePath, &FilePath),
    (output, force): (&FilePath, bool),
    wish: Wish,
    progress: &mut dyn FnMut(f64),
) -> Result<LearnedPlanSummary, Failure> {
    let PlannedContours { cuts, several, left } = planned_in(from, job)?;
    let file = Source::read(probe)?;
    let (walls, mut histories): (Vec<Pass>, Vec<_>) = cuts.into_iter().unzip();
    let walls = begin.passes(walls);
    for history in &mut histories {
        refuse_other_route(wish.route, history.next.route())?;
        history.next.tolerance_mm = wish.tolerance_mm.unwrap_or(history.next.tolerance_mm);
    }
    let measured = match <[Pass; 1]>::try_from(walls) {
        Ok([only]) => {
            let measurement = Measurement::read(&only, &file)?;
            vec![(only, measurement)]
        }
        Err(walls) => Measurement::of_every(walls, &file)?,
    };
    if let Some((pass, _)) = measured.iter().find(|(_, measurement)| measurement.contacts.is_empty()) {
        let found = format!("no point is on the wall of {}, which was cut with planned passes", contour_name(pass));
        return Err(Q010.error(found, "points on every planned contour").in_file(probe).into());
    }
    let folder = OutputFolder::create(output, force, FILES)?;
    let passes: Vec<Pass> = measured.iter().map(|(pass, _)| pass.clone()).collect();
    let name = planned_name(&passes);
    let next = match passes.first().filter(|_| wish.replan) {
        Some(pass) => Passes::Searched(pass.job.plan),
        None => Passes::Same,
    };
    let parts: Vec<PlannedCut> = measured
        .iter()
        .zip(&histories)
        .map(|((pass, measurement), history)| PlannedCut { pass, history, measurement })
        .collect();
    let learned = learn(&parts, next, &[PROGRAM, &name], progress).map_err(|failure| match failure {
        Failure::Input(error) if [Q003.code, Q007.code].contains(&error.code()) => error.in_file(probe).into(),
        Failure::Input(error) if error.code() == Q002.code && error.line_column().is_none() => {
            error.in_file(&if several { from.to_owned() } else { from.join(PLAN_HISTORY) }).into()
        }
        failure => failure,
    })?;
    let mut warnings: Vec<Remark> = left
        .iter()
        .map(|name| format!("{name} stays as it is: {} has no history of it", from.display()).into())
        .collect();
    let said: Vec<Vec<Remark>> = measured
        .iter()
        .map(|(pass, measurement)| [pass.warnings.clone(), measurement.remarks(&file)].concat())
        .collect();
    let names: Vec<String> = passes.iter().map(contour_name).collect();
    warnings.extend(match &said[..] {
        [only] => only.clone(),
        said => said_of_every(names.iter().map(String::as_str).zip(said.iter().map(Vec::as_slice))),
    });
    if let Some(verdict) = learned.contours.first().map(|one| one.verdict).filter(|verdict| verdict.set_aside) {
        let points =
            |of: &dyn Fn(&PlannedVerdict) -> usize| learned.contours.iter().map(|one| of(&one.verdict)).sum::<usize>();
        warnings.push(format!(
            "part {} is set aside: nothing explains {} of its {} points beside the parts before; the next part is cut by what was known before it",
            verdict.part,
            points(&|one| one.outlying),
            points(&|one| one.points)
        ).into());
    }
    let numbers: Vec<usize> = learned.contours.iter().map(|one| one.chosen).collect();
    let written = write_files((&folder, output), &passes, several, &numbers, learned.written, &mut warnings)?;
    let mut contours = Vec::new();
    for ((pass, measurement), one) in measured.iter().zip(learned.contours) {
        let place = contour_place(pass, several);
        folder.write(&format!("{place}{PLAN_HISTORY}"), &one.history.text()?)?;
        contours.push(LearnedContour {
            contour: several.then(|| contour_name(pass)),
            verdict: one.verdict,
            measured_surface: TouchedSurface::of_measurement(pass, measurement),
            plan: one.plan,
            chosen: one.chosen,
        });
    }
    folder.write(PROBED, file.bytes())?;
    let shown: Vec<PlannedWall> =
        contours.iter().map(|one| PlannedWall { name: one.contour.clone(), plan: &one.plan }).collect();
    let unit = passes.first().map(Pass::unit).unwrap_or_default();
    folder
        .write(REPORT, planned_page(&shown, &passes.first().map(program_name).unwrap_or_default(), unit).as_bytes())?;
    let learned = if several { None } else { contours.pop() };
    let written = Written { learns: true, ..written };
    let summary = LearnedPlanSummary { version: 1, unit, learned, contours, written, warnings };
    folder.write("summary.json", &json(&summary)?)?;
    folder.commit()?;
    Ok(summary)
}
