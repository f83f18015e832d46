//! The commanded displacements with which a pass leaves what it is meant to leave.

use super::depths::Depths;
use super::mill::{Load, Mill, Order};
use super::part::{Part, Wall};
use crate::correct::{Node, commanded, settle_ends};

use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// What a pass is meant to leave on the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// The middle between the largest and the smallest error over the height is zero: the last pass.
    Middle,
    /// The mean over the height is zero.
    Mean,
    /// Nowhere at any height less than this, and as little more as can be: a pass before another.
    Least(Offset),
}

/// Memory of a design, lent.
#[derive(Debug)]
pub struct AimWorkspace<'w> {
    /// As [`Mill::run`] fills it.
    pub moved: &'w mut [Vector],
    /// As [`Mill::walls`] fills them; afterwards those of the best commands.
    pub walls: &'w mut [Wall],
    /// One to a sample of the contour: shifts in the order of the path, and how many made each.
    pub shifts: &'w mut [(Offset, u32)],
    /// One to a sample of the contour.
    pub best: &'w mut [Node],
    /// Depths around the cutter.
    pub depths: &'w mut Depths,
}

/// How a design ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reached {
    /// The largest distance of a place from its aim.
    pub miss: Offset,
    /// The largest error that is left at any height, the sign aside.
    pub largest: Offset,
    /// Designs tried.
    pub turns: u32,
    /// What the best of them asks of machine and cutter.
    pub load: Load,
}

/// A step is no larger than this.
const STEP: Offset = Offset::from_um(500);
/// Near enough to the aim.
const NEAR: Offset = Offset::from_nm(500);
/// Times that shifts are smoothed: from a quarter of each neighbour, over about the length on which a circle leaves its tangent
/// by a micrometre.
const SMOOTHED: usize = 3;

/// Finds the commands of a pass over a part. `nodes` holds a first guess on entry (zero will do) and the commands that came nearest to
/// the aim on return; `workspace.walls` the walls they leave.
pub fn aim(
    mill: &Mill,
    (part, order): (&Part, &Order),
    (aim, turns): (Aim, u32),
    nodes: &mut [Node],
    workspace: &mut AimWorkspace,
) -> Reached {
    let path = mill.machine().path;
    let count = part.slices().count();
    let mut reached = Reached { miss: Offset::MAX, ..Reached::default() };
    let mut since = 0u32;
    for turn in 1..=turns.max(1) {
        let load = mill.run(part, order, |i| commanded(path, nodes, i), workspace.depths, workspace.moved);
        mill.walls(order, workspace.moved, workspace.walls);
        let (mut miss, mut largest) = (Offset::ZERO, Offset::ZERO);
        workspace.shifts.fill((Offset::ZERO, 0));
        for (index, walls) in workspace.walls.chunks(count).enumerate() {
            let before = part.beside(path.first().saturating_add(index));
            let Some(left) = Left::of(walls, before) else { continue };
            let near = path.samples().get(path.first().saturating_add(index)).is_some_and(|s| s.near_corner);
            let error = left.from(aim);
            if !near {
                miss = miss.max(error.abs());
                largest = largest.max(left.largest());
            }
            for wall in walls.iter().filter(|w| w.error.is_some()) {
                if let Some((sum, of)) = workspace.shifts.get_mut(wall.made_by as usize) {
                    (*sum, *of) = (*sum + error, of.saturating_add(1));
                }
            }
        }
        if miss < reached.miss {
            reached = Reached { miss, largest, turns: turn, load };
            workspace.best.copy_from_slice(nodes);
            since = 0;
        } else {
            since = since.saturating_add(1);
        }
        if miss <= NEAR || turn == turns || since >= 3 {
            break;
        }
        let relaxed = if turn <= 4 { Real::ONE } else { Real::ratio(6, 10) };
        spread(workspace.shifts);
        let samples = path.samples().iter().skip(path.first());
        for ((node, shift), sample) in nodes.iter_mut().zip(workspace.shifts.iter()).zip(samples) {
            let by = shift.0.max(-STEP).min(STEP).scaled(relaxed);
            node.chip = node.chip + sample.normal.times(by);
        }
        settle_ends(path, nodes);
    }
    nodes.copy_from_slice(workspace.best);
    mill.run(part, order, |i| commanded(path, nodes, i), workspace.depths, workspace.moved);
    mill.walls(order, workspace.moved, workspace.walls);
    reached
}

/// What a pass leaves beside a sample, over the height.
struct Left {
    highest: Offset,
    lowest: Offset,
    /// The lowest of what this pass itself makes.
    made: Option<Offset>,
    sum: Offset,
    count: i64,
}

impl Left {
    fn of(walls: &[Wall], before: &[Offset]) -> Option<Self> {
        let mut left = Self { highest: -Offset::MAX, lowest: Offset::MAX, made: None, sum: Offset::ZERO, count: 0 };
        for (wall, before) in walls.iter().zip(before) {
            let Some(made) = wall.error else { continue };
            let after = made.min(*before);
            left.highest = left.highest.max(after);
            left.lowest = left.lowest.min(after);
            if made <= *before {
                left.made = Some(left.made.map_or(made, |m| m.min(made)));
            }
            left.sum += after;
            left.count = left.count.saturating_add(1);
        }
        (left.count > 0).then_some(left)
    }

    /// By how much the cutter has to go nearer to the wall to meet an aim.
    fn from(&self, aim: Aim) -> Offset {
        // Where an earlier pass went deeper, this one cannot put anything back.
        let made = self.made.unwrap_or(self.highest);
        match aim {
            Aim::Middle => Offset::from_nm(self.highest.nm().saturating_add(made.nm()) / 2),
            Aim::Mean => self.sum.scaled(Real::ratio(1, self.count.max(1))),
            Aim::Least(least) => made - least,
        }
    }

    fn largest(&self) -> Offset {
        self.highest.abs().max(self.lowest.abs())
    }
}

/// Makes means of the sums, gives samples that made no wall the straight line between their neighbours, and smooths.
fn spread(shifts: &mut [(Offset, u32)]) {
    let mean = |(sum, count): (Offset, u32)| sum.scaled(Real::ratio(1, i64::from(count.max(1))));
    let mut at = 0usize;
    while at < shifts.len() {
        let gap = shifts.iter().skip(at).take_while(|s| s.1 == 0).count();
        if gap > 0 {
            let before = at.checked_sub(1).and_then(|i| shifts.get(i)).copied().map(mean);
            let after = shifts.get(at.saturating_add(gap)).copied().map(mean);
            let (from, to) = (before.or(after).unwrap_or_default(), after.or(before).unwrap_or_default());
            for (k, slot) in shifts.iter_mut().skip(at).take(gap).enumerate() {
                let share = Real::ratio(k.saturating_add(1) as i64, gap.saturating_add(1) as i64);
                *slot = (from + (to - from).scaled(share), 1);
            }
        }
        at = at.saturating_add(gap).saturating_add(1);
    }
    shifts.iter_mut().for_each(|shift| *shift = (mean(*shift), 1));
    for _ in 0..SMOOTHED {
        let mut before: Option<Offset> = None;
        for at in 0..shifts.len() {
            let behind = shifts.get(at.saturating_add(1)).map(|s| s.0);
            let Some(slot) = shifts.get_mut(at) else { break };
            let own = slot.0;
            let sum = own + own + before.unwrap_or(own) + behind.unwrap_or(own);
            slot.0 = sum.scaled(Real::ratio(1, 4));
            before = Some(own);
        }
    }
}
