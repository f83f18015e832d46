//! The finishing contour among the runs of a program.
//!
//! The rules, in this order:
//! 1. A run cut with another tool than the one asked for does not count.
//! 2. Leads are split off ([`without_leads`]); the only run on lines that the caller named is left as it is unless G41,
//!    G42 and G40 show its leads.
//! 3. The same path at another height is another level of the same contour; the same path at the same height again is a
//!    spring pass, in whichever direction and from wherever it goes round.
//! 4. Moves between cuts and facing make no wall ([`Idle`](super::Idle)), as long as a run is left that does.
//! 5. A path that lies wholly on the free side of another one, no farther from it than a cutter's diameter, and that
//!    does not reach deeper, is roughing: the other one takes its wall away. Two paths with each other on the free side
//!    are two walls (a pocket and its island).
//! 6. What remains are finishing contours, numbered in the order of execution.
//!
//! Exactly one is needed; the caller decides what to do about none or several. Cost: every pair of different paths is
//! looked at from up to 320 places, unless the rectangles that hold them are farther apart than a cutter's diameter. Without a
//! known side of the wall rule 5 does not apply.

use super::found::{Criteria, Found, Role};
use super::idle::mark;
use super::relation::{SAME, coincide, farther, same};
use super::split::without_leads;
use truepath_units::geometry::{Block, Extent};
use truepath_units::{Offset, Position};

/// Gives every run its role and returns the number of finishing contours. `runs` are in the order of execution,
/// `blocks` those of all of them.
pub fn search(runs: &mut [Found], blocks: &[Block], criteria: &Criteria) -> u32 {
    let as_named = criteria.named && runs.len() == 1;
    for found in runs.iter_mut().filter(|f| counts(f, criteria)) {
        if !as_named || found.run.entry > 0 || found.run.exit > 0 {
            split(found, blocks, criteria);
        }
    }
    runs.iter_mut().for_each(|found| found.extent = Extent::of(found.blocks(blocks)));
    for index in 0..runs.len() {
        let like = first_alike(runs, blocks, criteria, index);
        if let Some(found) = runs.get_mut(index) {
            found.like = like;
            found.deepest = found.run.z;
        }
        let (own, head) = (runs.get(index).and_then(|f| f.run.z), runs.get_mut(like));
        if let Some(head) = head {
            head.deepest = match (head.deepest, own) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
        }
    }
    runs.iter_mut().for_each(|found| found.idle = None);
    mark(runs, blocks, criteria);
    if !runs.iter().any(|found| counts(found, criteria) && found.idle.is_none()) {
        runs.iter_mut().for_each(|found| found.idle = None);
    }
    let mut contours = 0u32;
    for index in 0..runs.len() {
        let Some(found) = runs.get(index) else { continue };
        let role = if !counts(found, criteria) {
            Role::OtherTool
        } else if let Some(idle) = found.idle {
            Role::Idle(idle)
        } else if found.like == index {
            match rough(runs, blocks, criteria, index) {
                Some(role) => role,
                None => {
                    contours = contours.saturating_add(1);
                    Role::Finish { contour: contours, level: 1 }
                }
            }
        } else {
            follower(runs, index)
        };
        if let Some(found) = runs.get_mut(index) {
            found.role = role;
        }
    }
    contours
}

fn counts(found: &Found, criteria: &Criteria) -> bool {
    criteria.tool.is_none_or(|tool| found.run.tool.is_none_or(|t| t == tool))
}

/// Takes the leads off a run.
fn split(found: &mut Found, blocks: &[Block], criteria: &Criteria) {
    let wall = criteria.wall.or(found.run.wall);
    let kept = without_leads(found.blocks(blocks), &found.run, wall, criteria.diameter);
    if let Some(narrowed) = found.narrowed(kept, blocks) {
        *found = narrowed;
    }
}

/// The first run along the same path, which may be the run itself.
fn first_alike(runs: &[Found], blocks: &[Block], criteria: &Criteria, index: usize) -> usize {
    let Some(found) = runs.get(index).filter(|f| counts(f, criteria)) else { return index };
    let own = found.blocks(blocks);
    let heads = runs.iter().enumerate().take(index).filter(|(i, f)| f.like == *i && counts(f, criteria));
    let level = |head| runs.iter().take(index).any(|f| f.like == head && same_height(f.run.z, found.run.z));
    let mut alike = heads.filter(|(head, f)| {
        let path = f.blocks(blocks);
        let apart = f.extent.is_apart(&found.extent, SAME);
        !apart && (same(path, own) || (level(*head) && coincide(path, own)))
    });
    alike.next().map_or(index, |(head, _)| head)
}

fn same_height(a: Option<Position>, b: Option<Position>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= Offset::from_um(1),
        (None, None) => true,
        _ => false,
    }
}

/// Whether another path takes the wall of this one away. Finishing comes last, so the search begins there.
fn rough(runs: &[Found], blocks: &[Block], criteria: &Criteria, index: usize) -> Option<Role> {
    let own = runs.get(index)?;
    for (nearer, other) in runs.iter().enumerate().rev() {
        if nearer == index || other.like != nearer || !counts(other, criteria) || other.idle.is_some() {
            continue;
        }
        if own.extent.is_apart(&other.extent, criteria.diameter) {
            continue;
        }
        let deep_enough = match (other.deepest, own.deepest) {
            (Some(other), Some(own)) => other <= own + Offset::from_um(1),
            (None, None) => true,
            _ => false,
        };
        let Some(wall) = criteria.wall.or(other.run.wall).filter(|_| deep_enough) else { continue };
        if let Some(gap) = farther(own.blocks(blocks), other.blocks(blocks), wall, criteria.diameter) {
            return Some(Role::Rough { nearer, gap: gap.distance, parallel: gap.parallel });
        }
    }
    None
}

/// The role of a run along a path that was there before: that of the first one, at its own level.
fn follower(runs: &[Found], index: usize) -> Role {
    let Some(found) = runs.get(index) else { return Role::OtherTool };
    let Some(head) = runs.get(found.like) else { return Role::OtherTool };
    let Role::Finish { contour, .. } = head.role else { return head.role };
    let mut highest = 0u32;
    for earlier in runs.iter().take(index).filter(|f| f.like == found.like) {
        let (Role::Finish { level, .. } | Role::Spring { level, .. }) = earlier.role else { continue };
        if same_height(earlier.run.z, found.run.z) {
            return Role::Spring { contour, level };
        }
        highest = highest.max(level);
    }
    Role::Finish { contour, level: highest.saturating_add(1) }
}
