//! The path of the first of two passes: every pass of the feature moved away from the wall, depths, spring passes and
//! leads alike, and the proof that nothing else of the program reaches into what the second pass is to take.
//!
//! A spring pass may run against the finishing pass: it is moved to the same side of the wall, not of its travel.
//!
//! Limits: cuts of other tools are not looked at; nor are ramps and helices.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::gcode::Found;
use truepath_core::geometry::{Block, Contour, Point, Side};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::feature::{FeaturePass, Survey};
use truepath_job::pass::{Pass, PathBuffer};
use truepath_program::BlockEdit;

use crate::codes::{P020, P021};
use crate::edits::carried_edits;

/// Sine of the turn between two blocks from which on a corner counts as sharp: about 3 degrees.
const SHARP: Real = Real::ratio(5, 100);

/// A cut this much nearer than half of the allowance is none: rounding of programs.
const ROUNDING: Offset = Offset::from_um(5);

/// Shortest step along a cut that is looked at.
const STEP: Offset = Offset::from_um(50);

/// The moved path of every pass of the feature, in the order of the program.
///
/// # Errors
/// `P020` for an inside corner without room, `P021` for another cut that would reach the finished wall, and what is
/// wrong with a pass.
pub fn edits(pass: &Pass, half: Offset) -> Result<Vec<BlockEdit>, Failure> {
    let mut edits = Vec::new();
    let mut lines = Vec::new();
    for (along, leads) in every_pass(pass)? {
        edits.extend(moved(&along, [&leads[0], &leads[1]], half)?);
        lines.extend(leads.iter().flatten().chain(&along.blocks).map(|block| block.line));
    }
    if pass.plan.is_none() {
        return Ok(edits);
    }
    alone(pass, half, &lines)?;
    Ok(edits)
}

/// A pass over the contour and its leads.
pub(crate) type Along = (Pass, [Vec<Block>; 2]);

/// Every pass over the contour, spring passes that run against it as well, each beside the wall; and its leads.
pub(crate) fn every_pass(pass: &Pass) -> Result<Vec<Along>, Failure> {
    let Some(plan) = &pass.plan else { return Ok(vec![(pass.clone(), [Vec::new(), Vec::new()])]) };
    let one = |one: &FeaturePass| {
        let same = pass.along(one, pass.job.numbers.wall)?;
        if !against(&same.blocks, &pass.path_contour()) {
            return Ok((same, one.leads.clone()));
        }
        let along = pass.along(one, pass.job.numbers.wall.map(Side::other))?;
        Ok((along, one.leads.clone()))
    };
    plan.passes.iter().map(one).collect()
}

/// One pass and its leads, moved away from the wall.
fn moved(pass: &Pass, leads: [&[Block]; 2], by: Offset) -> Result<Vec<BlockEdit>, Failure> {
    room(pass, by)?;
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    Ok(carried_edits(pass, leads, &path, &away(&path, by)))
}

fn away(path: &Path, by: Offset) -> Vec<Node> {
    let contour = &path.samples()[path.first()..path.first() + path.count()];
    contour.iter().map(|sample| Node { chip: -sample.normal.times(by), ..Node::default() }).collect()
}

/// Whether a pass over the same path runs the other way, by the middle of its longest block.
fn against(blocks: &[Block], reference: &Contour) -> bool {
    let Some(longest) = blocks.iter().max_by_key(|b| b.curve.length()) else { return false };
    let mut nearest = None;
    reference.feet(longest.curve.point(Real::HALF), |foot| {
        if nearest.is_none_or(|(distance, _)| foot.left.abs() < distance) {
            nearest = Some((foot.left.abs(), foot));
        }
    });
    let Some((block, s)) = nearest.and_then(|(_, n)| Some((reference.blocks().get(n.block)?, n.s))) else {
        return false;
    };
    let origin = reference.blocks().first().map_or(Offset::ZERO, |b| b.s);
    let fraction = (s - (block.s - origin)).over(block.curve.length()).max(Real::ZERO).min(Real::ONE);
    longest.curve.heading(Real::HALF).dot(block.curve.heading(fraction)) < Real::ZERO
}

/// Refuses a cut of the same tool, beside those that are moved, that takes away what is left for the second pass.
fn alone(pass: &Pass, half: Offset, moved: &[u32]) -> Result<(), Failure> {
    let survey = Survey::read(&pass.job, &pass.program)?;
    let plan = pass.plan.iter().flat_map(|plan| &plan.passes);
    let own: Vec<u32> = plan.map(|one| one.part.run).collect();
    let tool = pass.job.numbers.tool.number;
    let lowest = pass.plan.iter().flat_map(|plan| &plan.passes).filter_map(|one| one.z).min();
    let top = lowest.map(|z| z + pass.core.job.cut.axial_depth);
    let counts = |found: &&Found| {
        let same_tool = tool.is_none() || found.run.tool.is_none() || found.run.tool == tool;
        let below = top.is_none_or(|top| found.run.z.is_none_or(|z| z < top));
        same_tool && below && !own.contains(&found.run.number)
    };
    let contour = pass.path_contour();
    let limit = half - ROUNDING;
    for block in survey.runs.iter().filter(counts).flat_map(|found| found.blocks(&survey.blocks)) {
        let Some(distance) = nearest(block, &contour, limit).filter(|_| !moved.contains(&block.line)) else { continue };
        let found = format!(
            "this cut comes {:.3} mm near the finishing path and would take away what is left for the second pass",
            mm(distance)
        );
        let expected = format!("no other cut of the tool nearer than half of the allowance, {} mm", mm(half));
        let place = pass.program.line_span(block.line);
        return Err(P021.error(found, expected).told_in(pass.unit()).at(&pass.program, place).into());
    }
    Ok(())
}

/// The first distance below `limit` that a block comes to a contour.
fn nearest(block: &Block, contour: &Contour, limit: Offset) -> Option<Offset> {
    let length = block.curve.length();
    let mut at = Offset::ZERO;
    loop {
        let point = block.curve.point(at.over(length).min(Real::ONE));
        let distance = distance(point, contour);
        if distance < limit {
            return Some(distance);
        }
        if at >= length {
            return None;
        }
        // No nearer place can come sooner than this.
        at += (distance - limit).max(STEP);
        at = at.min(length);
    }
}

fn distance(point: Point, contour: &Contour) -> Offset {
    let mut least = Offset::MAX;
    contour.feet(point, |foot| least = least.min(foot.left.abs()));
    least
}

/// Refuses an inside corner that the path of the first pass would have to cut across.
fn room(pass: &Pass, half: Offset) -> Result<(), Failure> {
    let left = pass.core.setup.wall == Side::Left;
    let refuse = |line: u32, found: String| {
        let expected = format!("inside arcs of more than half the allowance, {} mm", mm(half));
        let place = pass.program.line_span(line);
        Err(P020.error(found, expected).told_in(pass.unit()).at(&pass.program, place).into())
    };
    for (index, block) in pass.blocks.iter().enumerate() {
        // Turning away from the wall is an inside corner of the part.
        let inside = |turn_left: bool| turn_left != left;
        if let Some(radius) = block.curve.signed_radius()
            && inside(radius > Offset::ZERO)
            && radius.abs() <= half
        {
            return refuse(block.line, format!("an inside arc of radius {} mm on the cutter's path", mm(radius.abs())));
        }
        let next = pass.blocks.get(index + 1);
        if let Some(next) = next {
            let (from, to) = (block.curve.end_heading(), next.curve.start_heading());
            let turn = from.cross(to);
            if turn.abs() > SHARP && inside(turn > Real::ZERO) {
                return refuse(next.line, "a sharp inside corner".to_owned());
            }
        }
    }
    Ok(())
}
