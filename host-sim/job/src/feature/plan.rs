//! The one feature a command is about, with its passes.

use truepath_core::gcode::{Criteria, Found, LineRange, Role, is_marked_corrected};
use truepath_core::geometry::{Block, Side};
use truepath_core::job::Part;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Said;
use truepath_ground::units::mm;

use super::choice::{ambiguous, candidates, chosen};
use super::doubt::doubt;
use super::listing::{CONTOUR, FeatureSummary, PassRow, Row, rows};
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
    pub warnings: Vec<Said>,
}

/// Finds the feature; `None` when job and program name none and the program has one run of cutting moves at most,
/// without leads.
///
/// # Errors
/// What is wrong with the program, its markers or the features of the job, and what is ambiguous.
pub fn plan(job: &JobFile, program: &Source) -> Result<Option<Plan>, Failure> {
    let Some(search) = Search::of(job, program)? else { return Ok(None) };
    let region = chosen(job, program, &search.regions, &search.survey)?;
    let sorted = search.sorted(job, region)?;
    let contour = match (sorted.contours, contour_named(job)) {
        (count, Some(named)) if region.origin == Origin::Search && named <= count => named,
        (1, _) => 1,
        (count, _) => {
            return Err(ambiguous(region, program, (&sorted.runs, count, mm(sorted.allowance)), None));
        }
    };
    search.plan(region, &sorted, contour).map(Some)
}

/// Finds every contour that can be corrected with the job's cutter, in the order of the program; none where [`plan`] gives
/// none, and the one that is named where one is.
///
/// # Errors
/// As [`plan`], but for what several of them make ambiguous there; contours of several tools where the job does not say which
/// of them it describes.
pub fn plans(job: &JobFile, program: &Source) -> Result<Vec<Plan>, Failure> {
    if job.which.feature.is_some() {
        return Ok(plan(job, program)?.into_iter().collect());
    }
    let Some(search) = Search::of(job, program)? else { return Ok(Vec::new()) };
    let mut plans = Vec::new();
    for region in candidates(job, program, &search.regions, &search.survey)? {
        let sorted = search.sorted(job, region)?;
        if sorted.contours > 1 {
            let doubt = doubt(&sorted.runs, sorted.contours, &search.survey, sorted.allowance);
            if region.origin != Origin::Search || doubt.is_some() {
                let listed = (&sorted.runs[..], sorted.contours, mm(sorted.allowance));
                return Err(ambiguous(region, program, listed, doubt));
            }
        }
        for contour in 1..=sorted.contours {
            plans.push(search.plan(region, &sorted, contour)?);
        }
    }
    Ok(plans)
}

/// The number of a contour that was found by search and is named `contour-N`.
fn contour_named(job: &JobFile) -> Option<u32> {
    job.which.feature.as_deref()?.strip_prefix(CONTOUR)?.parse().ok().filter(|n| *n > 0)
}

/// The runs of a program and where features are in it.
struct Search {
    survey: Survey,
    regions: Vec<Region>,
}

/// The runs of a region, each with its role.
struct Sorted {
    runs: Vec<Found>,
    /// How many finishing contours they are.
    contours: u32,
    tool: Option<u32>,
    allowance: Offset,
}

impl Search {
    /// Reads the program; `None` where there is nothing to choose.
    fn of(job: &JobFile, program: &Source) -> Result<Option<Self>, Failure> {
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
        Ok(Some(Self { survey, regions }))
    }

    /// Gives the runs of a region their roles; at least one makes a wall.
    fn sorted(&self, job: &JobFile, region: &Region) -> Result<Sorted, Failure> {
        let survey = &self.survey;
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
        let contours = survey.sort(&mut runs, &criteria);
        if contours == 0 {
            return Err(nothing(region, &runs, tool));
        }
        Ok(Sorted { runs, contours, tool, allowance: region.allowance.unwrap_or(numbers.allowance) })
    }

    /// One of the contours of a region.
    fn plan(&self, region: &Region, sorted: &Sorted, contour: u32) -> Result<Plan, Failure> {
        let Sorted { runs, contours, tool, allowance } = sorted;
        let found = *contours > 1;
        let number = if found { contour } else { region.number };
        let passes = passes(number, contour, runs, &self.survey);
        check_heights(region, &passes)?;
        let named = self.regions.iter().filter(|r| r.number != region.number).filter_map(|r| r.id.clone());
        let name = |n: u32| format!("{CONTOUR}{n}");
        let others =
            if found { (1..=*contours).filter(|n| *n != contour).map(name).collect() } else { named.collect() };
        Ok(Plan {
            number,
            id: if found { Some(name(contour)) } else { region.id.clone() },
            chosen_by: match region.origin {
                Origin::Job => "job",
                Origin::Markers => "markers",
                Origin::Search => "search",
            },
            why: why(region, runs, *tool, (contour, *contours)),
            tool: region.tool,
            wall: region.wall,
            allowance: region.allowance,
            passes,
            others,
            rows: rows(runs, mm(*allowance)),
            warnings: plan_warnings(runs, contour, *allowance),
        })
    }
}

fn near(a: Position, b: Position) -> bool {
    (a - b).abs() <= Offset::from_um(1)
}

/// The passes of a contour, which the device knows as a feature of some number.
fn passes(feature: u32, of: u32, runs: &[Found], survey: &Survey) -> Vec<FeaturePass> {
    let pass = |found: &Found| {
        let (number, spring) = match found.role {
            Role::Finish { level, contour } if contour == of => (level, false),
            Role::Spring { level, contour } if contour == of => (level, true),
            _ => return None,
        };
        let part = Part {
            feature,
            pass: number,
            run: found.run.number,
            first_block: u32::try_from(found.skipped).ok()?,
            blocks: u32::try_from(found.run.blocks).ok()?,
            alike: Default::default(),
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

fn why(region: &Region, runs: &[Found], tool: Option<u32>, (of, contours): (u32, u32)) -> String {
    let count = |holds: &dyn Fn(&Role) -> bool| runs.iter().filter(|f| holds(&f.role)).count();
    let levels = count(&|r| matches!(r, Role::Finish { contour, .. } if *contour == of));
    let rough = count(&|r| matches!(r, Role::Rough { .. }));
    let spring = count(&|r| matches!(r, Role::Spring { contour, .. } if *contour == of));
    let other = count(&|r| matches!(r, Role::OtherTool));
    let idle = match count(&|r| matches!(r, Role::Idle(_))) {
        0 => String::new(),
        n => format!(", {n} that make no wall"),
    };
    let by = tool.map_or_else(String::new, |t| format!(" of tool {t}"));
    let place = match region.origin {
        Origin::Search => "in the program",
        Origin::Job | Origin::Markers => "on its lines",
    };
    let one = if contours == 1 { "the only path".to_owned() } else { format!("one of {contours} paths") };
    format!(
        "{one}{by} {place} whose wall no other run takes away ({levels} finishing, {rough} roughing, {spring} spring passes, {other} runs of other tools{idle})"
    )
}

/// Roughing that leaves something else than the job says.
fn plan_warnings(runs: &[Found], of: u32, allowance: Offset) -> Vec<Said> {
    let finish =
        |index: usize| runs.get(index).is_some_and(|f| matches!(f.role, Role::Finish { contour, .. } if contour == of));
    let gaps = runs.iter().filter_map(|f| match f.role {
        Role::Rough { nearer, gap, parallel: true } if finish(nearer) => Some((gap, f.run.lines)),
        _ => None,
    });
    let Some((gap, lines)) = gaps.min_by_key(|(gap, _)| *gap) else { return Vec::new() };
    let off = (gap - allowance).abs();
    if off <= Offset::from_um(20).max(Offset::from_nm(allowance.nm() / 20)) {
        return Vec::new();
    }
    vec![Said::of(|unit| {
        format!(
            "the pass before the finishing one (lines {}-{}) leaves {:.4} {}, the job says allowance_mm = {}",
            lines.first,
            lines.last,
            unit.of(mm(gap)),
            unit.name(),
            mm(allowance)
        )
    })]
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
