//! The page of a part of `demo`: the first and the corrected part as the virtual machine cut them, no predictions.

use truepath_correction::correct::CorrectedPass;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Said;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Milled, Score, judged_trim_mm};

use super::corrected::{Points, corrected};
use crate::next::after_demonstration;
use crate::page::{Fact, Figure, Page, WallFigures, known, milled_twice};

/// The page of a part that was cut without and with its correction.
///
/// # Errors
/// As [`corrected`].
pub fn demonstrated(
    title: &str,
    pass: &Pass,
    measurement: &Measurement,
    done: &CorrectedPass,
    cut: [(&Milled, &Score); 2],
) -> Result<Page, Failure> {
    let mut page = corrected(pass, measurement, done, Points::ThisPass)?;
    title.clone_into(&mut page.title);
    let [(first, before), (second, after)] = cut;
    let labels = ["first part, cut by the virtual machine", "corrected part, cut by the virtual machine"];
    let trim_mm = judged_trim_mm(first.cut.radius_mm);
    if let Some(contour) = &mut page.contour {
        page.heights = milled_twice(contour, [(first, labels[0]), (second, labels[1])], trim_mm);
    }
    if let Some(outcome) = &mut page.outcome {
        outcome.before_mm = known(before.max_error_mm);
        outcome.after_mm = known(after.max_error_mm);
        outcome.profile_mm = known(after.worst_height_mm);
        outcome.gouge_mm = known(after.gouge_mm.max(0.0));
        // That of the points is of what was foretold.
        outcome.sigma_mm = None;
    }
    if let Some(outlook) = &mut page.outlook {
        outlook.now = WallFigures::of(before.max_error_mm, before.worst_height_mm);
        outlook.next = Some(WallFigures::of(after.max_error_mm, after.worst_height_mm));
        outlook.cut = true;
    }
    page.next = Some(after_demonstration());
    let profile = &done.summary.surface.after.profile;
    page.told = Some(Said::of(|unit| {
        format!(
            "cut: mean over the height {:.3} -> {:.3} {name}; any height {:.3} -> {:.3} {name} ({:.3} ± {:.3} expected)",
            unit.of(before.max_error_mm),
            unit.of(after.max_error_mm),
            unit.of(before.worst_height_mm),
            unit.of(after.worst_height_mm),
            unit.of(profile.profile_mm),
            unit.of(2.0 * profile.sigma_mm),
            name = unit.name()
        )
    }));
    page.results = figures(before, after, done);
    // What was foretold of a part that has been cut is not its verdict.
    (page.tolerance_mm, page.verdict) = (None, None);
    if let Some(job) = &mut page.job {
        job.facts.retain(|fact| fact.name != "error shown");
        let shown = Said::of(|unit| {
            let (trim, name) = (unit.of(trim_mm), unit.name());
            format!(
                "mean over the engaged depth; the {trim} {name} at both ends, where the cutter plunges and lifts, are not judged"
            )
        });
        job.facts.push(Fact::new("error shown", shown));
    }
    Ok(page)
}

fn figures(before: &Score, after: &Score, done: &CorrectedPass) -> Vec<Figure> {
    let rms = |score: &Score| Said::of(|unit| format!("cut, rms {:.3} {}", unit.of(score.rms_error_mm), unit.name()));
    let s = &done.summary;
    let figures = [
        Figure::mm("largest error, first part", before.max_error_mm).map(|f| f.noted(rms(before))),
        Figure::mm("largest error, corrected part", after.max_error_mm).map(|f| f.noted(rms(after))),
        Figure::mm("largest error, predicted", s.max_error_after_mm).map(|f| f.noted("from the points")),
        Figure::mm("standard deviation there", s.sigma_at_max_error_mm),
        Figure::mm("left over the height", after.axial_form_mm).map(|f| f.noted("cut; no X Y shift cures it")),
        Figure::mm("deepest cut", after.gouge_mm.max(0.0)).map(|f| f.noted("cut, mean over the height")),
        Figure::mm("largest correction", s.max_correction_mm).map(|f| f.noted("along an axis")),
        Figure::mm("residual of the fit", s.fit_residual_mm).map(|f| f.noted(format!("{} points used", s.points_used))),
    ];
    figures.into_iter().flatten().collect()
}
