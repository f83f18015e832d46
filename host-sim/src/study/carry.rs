//! Carries a case through: probe, correct, mill, judge.

use std::time::Instant;

use super::case::Case;
use super::id::CaseId;
use super::outcome::{Outcome, one_line};
use crate::command::correct::{Corrected, correct};
use crate::diagnostics::{Failure, Source};
use crate::job::Route;
use crate::measurement::Measurement;
use crate::plant::Judged;
use crate::workshop;

/// A corrected case, for those who want its files.
#[derive(Clone, Debug)]
pub struct Carried {
    /// The probe file of the first part.
    pub probe: String,
    /// The correction.
    pub corrected: Corrected,
    /// The corrected part.
    pub after: Judged,
}

/// The outcome of a case, whatever happens in it.
pub fn outcome(id: &CaseId) -> Outcome {
    let work = || -> Result<Outcome, Failure> {
        let case = Case::draw(id)?;
        let mut outcome = described(&case);
        match first(&case, &mut outcome) {
            Ok(_) => {}
            Err(failure) => outcome.failure = sentence(&failure),
        }
        Ok(outcome)
    };
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok(outcome)) => outcome,
        Ok(Err(failure)) => Outcome::failed(id, sentence(&failure)),
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
        before_mm: some(score.max_error_mm),
        rms_before_mm: some(score.rms_error_mm),
        ..Outcome::default()
    }
}

/// The first correction; what it did is added to `outcome`.
///
/// # Errors
/// What probing or the correction refuse.
pub fn first(case: &Case, outcome: &mut Outcome) -> Result<Carried, Failure> {
    let probe = case.probe(&case.first, &case.places_mm)?;
    let file = Source::new(format!("{}/probe.txt", case.id), probe.clone().into_bytes());
    let measurement = Measurement::read(&case.pass, &file)?;
    let begun = Instant::now();
    let corrected = correct(&case.pass, &measurement, &[], &[Route::Program], &mut |_| ())?;
    outcome.correct_s = some(begun.elapsed().as_secs_f64());
    let summary = &corrected.summary;
    outcome.predicted_mm = some(summary.max_error_after_mm);
    outcome.sigma_mm = some(summary.max_sigma_mm);
    outcome.law = summary.wall_law.to_owned();
    let seen = summary.identified.iter().filter(|(_, p)| p.observable).map(|(name, _)| *name);
    outcome.identified = seen.collect::<Vec<_>>().join(" ");

    let text = corrected.program.as_deref().ok_or_else(|| Failure::Internal("no corrected program".to_owned()))?;
    let commanded = workshop::commanded(&case.pass, text)?;
    let after = workshop::mill(&case.pass, &case.machine_of(2), Some(&commanded))?.judge();
    let score = &after.score;
    outcome.after_mm = some(score.max_error_mm);
    outcome.factor = some(case.before.score.max_error_mm / score.max_error_mm.max(1e-6));
    outcome.rms_after_mm = some(score.rms_error_mm);
    outcome.gouge_mm = some(score.gouge_mm);
    outcome.worst_height_mm = some(score.worst_height_mm);
    outcome.axial_form_mm = some(score.axial_form_mm);
    outcome.coverage = coverage(&after, &corrected.table)?;
    Ok(Carried { probe, corrected, after })
}

/// Share of the judged contour where the error lies within 2 sigma of the table of a correction.
fn coverage(judged: &Judged, table: &[u8]) -> Result<Option<f64>, Failure> {
    #[derive(serde::Deserialize)]
    struct Row {
        s_mm: f64,
        sigma_mm: f64,
    }
    let rows: Vec<Row> = csv::Reader::from_reader(table)
        .deserialize()
        .collect::<Result<_, _>>()
        .map_err(|e| Failure::Internal(format!("correction.csv cannot be read back: {e}")))?;
    let sigma = |s: f64| {
        let k = rows.partition_point(|row| row.s_mm < s);
        let (a, b) = (rows.get(k.saturating_sub(1))?, rows.get(k.min(rows.len() - 1))?);
        let share = if b.s_mm > a.s_mm { ((s - a.s_mm) / (b.s_mm - a.s_mm)).clamp(0.0, 1.0) } else { 0.0 };
        Some(a.sigma_mm + share * (b.sigma_mm - a.sigma_mm))
    };
    let within = judged.mean_mm.iter().filter(|(s, error)| sigma(*s).is_some_and(|sigma| error.abs() <= 2.0 * sigma));
    let within = within.count();
    Ok(if judged.mean_mm.is_empty() { None } else { some(within as f64 / judged.mean_mm.len() as f64) })
}

/// A number for the table: seven figures are enough.
fn some(value: f64) -> Option<f64> {
    value.is_finite().then(|| (value * 1e7).round() / 1e7)
}

fn sentence(failure: &Failure) -> String {
    one_line(&failure.to_string())
}
