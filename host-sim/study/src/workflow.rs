//! The whole way of a case: probe, correct, mill, judge; then probe that part, learn, mill, judge.

use std::time::Instant;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_correction::learn::{Learned, learn};
use truepath_correction::learning::History;
use truepath_correction::rows::CorrectionRow;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_plant::{Judged, Milled};
use truepath_trial::virtual_mill;

use super::case::Case;
use super::id::CaseId;
use super::limit;
use super::outcome::{Outcome, one_line};

/// A corrected part.
#[derive(Clone, Debug)]
pub struct FirstPart {
    /// The probe file the correction is made from.
    pub probe: String,
    /// What it says.
    pub measurement: Measurement,
    /// The correction.
    pub corrected: CorrectedPass,
    /// The part cut with it.
    pub milled: Milled,
    /// Its wall.
    pub after: Judged,
}

/// A part cut with what was learned.
#[derive(Clone, Debug)]
pub struct SecondPart {
    /// The probe file learned from.
    pub probe: String,
    /// What was learned.
    pub learned: Learned,
    /// The wall of the part cut with it.
    pub after: Judged,
}

/// The outcome of a case, whatever happens in it; with `first_only` nothing is learned from a second part.
pub fn outcome(id: &CaseId, first_only: bool) -> Outcome {
    let work = || -> Result<Outcome, Failure> {
        let case = Case::draw(id)?;
        let mut outcome = described(&case);
        limit::add(&case, !first_only, &mut outcome)?;
        match first(&case, &mut outcome) {
            Ok(_) if first_only => {}
            Ok(first_part) => {
                if let Err(failure) = second(&case, &first_part, &mut outcome) {
                    outcome.learn_failure = one_line(&failure.to_string());
                }
            }
            Err(failure) => outcome.failure = one_line(&failure.to_string()),
        }
        Ok(outcome)
    };
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok(outcome)) => outcome,
        Ok(Err(failure)) => Outcome::failed(id, failure.to_string()),
        Err(_) => Outcome::failed(id, "panicked"),
    }
}

/// What is known before anything is corrected.
pub fn described(case: &Case) -> Outcome {
    let (score, c) = (&case.before.score, &case.machine.compliance_mm_per_n);
    Outcome {
        case: case.id.to_string(),
        length_mm: some(case.first.path.length_mm),
        points: Some((case.places_mm.len() * case.levels.len()) as u64),
        stiffness_n_per_mm: some((2.0 / (c[0][0] + c[1][1])).round()),
        worst_height_before_mm: some(score.worst_height_mm),
        p95_before_mm: some(score.p95_mm),
        before_mm: some(score.max_error_mm),
        rms_before_mm: some(score.rms_error_mm),
        ..Outcome::default()
    }
}

/// The first correction and the part cut with it; what it did is added to `outcome`.
///
/// # Errors
/// What probing or the correction refuse.
pub fn first(case: &Case, outcome: &mut Outcome) -> Result<FirstPart, Failure> {
    let probe = case.probe(1, &case.first, &case.places_mm)?;
    let measurement = measured(case, "probe.txt", &probe)?;
    let begun = Instant::now();
    let corrected = correct_pass(&case.pass, &measurement, &[], &[Route::Program], &mut |_| ())?;
    outcome.correct_s = some(begun.elapsed().as_secs_f64());
    let summary = &corrected.summary;
    outcome.predicted_mm = some(summary.max_error_after_mm);
    outcome.sigma_mm = some(summary.max_sigma_mm);
    outcome.law = summary.wall_law.to_owned();
    let seen = summary.identified.iter().filter(|(_, p)| p.observable).map(|(name, _)| *name);
    outcome.identified = seen.collect::<Vec<_>>().join(" ");

    let milled = cut(case, 2, &corrected)?;
    let after = milled.judge();
    let score = &after.score;
    outcome.after_mm = some(score.max_error_mm);
    outcome.factor = some(case.before.score.max_error_mm / score.max_error_mm.max(1e-6));
    outcome.rms_after_mm = some(score.rms_error_mm);
    outcome.gouge_mm = some(score.gouge_mm);
    outcome.worst_height_mm = some(score.worst_height_mm);
    outcome.worst_height_factor = some(case.before.score.worst_height_mm / score.worst_height_mm.max(1e-6));
    let (expected, causes) = (&summary.surface.after, &summary.surface.after.causes);
    outcome.worst_height_predicted_mm = some(expected.profile.profile_mm);
    outcome.worst_height_sigma_mm = some(expected.profile.sigma_mm);
    outcome.p95_mm = some(score.p95_mm);
    outcome.p95_predicted_mm = some(expected.p95_mm);
    outcome.p95_sigma_mm = some(expected.p95_sigma_mm);
    outcome.cause_mean_mm = some(causes.mean_mm);
    outcome.cause_height_mm = some(causes.height_mm);
    outcome.cause_bending_mm = some(causes.bending_mm);
    outcome.cause_noise_mm = some(causes.noise_mm);
    outcome.cause_not_modelled_mm = some(causes.not_modelled_mm);
    outcome.axial_form_mm = some(score.axial_form_mm);
    outcome.coverage = coverage(&after, &corrected.rows);
    Ok(FirstPart { probe, measurement, corrected, milled, after })
}

/// One more part: the corrected one is touched, where [`Case::next_places`] says, and learned from.
///
/// # Errors
/// What probing or learning refuse.
pub fn second(case: &Case, first_part: &FirstPart, outcome: &mut Outcome) -> Result<SecondPart, Failure> {
    let history = History::first(&case.pass, &first_part.measurement, &first_part.corrected)?;
    let places = case.next_places(&history)?;
    let mut milled = first_part.milled.clone();
    milled.machine = case.machine_touched(2, places.len());
    let probe = case.probe(2, &milled, &places)?;
    let measurement = measured(case, "probe-2.txt", &probe)?;
    let begun = Instant::now();
    let learned = learn(&case.pass, &history, &measurement, &[], &[Route::Program], &mut |_| ())?;
    outcome.learn_s = some(begun.elapsed().as_secs_f64());
    outcome.learned_predicted_mm = some(learned.corrected.summary.max_error_after_mm);
    outcome.rolled_back = Some(learned.verdict.rolled_back);
    let after = cut(case, 3, &learned.corrected)?.judge();
    outcome.learned_mm = some(after.score.max_error_mm);
    outcome.learned_factor = some(case.before.score.max_error_mm / after.score.max_error_mm.max(1e-6));
    let (worst, expected) = (after.score.worst_height_mm, &learned.corrected.summary.surface.after);
    outcome.learned_worst_height_mm = some(worst);
    outcome.learned_worst_height_factor = some(case.before.score.worst_height_mm / worst.max(1e-6));
    outcome.learned_worst_height_predicted_mm = some(expected.profile.profile_mm);
    outcome.learned_worst_height_sigma_mm = some(expected.profile.sigma_mm);
    outcome.learned_p95_mm = some(after.score.p95_mm);
    outcome.learned_p95_predicted_mm = some(expected.p95_mm);
    outcome.learned_p95_sigma_mm = some(expected.p95_sigma_mm);
    outcome.learned_gouge_mm = some(after.score.gouge_mm);
    outcome.learned_coverage = coverage(&after, &learned.corrected.rows);
    Ok(SecondPart { probe, learned, after })
}

fn measured(case: &Case, name: &str, probe: &str) -> Result<Measurement, Failure> {
    Measurement::read(&case.pass, &Source::new(format!("{}/{name}", case.id), probe.as_bytes().to_vec()))
}

/// Mills part `number` with a corrected program.
fn cut(case: &Case, number: u64, corrected: &CorrectedPass) -> Result<Milled, Failure> {
    let text = corrected.program.as_deref().ok_or_else(|| Failure::Internal("no corrected program".to_owned()))?;
    let commanded = virtual_mill::commanded(&case.pass, text)?;
    virtual_mill::mill(&case.pass, &case.machine_of(number), Some(&commanded))
}

/// Share of the judged contour where the error lies within 2 sigma of a correction. Beside a sharp outside corner, where
/// no wall stands, the rows to either side speak.
fn coverage(judged: &Judged, rows: &[CorrectionRow]) -> Option<f64> {
    let known: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.s_mm, row.sigma_mm?))).collect();
    let sigma = |s: f64| {
        let after = known.partition_point(|(at, _)| *at < s);
        let (a, from) = known.get(after.saturating_sub(1))?;
        let (b, to) = known.get(after).or(known.last())?;
        let share = if b > a { ((s - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        Some(from + share * (to - from))
    };
    let within = judged.mean_mm.iter().filter(|(s, error)| sigma(*s).is_some_and(|sigma| error.abs() <= 2.0 * sigma));
    let within = within.count();
    if judged.mean_mm.is_empty() { None } else { some(within as f64 / judged.mean_mm.len() as f64) }
}

/// A number for the table: seven decimals are enough.
fn some(value: f64) -> Option<f64> {
    value.is_finite().then(|| (value * 1e7).round() / 1e7)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(s_mm: f64, sigma_mm: Option<f64>) -> CorrectionRow {
        CorrectionRow {
            s_mm,
            x_mm: 0.0,
            y_mm: 0.0,
            dx_mm: 0.0,
            dy_mm: 0.0,
            predicted_error_before_mm: sigma_mm,
            predicted_error_after_mm: sigma_mm,
            sigma_mm,
            wall_x_mm: 0.0,
            wall_y_mm: 0.0,
        }
    }

    #[test]
    fn a_place_without_a_wall_has_no_sigma_and_does_not_end_the_study() {
        let rows = [row(0.0, Some(0.01)), row(1.0, None), row(2.0, Some(0.03))];
        let judged = |error| Judged { mean_mm: vec![(1.0, error)], ..Judged::default() };
        // Half way between its neighbours: sigma 0.02.
        assert_eq!(coverage(&judged(0.039), &rows), Some(1.0));
        assert_eq!(coverage(&judged(0.041), &rows), Some(0.0));
        assert_eq!(coverage(&judged(0.0), &[]), Some(0.0));
    }
}
