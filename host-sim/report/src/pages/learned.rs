//! The page of `learn`: the measured part as it was milled, beside the next one and the one without any correction.

use truepath_correction::as_milled::AsMilled;
use truepath_correction::correct::CorrectedPass;
use truepath_correction::learn::LearnSummary;
use truepath_correction::learning::Verdict;
use truepath_correction::surface::expected::Surfaces;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Said;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::corrected::{Points, figures, of_correction};
use crate::page;
use crate::page::{Fact, Figure, Kind, Page, PredictedPasses, WallFigures, Words, known, predicted, subject};

/// The page of what was learned.
///
/// # Errors
/// As [`Pass::sample`].
pub fn learned(
    pass: &Pass,
    measurement: &Measurement,
    done: &CorrectedPass,
    milled: &AsMilled,
    summary: &LearnSummary,
) -> Result<Page, Failure> {
    let verdict = &summary.verdict;
    let [before, cut, next] = words(verdict, milled.had_correction());
    let passes = PredictedPasses {
        // A part that was cut without correction is the uncorrected one.
        before: milled.had_correction().then_some(before),
        milled: Some((cut, &milled.correction)),
        after: next,
        correction: &done.correction,
        residual: &done.beside.mean,
    };
    let points = Points::Corrected(verdict.part);
    let mut page = of_correction(pass, measurement, done, points, |machine| predicted(machine, &passes))?;
    page.kind = Kind::Learn;
    // Judged is the part that is not milled yet.
    page.verdict = page.verdict.map(|v| {
        let text = Said::of(|unit| format!("part {}, {}", next_part(verdict), v.text.in_unit(unit)));
        page::Verdict { text, ..v }
    });
    page.title =
        format!("{}: part {} measured, correction of part {}", subject(pass), verdict.part, next_part(verdict));
    if let Some(outlook) = &mut page.outlook {
        outlook.now = WallFigures::from(&summary.whole_surface);
    }
    let correct = &summary.correct;
    page.told = Some(Said::of(|unit| {
        format!("Part {}: {}", next_part(verdict), correct.floor.line(unit, &correct.surface.after))
    }));
    page.results = came_out(summary).into_iter().chain(figures(&done.summary, &names(verdict))).collect();
    if let Some(outcome) = &mut page.outcome {
        outcome.measured_mm = known(verdict.measured_error_mm.max_mm);
    }
    if let Some(job) = &mut page.job {
        job.facts.push(Fact::new("from part to part", from_part_to_part(summary)));
        job.facts.extend(what_made_it(summary));
        job.facts.extend(verdict.used_again.map(|again| Fact::new("next part", again.words())));
    }
    Ok(page)
}

/// From the part that was measured, as the model of all parts has its whole wall, to the next one.
fn from_part_to_part(summary: &LearnSummary) -> Said {
    let surfaces = Surfaces { before: summary.whole_surface, after: summary.correct.surface.after };
    let part = summary.verdict.part;
    let next = next_part(&summary.verdict);
    Said::of(|unit| format!("part {part} to part {next}, expected: {} (2 sigma)", surfaces.words(unit)))
}

/// What made the worst of the part that was measured: at its touches, and of its whole wall as the model of all parts has it.
fn what_made_it(summary: &LearnSummary) -> [Fact; 2] {
    let part = summary.verdict.part;
    let fact = |of: &str, words: Said| Fact::new(format!("worst of part {part}, {of}"), words);
    [
        fact("touched", Said::of(|unit| summary.measured_surface.worst_words(unit))),
        fact("by the model", Said::of(|unit| summary.whole_surface.worst_words(unit))),
    ]
}

const fn next_part(verdict: &Verdict) -> u32 {
    verdict.part.saturating_add(1)
}

/// What the largest errors of the part without correction and of the next one are called.
fn names(verdict: &Verdict) -> [String; 2] {
    ["uncorrected, largest error".to_owned(), format!("part {}, largest error", next_part(verdict))]
}

/// The three passes: without correction, the part that was measured, the next one.
fn words(verdict: &Verdict, corrected: bool) -> [Words; 3] {
    let words = |name: String, label: String| Words { name: Some(name), label };
    let with = if corrected { "with its correction" } else { "without correction" };
    let by = if verdict.used_again.is_some() {
        "by the model of the parts before; this one is set aside"
    } else {
        "by the model of all parts"
    };
    let next = match verdict.used_again {
        None => "with the new correction".to_owned(),
        Some(again) if again.corrected => format!("with the correction of part {} again", again.part),
        Some(_) => "without correction".to_owned(),
    };
    [
        words("uncorrected".to_owned(), "along the path of the program, predicted".to_owned()),
        words(format!("part {}", verdict.part), format!("as milled {with}, {by}")),
        words(format!("part {}", next_part(verdict)), format!("the next one, {next}, predicted")),
    ]
}

/// How the part came out, and whether that was foreseen.
fn came_out(summary: &LearnSummary) -> Vec<Figure> {
    let (v, whole) = (&summary.verdict, &summary.whole_contour_error_mm);
    let (now, before, promise) = (&v.measured_error_mm, &v.previous_error_mm, &v.promise);
    let places = Said::of(|unit| format!("at {} places, rms {:.3} {}", now.places, unit.of(now.rms_mm), unit.name()));
    let along = Said::of(|unit| {
        let (s, sigma, name) = (unit.of(whole.s_mm), unit.of(whole.sigma_mm), unit.name());
        format!("by the model, at s = {s:.1} {name}, σ {sigma:.3} {name}")
    });
    let earlier = Said::of(|unit| format!("at the same places, rms {:.3} {}", unit.of(before.rms_mm), unit.name()));
    let sigma_mm = summary.measured_surface.sigma_mm;
    let worst = Said::of(|unit| format!("at a touched height, ± {:.3} (2 sigma)", unit.of(2.0 * sigma_mm)));
    let promised = format!("{} of {} places within 2σ", promise.within_two_sigma, promise.places);
    let figures = [
        Figure::mm(format!("part {} measured, largest error", now.part), now.max_mm).map(|f| f.noted(places)),
        Figure::mm(format!("part {} measured, worst height", now.part), summary.measured_surface.profile_mm)
            .map(|f| f.noted(worst)),
        Figure::mm(format!("part {}, whole contour", now.part), whole.max_mm).map(|f| f.noted(along)),
        Figure::mm(format!("part {}, largest error", before.part), before.max_mm).map(|f| f.noted(earlier)),
        Figure::mm(format!("promised for part {}", now.part), promise.max_mm).map(|f| f.noted(promised)),
    ];
    figures.into_iter().flatten().collect()
}
