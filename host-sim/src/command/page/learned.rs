//! The page of `learn`: that of the next correction, with how the measured part came out.

use super::corrected::{Points, corrected, figures};
use crate::command::correct::Corrected;
use crate::diagnostics::Failure;
use crate::learning::Verdict;
use crate::measurement::Measurement;
use crate::pass::Pass;
use crate::report::page::{Fact, Figure, Kind, Page, subject};

/// The page of what was learned.
///
/// # Errors
/// As [`corrected`].
pub(in crate::command) fn learned(
    pass: &Pass,
    measurement: &Measurement,
    done: &Corrected,
    verdict: &Verdict,
) -> Result<Page, Failure> {
    let mut page = corrected(pass, measurement, done, Points::Corrected(verdict.part))?;
    page.kind = Kind::Learn;
    page.title = format!(
        "{}: part {} measured, correction of part {}",
        subject(pass),
        verdict.part,
        verdict.part.saturating_add(1)
    );
    page.results = came_out(verdict).into_iter().chain(figures(&done.summary)).collect();
    if let Some(job) = &mut page.job {
        job.facts.extend(verdict.used_again.map(|again| Fact::new("next part", again.words())));
    }
    Ok(page)
}

/// How the part came out, and whether that was foreseen.
fn came_out(v: &Verdict) -> Vec<Figure> {
    let (now, before, promise) = (&v.measured_error_mm, &v.previous_error_mm, &v.promise);
    let places = format!("at {} places, rms {:.4} mm", now.places, now.rms_mm);
    let earlier = format!("at the same places, rms {:.4} mm", before.rms_mm);
    let promised = format!("{} of {} places within 2σ", promise.within_two_sigma, promise.places);
    let figures = [
        Figure::mm(format!("part {} measured, largest error", now.part), now.max_mm).map(|f| f.noted(places)),
        Figure::mm(format!("part {}, largest error", before.part), before.max_mm).map(|f| f.noted(earlier)),
        Figure::mm(format!("promised for part {}", now.part), promise.max_mm).map(|f| f.noted(promised)),
    ];
    figures.into_iter().flatten().collect()
}
