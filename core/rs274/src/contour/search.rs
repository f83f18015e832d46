//! The finishing contour among the runs of a program.
//!
//! The rules, in this order:
//! 1. A run cut with another tool than the one asked for does not count.
//! 2. Leads are split off ([`without_leads`]); the only run on lines that the caller named is left as it is unless G41,
//!    G42 and G40 show its leads.
//! 3. The same path at another height is another level of the same contour; the same path at the same height again is a
//!    spring pass, in whichever direction and from wherever it goes round.
//! 4. Moves between cuts and facing make no wall ([`Idle`]), as long as a run is left that does.
//! 5. A path that lies wholly on the free side of another one, no farther from it than a cutter's diameter, and that
//!    does not reach deeper, is roughing: the other one takes its wall away. Two paths with each other on the free side
//!    are two walls (a pocket and its island).
//! 6. What remains are finishing contours, numbered in the order of execution.
//!
//! Exactly one is needed; the caller decides what to do about none or several. Cost: every pair of different paths is
//! looked at from up to 320 places. Without a known side of the wall rule 5 does not apply.

use core::ops::Range;

use super::Candidate;
use super::idle::{Idle, mark};
use super::relation::{coincide, farther, same};
use super::split::{closed, length, without_leads};
use crate::LineRange;
use truepath_units::geometry::{Block, Side};
use truepath_units::{Offset, Position};

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Cut with another tool.
    OtherTool,
    /// It makes no wall.
    Idle(Idle),
    /// Another run takes its wall away.
    Rough {
        /// Its index in the list.
        nearer: usize,
        /// The smallest distance between the two.
        gap: Offset,
        /// Whether the distance is the same nearly everywhere.
        parallel: bool,
    },
    /// It makes a wall.
    Finish {
        /// Number of the contour, from 1.
        contour: u32,
        /// Number of the level, from 1 in the order of execution.
        level: u32,
    },
    /// It goes over a finished wall again.
    Spring {
        /// Number of the contour, from 1.
        contour: u32,
        /// Number of the level.
        level: u32,
    },
}

/// A run with its place among all blocks and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// What is told of it; after the search without its leads.
    pub run: Candidate,
    /// Index of its first block among the blocks of all runs.
    pub first: usize,
    /// Blocks of the run before the first one that is left: leads, or what the caller did not name.
    pub skipped: usize,
    /// What it is for.
    pub role: Role,
    /// Index of the first run along the same path.
    pub(super) like: usize,
    /// Why it makes no wall.
    pub(super) idle: Option<Idle>,
}

impl Found {
    /// A run that was read, whose first block is at `first` among the blocks of all runs.
    pub const fn new(run: Candidate, first: usize) -> Self {
        Self { run, first, skipped: 0, role: Role::OtherTool, like: 0, idle: None }
    }
    /// The same run with only some of its blocks, counted within it; `None` when there is none of them.
    pub fn narrowed(&self, kept: Range<usize>, blocks: &[Block]) -> Option<Self> {
        let contour = self.blocks(blocks).get(kept.clone())?;
        let lines = || contour.iter().map(|b| b.line);
        let (first, last) = (lines().min()?, lines().max()?);
        let behind = self.run.blocks.saturating_sub(kept.end);
        let run = Candidate {
            blocks: contour.len(),
            length: length(contour),
            lines: LineRange { first, last },
            closed: closed(contour),
            entry: self.run.entry.saturating_sub(kept.start),
            exit: self.run.exit.saturating_sub(behind),
            ..self.run
        };
        let skipped = self.skipped.saturating_add(kept.start);
        Some(Self { run, first: self.first.saturating_add(kept.start), skipped, ..*self })
    }
    /// Its blocks.
    pub fn blocks<'b>(&self, all: &'b [Block]) -> &'b [Block] {
        all.get(self.first..self.first.saturating_add(self.run.blocks)).unwrap_or_default()
    }
}

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Criteria {
    /// The tool; `None` for any.
    pub tool: Option<u32>,
    /// Side of travel of the finished wall; `None` leaves it to G41 and G42.
    pub wall: Option<Side>,
    /// The cutter's diameter.
    pub diameter: Offset,
    /// Whether the caller named the lines: the only run on them is taken as it is, but for what G41, G42 and G40 show.
    pub named: bool,
}

/// Gives every run its role and returns the number of finishing contours. `runs` are in the order of execution,
/// `blocks` those of all of them.
pub fn search(runs: &mut [Found], blocks: &[Block], criteria: &Criteria) -> u32 {
    let as_named = criteria.named && runs.len() == 1;
    for found in runs.iter_mut().filter(|f| counts(f, criteria)) {
        if !as_named || found.run.entry > 0 || found.run.exit > 0 {
            split(found, blocks, criteria);
        }
    }
    for index in 0..runs.len() {
        let like = first_alike(runs, blocks, criteria, index);
        if let Some(found) = runs.get_mut(index) {
            found.like = like;
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
        same(path, own) || (level(*head) && coincide(path, own))
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

/// The greatest depth of a path.
fn deepest(runs: &[Found], head: usize) -> Option<Position> {
    runs.iter().filter(|f| f.like == head).filter_map(|f| f.run.z).min()
}

/// Whether another path takes the wall of this one away. Finishing comes last, so the search begins there.
fn rough(runs: &[Found], blocks: &[Block], criteria: &Criteria, index: usize) -> Option<Role> {
    let own = runs.get(index)?;
    let depth = deepest(runs, index);
    for (nearer, other) in runs.iter().enumerate().rev() {
        if nearer == index || other.like != nearer || !counts(other, criteria) || other.idle.is_some() {
            continue;
        }
        let deep_enough = match (deepest(runs, nearer), depth) {
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
