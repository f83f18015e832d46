//! The whole way of a case: plan with the points of the first part, write the program, cut it, judge it at every height.

use std::time::Instant;

use truepath_correction::plan::choice::{Planner, Wanted};
use truepath_correction::plan::written::{Chosen, write};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{PlanTable, Route};
use truepath_job::measurement::Measurement;
use truepath_plant::{BendLaw, judged_trim_mm};
use truepath_trial::process;

use super::case::Case;
use super::outcome::PlanOutcome;
use crate::outcome::one_line;

/// Share of machines like this one whose part has to be within the tolerance.
const CONFIDENCE: f64 = 0.95;

/// A case with its planned program.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The case.
    pub case: Case,
    /// The program of the choice.
    pub program: Vec<u8>,
    /// What became of it.
    pub outcome: PlanOutcome,
}

/// Name of the case of a seed.
pub fn name(seed: u64) -> String {
    format!("plan/{seed}")
}

/// The outcome of a case, whatever happens in it, and what it was where it came to its end.
pub fn outcome(seed: u64) -> (PlanOutcome, Option<Planned>) {
    let failed = |why: &str| PlanOutcome { case: name(seed), failure: one_line(why), ..PlanOutcome::default() };
    match std::panic::catch_unwind(|| planned(seed)) {
        Ok(Ok(planned)) => (planned.outcome.clone(), Some(planned)),
        Ok(Err(failure)) => (failed(&failure.to_string()), None),
        Err(_) => (failed("panicked"), None),
    }
}

/// Carries a case through.
///
/// # Errors
/// What the plan or the plant refuse.
pub fn planned(seed: u64) -> Result<Planned, Failure> {
    let case = Case::draw(seed)?;
    let source = |name: &str, bytes: &[u8]| Source::new(format!("plan/{seed}/{name}"), bytes.to_vec());
    let measurement = Measurement::read(&case.pass, &source("probe.txt", case.probe.as_bytes()))?;
    let begun = Instant::now();
    let planner = Planner::new(&case.pass, &measurement, |_| ())?;
    let (limits, _) = planner.possible(PlanTable::default());
    let wanted = Wanted { tolerance_mm: case.tolerance_mm, confidence: CONFIDENCE, limits };
    let plan = planner.plan(&wanted, &|_| ())?;
    let plan_s = begun.elapsed().as_secs_f64();
    let number = plan.recommended.unwrap_or(plan.choices.len());
    let choice = plan.choices.get(number.wrapping_sub(1));
    let choice = choice.ok_or_else(|| Failure::Internal("a plan without choices".to_owned()))?;
    let chosen = [Chosen { planner: &planner, cuts: &choice.cuts, cutter: choice.cutter }];
    let program = write(&chosen, Route::Program, 0, &mut |_| ())?.program.text;
    let part = process::cut(&case.pass, &case.machine_of_next(), &source("planned.nc", &program))?;
    let judged = part.surface().score(judged_trim_mm(case.part.cut.radius_mm));
    let after = judged.ok_or_else(|| Failure::Internal("a planned part of which nothing is judged".to_owned()))?;

    let (cut, c) = (&case.part.cut, &case.machine.compliance_mm_per_n);
    let outcome = PlanOutcome {
        case: name(seed),
        failure: String::new(),
        kind: case.kind.to_owned(),
        bend_law: if case.machine.bend_law == BendLaw::Alike { "alike" } else { "maxwell" }.to_owned(),
        diameter_mm: some(2.0 * cut.radius_mm),
        teeth: Some(cut.teeth as u64),
        helix_deg: some(cut.helix_deg),
        contact_ratio: some(case.contact_ratio),
        allowance_mm: some(cut.allowance_mm),
        stiffness_n_per_mm: some((2.0 / (c[0][0] + c[1][1])).round()),
        noise_um: some(1e3 * case.machine.probe_noise_mm),
        length_mm: some(part.path().length_mm),
        before_mm: some(case.before.profile_mm),
        tolerance_mm: some(case.tolerance_mm),
        recommended: Some(plan.recommended.is_some()),
        process: choice.process.clone(),
        passes: Some(choice.passes as u64),
        time_ratio: some(choice.time_ratio),
        predicted_mm: some(choice.surface.profile.profile_mm),
        sigma_mm: some(choice.surface.profile.sigma_mm),
        p95_predicted_mm: some(choice.surface.p95_mm),
        p95_sigma_mm: some(choice.surface.p95_sigma_mm),
        cause_mean_mm: some(choice.surface.causes.mean_mm),
        cause_height_mm: some(choice.surface.causes.height_mm),
        cause_bending_mm: some(choice.surface.causes.bending_mm),
        cause_noise_mm: some(choice.surface.causes.noise_mm),
        cause_not_modelled_mm: some(choice.surface.causes.not_modelled_mm),
        after_mm: some(after.profile_mm),
        p95_mm: some(after.p95_mm),
        gouge_mm: some(after.gouge_mm),
        mean_mm: some(after.mean_over_height_mm),
        factor: some(case.before.profile_mm / after.profile_mm.max(1e-6)),
        plan_s: some(plan_s),
    };
    Ok(Planned { case, program, outcome })
}

/// A number for the table: seven decimals are enough.
fn some(value: f64) -> Option<f64> {
    value.is_finite().then(|| (value * 1e7).round() / 1e7)
}
