//! Which of several features a command is about.

use std::collections::BTreeSet;
use std::ops::Range;

use truepath_core::gcode::{Found, LineRange, Role};
use truepath_ground::codes::J008;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Unit;

use super::listing::{CONTOUR, listed, rows};
use super::region::{Origin, Region};
use super::survey::Survey;
use crate::codes::{N001, N002, N010, N011};
use crate::job::{FeatureRole, JobFile};

/// The feature named by the user, or the only one that can be meant.
pub(super) fn chosen<'r>(
    job: &JobFile,
    program: &Source,
    regions: &'r [Region],
    survey: &Survey,
) -> Result<&'r Region, Failure> {
    let region = match &job.which.feature {
        Some(id) => named(regions, id)?,
        None => only(job, program, regions, survey)?,
    };
    checked(job, region)
}

/// The features that the job's cutter can finish, when none is named.
pub(super) fn candidates<'r>(
    job: &JobFile,
    program: &Source,
    regions: &'r [Region],
    survey: &Survey,
) -> Result<Vec<&'r Region>, Failure> {
    let finishing = finishing(job, regions)?;
    let cutters: BTreeSet<Option<u32>> = finishing.iter().map(|r| tool(r, survey)).collect();
    let cutter = job.numbers.tool.number;
    if cutter.is_none() && cutters.len() > 1 {
        return only(job, program, regions, survey).map(|region| vec![region]);
    }
    let fits = |r: &&Region| cutters.len() == 1 || tool(r, survey).is_none_or(|t| Some(t) == cutter);
    let fitting: Vec<_> = finishing.into_iter().filter(fits).collect();
    fitting.into_iter().map(|region| checked(job, region)).collect()
}

/// A feature that can be corrected with the job's cutter.
fn checked<'r>(job: &JobFile, region: &'r Region) -> Result<&'r Region, Failure> {
    if region.role != FeatureRole::Finish {
        let found = format!("{} is not a finishing cut", region.name());
        let help = "roughing, semi-finishing and spring passes stay as they are; name a feature with role = \"finish\"";
        return Err(region.error(InputError::new(N011, found, "a feature to be corrected", help)).into());
    }
    if let (Some(tool), Some(cutter)) = (region.tool, job.numbers.tool.number)
        && tool != cutter
    {
        let found = format!("{} is cut with tool {tool}, and [tool] describes number {cutter}", region.name());
        let help = "give the feature a job of its own with its cutter in [tool], or correct one of the two numbers";
        return Err(region.tool_error(InputError::new(J008, found, "the same tool in both", help)).into());
    }
    Ok(region)
}

fn named<'r>(regions: &'r [Region], id: &str) -> Result<&'r Region, Failure> {
    if let Some(region) = regions.iter().find(|r| r.id.as_deref() == Some(id)) {
        return Ok(region);
    }
    if let [whole] = regions
        && whole.origin == Origin::Search
        && id.starts_with(CONTOUR)
    {
        return Ok(whole);
    }
    let known: Vec<&str> = regions.iter().filter_map(|r| r.id.as_deref()).collect();
    let (expected, help) = if known.is_empty() {
        ("a program with markers, or a job with [[feature]]".to_owned(), "leave --feature out: the program is searched")
    } else {
        (format!("one of {}", known.join(", ")), "write one of these names exactly")
    };
    Err(InputError::new(N002, format!("there is no feature \"{id}\""), expected, help).into())
}

fn only<'r>(job: &JobFile, program: &Source, regions: &'r [Region], survey: &Survey) -> Result<&'r Region, Failure> {
    if let [only] = regions {
        return Ok(only);
    }
    let finishing = finishing(job, regions)?;
    let cutter = job.numbers.tool.number;
    let fits = |r: &&Region| cutter.is_some() && tool(r, survey) == cutter;
    let fitting: Vec<_> = finishing.iter().copied().filter(fits).collect();
    match (&finishing[..], &fitting[..]) {
        ([only], _) | (_, [only]) => Ok(only),
        _ => {
            let mut found = format!("{} features can be corrected, one at a time:", finishing.len());
            for region in &finishing {
                let runs = region.lines.map(|lines| survey.within(lines)).unwrap_or_default();
                let table = rows(&runs, 0.0);
                let tool = tool(region, survey).map_or_else(String::new, |t| format!(", tool {t}"));
                let lines = region.lines.unwrap_or(LineRange { first: 1, last: 1 });
                let length: f64 = table.iter().map(|r| r.length_mm).sum();
                found += &format!(
                    "\n  {}{tool}, lines {}-{}, {} runs of cutting moves, {length:.3} mm",
                    region.name(),
                    lines.first,
                    lines.last,
                    runs.len()
                );
            }
            Err(N001.error(found, "").told_in(Unit::at(program.bytes(), program.bytes().len())).into())
        }
    }
}

/// The finishing features; at least one.
fn finishing<'r>(job: &JobFile, regions: &'r [Region]) -> Result<Vec<&'r Region>, Failure> {
    let finishing: Vec<&Region> = regions.iter().filter(|r| r.role == FeatureRole::Finish).collect();
    if finishing.is_empty() {
        let help = "give the cut to be corrected role = \"finish\"";
        return Err(InputError::new(N011, "no feature is a finishing cut", "a feature to be corrected", help)
            .at(job.source(), job.span("feature"))
            .into());
    }
    Ok(finishing)
}

/// The tool of a feature, as named or as the program has it.
fn tool(region: &Region, survey: &Survey) -> Option<u32> {
    region.tool.or_else(|| survey.within(region.lines?).first()?.run.tool)
}

/// The error of a region that holds several finishing contours.
pub(super) fn ambiguous(
    region: &Region,
    program: &Source,
    (runs, count, allowance_mm): (&[Found], u32, f64),
    doubt: Option<&str>,
) -> Failure {
    let unit = Unit::at(program.bytes(), program.bytes().len());
    let table = rows(runs, allowance_mm);
    let walls = table.iter().filter(|r| r.role == "finish");
    let others = table.iter().filter(|r| r.role != "finish");
    let rest = match others.clone().count() {
        0 => String::new(),
        n => format!("\nbesides {n} other runs:{}", listed(others, unit)),
    };
    let found = format!("{count} finishing contours in {}, one is needed:{}{rest}", region.name(), listed(walls, unit));
    let help = doubt.unwrap_or("name one: --feature contour-N, as it stands at the end of its line; or [[feature]] with id and blocks (or lines) in the job, or (TRUEPATH BEGIN id) … (TRUEPATH END) around it in the program; a pocket and its island are two features");
    if region.origin != Origin::Search {
        return region.error(InputError::new(N010, found, "", help)).into();
    }
    let error = InputError::of_core("G071", found, "", help);
    let second = runs.iter().find(|f| matches!(f.role, Role::Finish { contour: 2, .. }));
    let line = second.map_or(1, |f| f.run.lines.first);
    error.at(program, line_span(program, line)).into()
}

/// A line without its end.
fn line_span(program: &Source, line: u32) -> Range<usize> {
    let start = program.span_at(line, 1, 0).start;
    let rest = program.bytes().get(start..).unwrap_or_default();
    let len = rest.iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count();
    start..start + len
}
