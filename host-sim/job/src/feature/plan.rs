//! The one feature a command is about, with its passes.

use truepath_core::gcode::{Criteria, Found, LineRange, Role, is_marked_corrected};
use truepath_core::geometry::{Block, Side};
use truepath_core::job::Part;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::units::mm;

use super::choice::{ambiguous, chosen};
use super::listing::{FeatureSummary, PassRow, Row, rows};
use super::marker::marked;
use super::region::{Origin, Region, regions};
use super::survey::{LARGEST_SEARCH, Survey};
use crate::codes::{N009, N010, N011, N012};
use crate::job::{JobFile, Which};

/// One pass of a feature along its wall.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FeaturePass {
    /// Level, from 1 in the order of execution.
    pub number: u32,
    /// Whether it goes over a wall that is finished already.
    pub spring: bool,
    /// Its height.
    pub z: Option<Position>,
    /// Its lines, without leads.
    pub lines: LineRange,
    /// What the device needs to find it.
    pub part: Part,
    /// Moves of the same run that lead to it and away from it: the correction comes and goes along them.
    pub leads: [Vec<Block>; 2],
}

/// The feature.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Its number.
    pub number: u32,
    /// Its name.
    pub id: Option<String>,
    /// `search`, `job` or `markers`.
    pub chosen_by: &'static str,
    /// Why it was chosen.
    pub why: String,
    /// Its tool, side and stock, where they are not those of the job.
    pub tool: Option<u32>,
    /// The side of its wall.
    pub wall: Option<Side>,
    /// The stock on its wall.
    pub allowance: Option<Offset>,
    /// Its passes, in the order of execution.
    pub passes: Vec<FeaturePass>,
    /// Names of the other features of the program.
    pub others: Vec<String>,
    /// The runs that were looked at.
    pub rows: Vec<Row>,
    /// What deserves a look.
    pub warnings: Vec<String>,
}

/// Finds the feature; `None` when job and program name none and the program has one run of cutting moves at most,
/// without leads.
///
/// # Errors
/// What is wrong with the program, its markers or the features of the job, and what is ambiguous.
pub fn plan(job: &JobFile, program: &Source) -> Result<Option<Plan>, Failure> {
    if is_marked_corrected(program.bytes()) {
        // The pass refuses it, whatever it holds.
        return Ok(None);
    }
    let marked = marked(program)?;
    let survey = Survey::read(job, program)?;
    let regions = regions(job, program, &marked)?;
    let simple = regions.iter().all(|r| r.origin == Origin::Search) && job.which == Which::default();
    if simple && survey.runs.len() <= 1 {
        let numbers = &job.numbers;
        let criteria = Criteria { tool: None, wall: numbers.wall, diameter: numbers.tool.diameter, named: false };
        let mut only = survey.runs.clone();
        survey.sort(&mut only, &criteria);
        if only.iter().zip(&survey.runs).all(|(kept, run)| kept.run.blocks == run.run.blocks) {
            return Ok(None);
        }
    }
    let region = chosen(job, &regions, &survey)?;
    let mut runs = region.lines.map_or_else(|| survey.runs.clone(), |lines| survey.within(lines));
    if let Some(heights) = &region.heights {
        runs.retain(|f| f.run.z.is_some_and(|z| heights.iter().any(|h| near(*h, z))));
    }
    if runs.len() > LARGEST_SEARCH {
        let found = format!("{} has {} runs of cutting moves", region.name(), runs.len());
        let expected = format!("at most {LARGEST_SEARCH}, which are compared with each other");
        return Err(region.error(N010.error(found, expected)).into());
    }
    let numbers = &job.numbers;
    let tool = region.tool.or(numbers.tool.number);
    let named = region.origin != Origin::Search;
    let criteria = Criteria { tool, wall: region.wall.or(numbers.wall), diameter: numbers.tool.diameter, named };
    let count = survey.sort(&mut runs, &criteria);
    let allowance = region.allowance.unwrap_or(numbers.allowance);
    match count {
        1 => {}
        0 => return Err(nothing(region, &runs, tool)),
        _ => return Err(ambiguous(region, program, &runs, count, mm(allowance))),
    }
    let passes = passes(region, &runs, &survey);
    check_heights(region, &passes)?;
    Ok(Some(Plan {
        number: region.number,
        id: region.id.clone(),
        chosen_by: match region.origin {
            Origin::Job => "job",
            Origin::Markers => "markers",
            Origin::Search => "search",
        },
        why: why(region, &runs, tool),
        tool: region.tool,
        wall: region.wall,
        allowance: region.allowance,
        passes,
        others: regions.iter().filter(|r| r.number != region.number).filter_map(|r| r.id.clone()).collect(),
        rows: rows(&runs, mm(allowance)),
        warnings: plan_warnings(&runs, allowance),
    }))
}

fn near(a: Position, b: Position) -> bool {
    (a - b).abs() <= Offset::from_um(1)
}

fn passes(region: &Region, runs: &[Found], survey: &Survey) -> Vec<FeaturePass> {
    let pass = |found: &Found| {
        let (number, spring) = match found.role {
            Role::Finish { level, .. } => (level, false),
            Role::Spring { level, .. } => (level, true),
            Role::OtherTool | Role::Idle(_) | Role::Rough { .. } => return None,
        };
        let part = Part {
            feature: region.number,
            pass: number,
            run: found.run.number,
            first_block: u32::try_from(found.skipped).ok()?,
            blocks: u32::try_from(found.run.blocks).ok()?,
        };
        Some(FeaturePass { number, spring, z: found.run.z, lines: found.run.lines, part, leads: survey.leads(found) })
    };
    runs.iter().filter_map(pass).collect()
}

/// The heights of the passes must be those the job names.
fn check_heights(region: &Region, passes: &[FeaturePass]) -> Result<(), InputError> {
    let Some(heights) = &region.heights else { return Ok(()) };
    let text = |z: &Position| (z.nm() as f64 / 1e6).to_string();
    let found: Vec<Position> = passes.iter().filter_map(|p| p.z).collect();
    let count = |list: &[Position], z: Position| list.iter().filter(|h| near(**h, z)).count();
    if heights.iter().all(|z| count(&found, *z) >= count(heights, *z)) {
        return Ok(());
    }
    let heights: Vec<String> = heights.iter().map(text).collect();
    let seen: Vec<String> = found.iter().map(text).collect();
    let found = format!("z_mm names passes at {}, the program has them at {}", heights.join(", "), seen.join(", "));
    Err(region.heights_error(N009.error(found, "the heights of the program")))
}

/// No run makes a wall.
fn nothing(region: &Region, runs: &[Found], tool: Option<u32>) -> Failure {
    let mut tools: Vec<String> = runs.iter().filter_map(|f| f.run.tool).map(|t| t.to_string()).collect();
    tools.dedup();
    let found = match tool.filter(|_| !tools.is_empty()) {
        Some(tool) => format!("{} has no cut of tool {tool}, only of {}", region.name(), tools.join(", ")),
        None => format!("{} has no cutting move in X or Y at constant Z", region.name()),
    };
    let help = "correct the number of the tool, or the place of the feature";
    region.error(InputError::new(N011, found, "a cut along the wall", help)).into()
}

fn why(region: &Region, runs: &[Found], tool: Option<u32>) -> String {
    let count = |holds: fn(&Role) -> bool| runs.iter().filter(|f| holds(&f.role)).count();
    let levels = count(|r| matches!(r, Role::Finish { .. }));
    let rough = count(|r| matches!(r, Role::Rough { .. }));
    let idle = match count(|r| matches!(r, Role::Idle(_))) {
        0 => String::new(),
        n => format!(", {n} that make no wall"),
    };
    let (spring, other) = (count(|r| matches!(r, Role::Spring { .. })), count(|r| matches!(r, Role::OtherTool)));
    let of = tool.map_or_else(String::new, |t| format!(" of tool {t}"));
    let place = match region.origin {
        Origin::Search => "in the program",
        Origin::Job | Origin::Markers => "on its lines",
    };
    format!(
        "the only path{of} {place} whose wall no other run takes away ({levels} finishing, {rough} roughing, {spring} spring passes, {other} runs of other tools{idle})"
    )
}

/// Roughing that leaves something else than the job says.
fn plan_warnings(runs: &[Found], allowance: Offset) -> Vec<String> {
    let finish = |index: usize| runs.get(index).is_some_and(|f| matches!(f.role, Role::Finish { .. }));
    let gaps = runs.iter().filter_map(|f| match f.role {
        Role::Rough { nearer, gap, parallel: true } if finish(nearer) => Some((gap, f.run.lines)),
        _ => None,
    });
    let Some((gap, lines)) = gaps.min_by_key(|(gap, _)| *gap) else { return Vec::new() };
    let off = (gap - allowance).abs();
    if off <= Offset::from_um(20).max(Offset::from_nm(allowance.nm() / 20)) {
        return Vec::new();
    }
    vec![format!(
        "the pass before the finishing one (lines {}-{}) leaves {:.4} mm, the job says allowance_mm = {}",
        lines.first,
        lines.last,
        mm(gap),
        mm(allowance)
    )]
}

impl Plan {
    /// The finishing pass at a level.
    ///
    /// # Errors
    /// `N012` when there is none.
    pub fn level(&self, number: u32) -> Result<&FeaturePass, InputError> {
        let levels = || self.passes.iter().filter(|p| !p.spring);
        levels().find(|p| p.number == number).ok_or_else(|| {
            let found = format!("there is no pass {number}");
            let expected = format!("1 to {}", levels().count());
            N012.error(found, expected)
        })
    }

    /// Numbers of the finishing passes.
    pub fn levels(&self) -> Vec<u32> {
        self.passes.iter().filter(|p| !p.spring).map(|p| p.number).collect()
    }
}

impl Plan {
    /// What is told of it, for the level that a command is about.
    pub fn summary(&self, pass: u32, corrected: &[u32]) -> FeatureSummary {
        let row = |p: &FeaturePass| PassRow {
            pass: p.number,
            role: if p.spring { "spring" } else { "finish" },
            first_line: p.lines.first,
            last_line: p.lines.last,
            z_mm: p.z.map(|z| z.nm() as f64 / 1e6),
        };
        FeatureSummary {
            id: self.id.clone(),
            number: self.number,
            chosen_by: self.chosen_by,
            why: self.why.clone(),
            pass,
            passes: self.passes.iter().map(row).collect(),
            passes_corrected: corrected.to_vec(),
            other_features: self.others.clone(),
            candidates: self.rows.clone(),
        }
    }
}
