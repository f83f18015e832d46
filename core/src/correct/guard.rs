//! The gouge guard: what a part may lose at most, whatever the target asks for.
//!
//! The target says where the wall should lie; the guard forbids a correction with which it may end deeper than
//! `max_gouge` at any height of the engaged depth. May: the deepest height, predicted, less three of its standard
//! deviations. These follow from the fit and the correction, so the contour is first designed without guard; where that
//! goes too deep it is designed again with three standard deviations kept free beside every sample, and once more when
//! these have changed. What a design leaves of it is taken back at the places. Limits: the standard deviation is that of the fit's parameters; a sharp inside corner, where the
//! correction is held, is not guarded; the laws kept for comparison know no guard.

use super::design::{Design, DesignStep, DesignWorkspace, Law, Predicted, copy, design_observed, pass, worst};
use super::node::Node;
use super::profile::Profile;
use super::prudence::{Damped, damp};
use super::refine::settle_ends;
use super::uncertainty::spread;
use crate::cut::{Loop, Passage};
use crate::geometry::Vector;
use crate::identify::{Fit, Prior};
use crate::units::{Offset, Real, hypot_nm};

/// Standard deviations kept free: the guard holds for the worst place of a whole contour, where two are often used up.
pub const GUARD_SIGMAS: i32 = 3;
/// Designs under a guard at most, after the one without.
const ROUNDS: u16 = 2;
/// A guard missed by more than this is designed again; less is taken back on the spot.
const MISSED: Offset = Offset::from_um(2);
/// Times that what is left is taken back at most.
const LIFTS: usize = 6;
/// How much less is taken back from sample to sample, so that no step remains in the path.
const SLOPE: Offset = Offset::from_nm(500);

/// A correction and what is known about it, in buffers lent by the caller.
#[derive(Debug)]
pub struct Guarded<'a> {
    /// The correction, as long as the contour's own samples.
    pub nodes: &'a mut [Node],
    /// What the target alone wants; as long as `nodes`, or empty where it is not asked for.
    pub unguarded: &'a mut [Node],
    /// Predicted walls; as long as `nodes`, or empty.
    pub predicted: &'a mut [Predicted],
    /// Where only a share of it is applied, if anywhere; set by the design.
    pub damped: Option<Damped>,
}

/// As [`design_observed`], under the guard of the design. Without guard the two are the same. On return
/// `workspace.profiles` holds the corrected wall and the margins the guard has kept. By [`Law::Model`] a wall that is known
/// too badly is corrected in part; what the guard forbids, it forbids of that as well.
pub fn guarded_design(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    made: &mut Guarded<'_>,
    workspace: &mut DesignWorkspace,
    observe: &mut dyn FnMut(DesignStep<'_>),
) -> Passage {
    let limit = wanted.max_gouge.filter(|_| wanted.law == Law::Model);
    let free = Design { max_gouge: None, ..*wanted };
    let designs = if limit.is_some() { ROUNDS.saturating_add(1) } else { 1 };
    let (mut done, mut round) = (0u16, 0u16);
    // Passes and shares of one design among those of all.
    let mut uncorrected = Offset::ZERO;
    let mut tell = |round: u16, before: u16, done: &mut u16, step: DesignStep<'_>| match step {
        DesignStep::Uncorrected(walls) if round == 0 => {
            uncorrected = worst(&free, machine.path, walls);
            observe(DesignStep::Uncorrected(walls));
        }
        DesignStep::Uncorrected(_) => (),
        DesignStep::Done { passes, permille } => {
            *done = before.saturating_add(passes);
            let share = round.saturating_mul(1000).saturating_add(permille).checked_div(designs).unwrap_or(0);
            observe(DesignStep::Done { passes: *done, permille: share });
        }
    };
    workspace.profiles.fill(Profile::default());
    let mut passage = design_observed(machine, &free, made.nodes, made.predicted, workspace, &mut |step| {
        tell(0, 0, &mut done, step);
    });
    copy(made.nodes, made.unguarded);
    while let Some(limit) = limit
        && round < ROUNDS
    {
        round = round.saturating_add(1);
        margins(machine, belief, wanted, made.nodes, workspace);
        // The walls of the correction itself, beside the margins.
        passage = pass(machine, wanted, made.nodes, workspace, &mut |_| ());
        if workspace.profiles.iter().all(|p| missed(p, limit) <= MISSED) {
            break;
        }
        let before = done;
        passage = design_observed(machine, wanted, made.nodes, made.predicted, workspace, &mut |step| {
            tell(round, before, &mut done, step);
        });
    }
    made.damped = None;
    if wanted.law == Law::Model {
        let both = [&mut *made.nodes, &mut *made.unguarded];
        made.damped = damp(machine, belief, wanted, uncorrected, both, workspace);
        passage = pass(machine, wanted, made.nodes, workspace, &mut |_| ());
    }
    for _ in 0..LIFTS {
        let Some(limit) = limit else { break };
        if workspace.profiles.iter().all(|p| missed(p, limit) == Offset::ZERO) {
            break;
        }
        lift(machine, limit, made.nodes, workspace);
        passage = pass(machine, wanted, made.nodes, workspace, &mut |_| ());
    }
    for (p, wall) in made.predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.after = *wall;
    }
    passage
}

/// By how much a wall lies deeper than the guard and its margin allow.
fn missed(wall: &Profile, limit: Offset) -> Offset {
    if wall.on_wall { (wall.margin() - limit - wall.deepest()).max(Offset::ZERO) } else { Offset::ZERO }
}

/// Takes the cutter back from the wall where it was deeper than allowed, at the positions that made it so, and less and
/// less beside them. What it no longer cuts bends it less: half as much again is taken back.
fn lift(machine: &Loop, limit: Offset, nodes: &mut [Node], workspace: &mut DesignWorkspace) {
    let amount = |slot: &Node| slot.chip.x;
    workspace.best.fill(Node::default());
    for (index, wall) in workspace.profiles.iter().enumerate() {
        let back = missed(wall, limit).scaled(Real::ratio(3, 2));
        if back == Offset::ZERO {
            continue;
        }
        for maker in wall.makers(index).chain([index]) {
            if let Some(slot) = workspace.best.get_mut(maker) {
                slot.chip.x = amount(slot).max(back);
            }
        }
    }
    let carry = |carried: Offset, slot: &mut Node| {
        slot.chip.x = amount(slot).max(carried - SLOPE);
        amount(slot)
    };
    workspace.best.iter_mut().fold(Offset::ZERO, carry);
    workspace.best.iter_mut().rev().fold(Offset::ZERO, carry);
    let samples = machine.path.samples().iter().skip(machine.path.first());
    for ((node, slot), sample) in nodes.iter_mut().zip(workspace.best.iter()).zip(samples) {
        node.chip = node.chip - sample.normal.times(amount(slot));
    }
    settle_ends(machine.path, nodes);
}

/// Sets the margin of every wall to [`GUARD_SIGMAS`] standard deviations of its deepest height.
fn margins(machine: &Loop, belief: (&Prior, &Fit), wanted: &Design, nodes: &[Node], workspace: &mut DesignWorkspace) {
    pass(machine, wanted, nodes, workspace, &mut |_| ());
    // Between two designs the best correction is of no use: its place holds (deepest, its standard deviation).
    let best = core::mem::take(&mut workspace.best);
    for (slot, wall) in best.iter_mut().zip(workspace.profiles.iter()) {
        *slot = Node { chip: Vector { x: wall.deepest(), y: Offset::ZERO }, edge: Vector::ZERO };
    }
    spread(machine, belief, wanted, nodes, workspace, &mut |index, wall| {
        if let Some(slot) = best.get_mut(index) {
            slot.chip.y = hypot_nm(slot.chip.y, wall.deepest() - slot.chip.x);
        }
    });
    for (wall, slot) in workspace.profiles.iter_mut().zip(best.iter()) {
        wall.set_margin(slot.chip.y.scaled(Real::from_int(GUARD_SIGMAS)));
    }
    workspace.best = best;
}
