//! The commanded displacements with which a pass leaves what it is meant to leave.

use super::depths::Depths;
use super::mill::{Load, Mill, Order};
use super::part::{Part, Wall};
use crate::correct::{Node, SMOOTHED, Update, commanded, fill_gaps, settle_ends, smooth};

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
    /// One to a sample of the contour: by how much it has to go nearer to the wall.
    pub shifts: &'w mut [Update],
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
    // Whether the walls at hand are those of the best commands.
    let mut at_hand = false;
    for turn in 1..=turns.max(1) {
        let load = mill.run(part, order, |i| commanded(path, nodes, i), workspace.depths, workspace.moved);
        mill.walls(order, workspace.moved, workspace.walls);
        let (mut miss, mut largest) = (Offset::ZERO, Offset::ZERO);
        workspace.shifts.fill(Update::default());
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
                if let Some(shift) = workspace.shifts.get_mut(wall.made_by as usize) {
                    shift.sum += error;
                    shift.count = shift.count.saturating_add(1);
                }
            }
        }
        at_hand = miss < reached.miss;
        if at_hand {
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
        fill_gaps(workspace.shifts);
        (0..SMOOTHED).for_each(|_| smooth(workspace.shifts));
        let samples = path.samples().iter().skip(path.first());
        for ((node, shift), sample) in nodes.iter_mut().zip(workspace.shifts.iter()).zip(samples) {
            let by = shift.mean().max(-STEP).min(STEP).scaled(relaxed);
            node.chip = node.chip + sample.normal.times(by);
        }
        settle_ends(path, nodes);
    }
    if at_hand {
        return reached;
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
