//! `learn`: from the measurement of a part that was cut with a correction to the correction of the next part.

use truepath_core::correct::Law;
use truepath_core::job::LawName;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use crate::as_milled::WholeContour;
use crate::codes::{Q002, Q006};
use crate::correct::{CorrectedPass, correct_identified};
use crate::correction::{DesignRequest, Identification};
use crate::learning::{History, MOST_PARTS, Part, PartPoints, Update, Verdict, update};
use crate::remarks::{MeasuredPart, Remarks};
use crate::summary::CorrectSummary;

/// The correction of the next part.
#[derive(Clone, Debug)]
pub struct Learned {
    /// The correction, as `correct` gives it.
    pub corrected: CorrectedPass,
    /// The history with one part more.
    pub history: History,
    /// How the part came out, and what was made of it.
    pub verdict: Verdict,
}

/// Summary of `learn`: that of `correct`, and the verdict on the part.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LearnSummary {
    /// Of the correction for the next part.
    #[serde(flatten)]
    pub correct: CorrectSummary,
    /// Of the part that was measured.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// The part that was measured, along the whole contour, as the model of all parts has it.
    pub whole_contour_error_mm: WholeContour,
}

/// Learns from the part that was cut with the history's correction, in memory, for one or both routes.
///
/// # Errors
/// A history of another cut, a measurement it already holds or of a part without its correction, and what [`correct_pass`](crate::correct::correct_pass) refuses.
pub fn learn(
    pass: &Pass,
    history: &History,
    measurement: &Measurement,
    remarks: &[String],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Learned, Failure> {
    history.facts.agree(pass)?;
    refuse_other_laws(pass)?;
    refuse_feeds(pass)?;
    let mut part = Part::new(history.next_number(), measurement, Some(history.next.correction.clone()))?;
    history.refuse_known(&part)?;
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let of = |part: &Part| {
        PartPoints::of(part, &sampled).ok_or_else(|| {
            let found = format!("the correction of part {} does not lie along this contour", part.number);
            Q002.error(found, format!("one entry for each of {} samples", sampled.count()))
        })
    };
    let parts: Vec<PartPoints> = history.parts.iter().filter(|p| !p.set_aside).map(of).collect::<Result<_, _>>()?;
    let newest = of(&part)?;
    let Update { joint, residual, residual_sigma, kept, set_aside, verdict } =
        update(pass, &sampled, parts, newest, &history.next.promised(), &mut |share| progress(0.5 * share))?;
    part.set_aside = set_aside;
    let observations = joint.observations.last().cloned().unwrap_or_default();
    let identified = Identification { core: joint.core, observations };
    let request =
        DesignRequest { law: Law::Model, residual: &residual, residual_sigma: &residual_sigma, kept: kept.as_deref() };
    let mut texts = remarks.to_vec();
    texts.extend_from_slice(verdict.remarks());
    if let Some(oldest) = history.parts.first().filter(|_| history.parts.len() >= MOST_PARTS) {
        texts.push(format!("part {} is dropped from the history, which keeps {MOST_PARTS} parts", oldest.number));
    }
    let texts = Remarks::of(measurement, &texts, MeasuredPart::Corrected);
    let later = &mut |share| progress(0.5 + 0.5 * share);
    let corrected = correct_identified(pass, &sampled, identified, &request, texts, routes, later)?;
    let history = history.with(part, &corrected);
    Ok(Learned { corrected, history, verdict })
}

/// The papers' laws are made from one measurement and know nothing of a second.
fn refuse_other_laws(pass: &Pass) -> Result<(), InputError> {
    let name = match pass.job.numbers.correct.law {
        LawName::Model => return Ok(()),
        LawName::Mirror => "mirror",
        LawName::Paper => "paper",
    };
    let found = format!("correct.law is \"{name}\"");
    let error = InputError::new(Q006, found, "a law that can learn", "set law = \"model\", or leave it out");
    Err(error.at(pass.job.source(), pass.job.span("correct.law")))
}

/// The fit over parts takes every part as cut at the feeds of the program.
pub fn refuse_feeds(pass: &Pass) -> Result<(), InputError> {
    if pass.job.feed.is_none() {
        return Ok(());
    }
    let help = "learn without [feed], or correct the next part anew with truepath correct";
    let error = InputError::new(Q006, "[feed] is given", "parts that are all cut at the feeds of the program", help);
    Err(error.at(pass.job.source(), pass.job.span("feed")))
}
