//! The page of `correct`: the wall without and with the correction, as the identified model foretells both.

use truepath_core::correct::{Band, Target};
use truepath_core::cut::Loop;
use truepath_correction::correct::CorrectedPass;
use truepath_correction::summary::CorrectSummary;
use truepath_correction::surface::expected::Surfaces;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Remark, Said, Unit};
use truepath_ground::units::float;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::expected::judge;
use super::{file, of_pass, page_warnings};
use crate::next::after_correction;
use crate::page::{
    Along, Fact, Figure, Kind, Outlook, Page, Parameter, PredictedPasses, Program, WallFigures, Words, known, points,
    predicted,
};

/// Which part the probe points are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// The part as its program says, without correction.
    ThisPass,
    /// The pass before the one that is corrected.
    FirstPass,
    /// A part that was cut with a correction, by its number.
    Corrected(u32),
}

/// The page of a correction.
///
/// # Errors
/// As [`Pass::sample`].
pub fn corrected(pass: &Pass, measurement: &Measurement, done: &CorrectedPass, of: Points) -> Result<Page, Failure> {
    let words = |label: &str| Words { name: None, label: format!("{label}, predicted by the identified model") };
    let passes = PredictedPasses {
        before: Some(words("without correction")),
        milled: None,
        after: words("with the correction"),
        correction: &done.correction,
        residual: &done.beside.mean,
    };
    of_correction(pass, measurement, done, of, |machine| predicted(machine, &passes))
}

/// A page of a correction, with the passes that `along` makes of the identified machine.
///
/// # Errors
/// As [`Pass::sample`].
pub(super) fn of_correction(
    pass: &Pass,
    measurement: &Measurement,
    done: &CorrectedPass,
    of: Points,
    along: impl FnOnce(&Loop) -> Along,
) -> Result<Page, Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample_fed(&mut buffer, done.schedule.as_ref())?.with_law(done.identified.law());
    let table = done.identified.table();
    let machine = done.identified.machine(&path, &table);
    let along = along(&machine);
    let (points, left_out) = points(pass, measurement, &done.identified.observations);
    let mut page = of_pass(Kind::Correct, "Correction of".to_owned(), pass);
    page.program =
        Some(Program::of(pass, Some(done.summary.feature.as_ref().map_or(&[], |f| &f.passes_corrected[..]))));
    page.contour = Some(along.contour);
    page.heights = along.heights;
    page.points = points;
    page.parameters = parameters(&done.summary);
    if let Some(outcome) = &mut page.outcome {
        outcome.before_mm = known(done.summary.max_error_before_mm);
        outcome.after_mm = known(done.summary.max_error_after_mm);
        outcome.profile_mm = known(done.summary.profile_error_after_mm);
        outcome.sigma_mm = known(done.summary.sigma_at_max_error_mm);
        outcome.gouge_mm = known(done.summary.worst_gouge_mm);
    }
    page.outlook = Some(Outlook {
        now: WallFigures::from(&done.summary.surface.before),
        next: Some(WallFigures::from(&done.summary.surface.after)),
        floor_mm: known(done.summary.floor.mm()),
        cut: false,
    });
    page.next = Some(after_correction(&done.summary, file(pass.job.source().name()), None));
    page.told = Some(Said::of(|unit| done.summary.floor.line(unit, &done.summary.surface.after)));
    page.results = figures(&done.summary, &["largest error without correction", "largest error with it"]);
    page.warnings = page_warnings(
        pass,
        Some(&measurement.file),
        done.summary.warnings.iter().cloned().chain(along.note.into_iter().chain(left_out).map(Remark::from)),
    );
    if let Some(job) = &mut page.job {
        job.facts.extend(facts(pass, done, of));
    }
    judge(&mut page, pass.job.part.tolerance, &done.correction);
    Ok(page)
}

/// Identification quantities, by name.
fn parameters(summary: &CorrectSummary) -> Vec<Parameter> {
    let each = summary.identified.iter();
    each.map(|(name, of)| Parameter { name: (*name).to_owned(), of: of.clone() }).collect()
}

/// The head figures, all of them predictions; `largest` names the errors without and with the correction.
pub(super) fn figures(s: &CorrectSummary, largest: &[impl AsRef<str>; 2]) -> Vec<Figure> {
    let [without, with] = largest.each_ref().map(AsRef::as_ref);
    let used =
        format!("{} points used, {} outlying, {} set aside", s.points_used, s.points_outlying, s.points_rejected);
    let at = Said::of(|unit| format!("predicted, at s = {:.1} {}", unit.of(s.max_error_after_s_mm), unit.name()));
    let sigma = Said::of(|unit| format!("largest {:.3}", unit.of(s.max_sigma_mm)));
    let figures = [
        Figure::mm(without, s.max_error_before_mm).map(|f| f.noted("predicted")),
        Figure::mm(with, s.max_error_after_mm).map(|f| f.noted(at)),
        Figure::mm("standard deviation there", s.sigma_at_max_error_mm).map(|f| f.noted(sigma)),
        Figure::mm("left over the height", s.axial_form_error_mm).map(|f| f.noted("no X Y shift cures it")),
        Figure::mm("deepest cut at any height", s.worst_gouge_mm).map(|f| f.noted("predicted")),
        Figure::mm("largest correction", s.max_correction_mm).map(|f| f.noted("along an axis")),
        Figure::mm("residual of the fit", s.fit_residual_mm).map(|f| f.noted(used)),
    ];
    figures.into_iter().flatten().collect()
}

fn facts(pass: &Pass, done: &CorrectedPass, of: Points) -> Vec<Fact> {
    let (s, wanted) = (&done.summary, &done.correction.wanted);
    let mut facts = vec![
        Fact::new("law", format!("{}; the wall follows the {} force", s.law, s.wall_law)),
        Fact::new("error shown", shown(wanted.target, wanted.band, float(pass.core.setup.axial_depth))),
    ];
    facts.push(Fact::new("expected", Said::of(|unit| format!("{} (2 sigma)", s.surface.words(unit)))));
    facts.extend(at_every_height(&s.surface));
    facts.push(Fact::new(
        "floor",
        Said::of(|unit| format!("{}; {}", s.floor.words(unit), s.floor.next(unit, &s.surface.after))),
    ));
    let route = match (&done.program, &done.image) {
        (Some(_), Some(_)) => "program and coprocessor",
        (None, Some(_)) => "coprocessor: the program stays as it is",
        (_, None) => "corrected program",
    };
    facts.push(Fact::new("route", route));
    match of {
        Points::ThisPass => {}
        Points::FirstPass => {
            facts.push(Fact::new("probe points", "of the first pass, which left the stock of this one"))
        }
        Points::Corrected(part) => {
            facts.push(Fact::new("probe points", format!("of part {part}, as cut with the correction made for it")));
        }
    }
    if let Some(guard) = &s.guard {
        facts.push(Fact::new(
            "deepest cut allowed",
            Said::of(|unit| format!("{:.3} {}", unit.of(guard.max_gouge_mm), unit.name())),
        ));
    }
    if let Some(feed) = s.feed.as_ref().filter(|_| done.schedule.is_some()) {
        let [low, high] = feed.used_percent;
        facts.push(Fact::new("scheduled feed", format!("{low} to {high} % of the programmed one, in both passes")));
    }
    let corrected = s.feature.as_ref().map_or(0, |feature| feature.passes_corrected.len());
    if corrected > 1 {
        facts.push(Fact::new("depths corrected", format!("{corrected}, all with this correction")));
    }
    facts
}

/// What is expected of the whole wall, and what makes the error at its worst place.
fn at_every_height(surface: &Surfaces) -> [Fact; 2] {
    let after = &surface.after;
    let all = Said::of(|unit| {
        format!(
            "95 % of the wall within {:.3} ± {:.3} {name} (2 sigma), {:.3} {name} without the correction",
            unit.of(after.p95_mm),
            unit.of(2.0 * after.p95_sigma_mm),
            unit.of(surface.before.p95_mm),
            name = unit.name()
        )
    });
    let worst = Said::of(|unit| after.worst_words(unit));
    [Fact::new("at every height", all), Fact::new("what makes the worst", worst)]
}

/// What the error along the contour is of.
fn shown(target: Target, band: Band, depth_mm: f64) -> Said {
    let [from, to] =
        [band.from, band.to].map(|fraction| truepath_ground::units::rounded(float(fraction) * depth_mm, 4));
    let band = |unit: Unit| format!("{} to {} {} above the tip", unit.of(from), unit.of(to), unit.name());
    match target {
        Target::Mean => Said::of(|unit| format!("mean over {}", band(unit))),
        Target::Tip => "at the tip of the cutter".into(),
        Target::Minimax => Said::of(|unit| format!("middle between largest and smallest, {}", band(unit))),
    }
}
