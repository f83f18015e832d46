//! The page of `simulate`: one pass, with who computed it.

use truepath_ground::length::Remark;
use truepath_job::pass::Pass;

use super::{file, of_pass, page_warnings};
use crate::SimulateSummary;
use crate::next::after_simulation;
use crate::page::{Along, Fact, Figure, Kind, Outlook, Page, WallFigures, known};

/// The page of a simulated pass.
pub fn simulated(pass: &Pass, along: Along, summary: &SimulateSummary) -> Page {
    let mut page = of_pass(Kind::Simulate, "Pass of".to_owned(), pass);
    page.contour = Some(along.contour);
    page.heights = along.heights;
    if let Some(outcome) = &mut page.outcome {
        outcome.before_mm = known(summary.max_error_mm);
        outcome.profile_mm = summary.surface.as_ref().and_then(|surface| known(surface.profile_mm));
    }
    let worst_mm = summary.surface.as_ref().map_or(f64::NAN, |surface| surface.profile_mm);
    page.outlook = Some(Outlook { now: WallFigures::of(summary.max_error_mm, worst_mm), ..Outlook::default() });
    page.next = Some(after_simulation(file(pass.job.source().name())));
    page.results = figures(summary);
    page.warnings = page_warnings(pass, None, summary.warnings.iter().cloned().chain(along.note.map(Remark::from)));
    if let Some(job) = &mut page.job {
        job.facts.push(Fact::new("error shown", "mean over the engaged depth"));
    }
    page
}

fn figures(s: &SimulateSummary) -> Vec<Figure> {
    let figures = [
        Figure::mm("largest wall error", s.max_error_mm).map(|f| f.noted("mean over the height")),
        Figure::mm("root mean square", s.rms_error_mm),
        s.surface
            .as_ref()
            .and_then(|all| Figure::mm("profile error", all.profile_mm))
            .map(|f| f.noted("largest at any height, away from the ends")),
        s.surface.as_ref().and_then(|all| Figure::mm("95 % of the surface within", all.p95_mm)),
        Figure::of("largest engagement", s.max_arc_deg, 1, "°"),
        Figure::of("largest mean force", s.max_force_n, 1, "N"),
        Figure::of("largest chip area", s.max_chip_area_mm2, 3, "mm²").map(|f| f.noted("per tooth")),
        Figure::of("length of the contour", s.length_mm, 3, "mm"),
    ];
    figures.into_iter().flatten().collect()
}
