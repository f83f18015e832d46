//! The page of `inspect`: a part for its customer. Deviations are those of the points; no model enters.

use truepath_correction::inspection;
use truepath_correction::inspection::Judgement;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Remark, Said, Unit};
use truepath_ground::units::mm;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::{file, of_pass, page_warnings};
use crate::next::correct;
use crate::page::{
    Figure, InputFile, Inspected, Kind, Limits, Outlook, Page, State, Verdict, WallFigures, judged_points, known,
    nominal,
};
use crate::{InspectSummary, statements};

/// The page of an inspection. The judgement is said in millimetres and in inches. `warnings` are those of the summary without one for every reading set aside: these stand in the
/// table of points.
pub fn inspected(
    pass: &Pass,
    measurement: &Measurement,
    [in_mm, in_inches]: [&Judgement; 2],
    summary: &InspectSummary,
    warnings: &[Remark],
) -> Result<Page, Failure> {
    let mut page = of_pass(Kind::Inspect, "Inspection report:".to_owned(), pass);
    if let Some(name) = &summary.part.name {
        page.title = format!("Inspection report: {name}");
    }
    let mut buffer = PathBuffer::default();
    let mut notes = Vec::new();
    // A contour that leaves no wall at some tight corner can still be touched elsewhere.
    match pass.sample(&mut buffer) {
        Ok(path) => {
            let along = nominal(&path);
            page.contour = Some(along.contour);
            notes.extend(along.note);
        }
        Err(Failure::Input(error)) => notes.push(format!("the contour is not drawn: {error}")),
        Err(failure) => return Err(failure),
    }
    let judged = |unit| if unit == Unit::Inch { in_inches } else { in_mm };
    let (points, left_out) = judged_points(pass, measurement, &in_mm.points);
    page.points = points;
    if let Some(outcome) = &mut page.outcome {
        outcome.measured_mm = known(summary.max_error_mm.abs().max(summary.min_error_mm.abs()));
        outcome.gouge_mm = known((-summary.min_error_mm).max(0.0));
    }
    let surface = &summary.surface;
    page.outlook = Some(Outlook {
        now: WallFigures {
            worst_sigma_mm: known(surface.sigma_mm),
            ..WallFigures::of(surface.mean_mm, surface.profile_mm)
        },
        ..Outlook::default()
    });
    let dimensions = measurement.dimensions.as_ref().map(|of| of.source.name());
    // Dimensions alone are the file that was measured from.
    let probe = Some(measurement.file.as_str()).filter(|name| dimensions != Some(*name));
    page.next = Some(correct(file(pass.job.source().name()), probe.map(file), dimensions.map(file)));
    page.told = Some(Said::of(|unit| surface.words(unit) + " (2 sigma)"));
    page.results = figures(summary, measurement, in_mm.decimals);
    page.verdict = Some(Verdict {
        state: match summary.verdict.state {
            inspection::State::Pass => State::Pass,
            inspection::State::Fail => State::Fail,
            inspection::State::Open => State::Open,
        },
        text: Said::of(|unit| judged(unit).verdict.text.clone()),
    });
    page.limits = Limits::of(summary);
    let rests_on = |unit| statements(judged(unit), surface, summary.feature.as_ref(), unit);
    let statements = rests_on(Unit::Millimetre).into_iter().zip(rests_on(Unit::Inch));
    let statements =
        statements.map(|(mm, inches)| Said::of(|unit| if unit == Unit::Inch { &inches } else { &mm }.clone()));
    page.inspected = Some(Inspected {
        part: summary.part.clone(),
        files: vec![
            InputFile::new("program", pass.program.name(), &summary.program_crc32),
            InputFile::new("probe file", &measurement.file, &summary.probe_crc32),
            InputFile::new("job", pass.job.source().name(), &summary.job_crc32),
        ],
        statements: statements.collect(),
        coverage: summary.coverage.clone(),
    });
    let notes = notes.into_iter().chain(left_out).map(Remark::from);
    page.warnings = page_warnings(pass, Some(&measurement.file), warnings.iter().cloned().chain(notes));
    Ok(page)
}

fn figures(s: &InspectSummary, measurement: &Measurement, decimals: usize) -> Vec<Figure> {
    let told = |name: &str, value: f64| Figure::of(name, value, u32::try_from(decimals).unwrap_or(6), "mm");
    let (most, least) = (
        if s.max_error_mm > 0.0 { "most material left" } else { "shallowest cut" },
        if s.min_error_mm < 0.0 { "deepest cut" } else { "least material left" },
    );
    let points = |state: &str, count: usize| Figure::of(format!("points {state}"), count as f64, 0, "");
    let touched = measurement.contacts.iter().map(|c| c.s).min().zip(measurement.contacts.iter().map(|c| c.s).max());
    let between = touched.map(|(from, to)| {
        Said::of(|unit| {
            let [from, to] = [from, to].map(|s| unit.of(mm(s)));
            format!("between s = {from:.1} and {to:.1} {}", unit.name())
        })
    });
    let count = s.points_by_verdict.unwrap_or_default();
    let judged = s.points_by_verdict.is_some();
    let causes = &s.surface.causes;
    let figures = [
        Figure::mm("mean", s.mean_error_mm).map(|f| f.noted("a wear offset removes it")),
        told("largest", s.max_error_mm).map(|f| f.noted(most)),
        told("smallest", s.min_error_mm).map(|f| f.noted(least)),
        Figure::mm("root mean square", s.rms_error_mm),
        Figure::mm("spread over the height", s.spread_over_height_mm).map(|f| f.noted("largest of one place")),
        Figure::mm("95 % of the points", s.surface.p95_mm).map(|f| f.noted("are within")),
        Figure::mm("worst point: mean of its place", causes.mean_mm).map(|f| f.noted("what x and y cure")),
        Figure::mm("over the height", causes.height_mm).map(|f| f.noted("beside that mean: helix and bending")),
        points("measured", s.points).map(|f| f.noted(between.unwrap_or_else(|| "".into()))),
        points("within", count.pass).filter(|_| judged),
        points("outside", count.fail).filter(|_| judged),
        points("undecided", count.open).filter(|_| judged),
        points("set aside", s.points_rejected),
    ];
    figures.into_iter().flatten().collect()
}
