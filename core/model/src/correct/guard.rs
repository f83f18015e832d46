//! The gouge guard: what a part may lose at most, whatever the target asks for.
//!
//! The target says where the wall should lie; the guard forbids a correction with which it may end deeper than
//! `max_gouge` at any height of the engaged depth. May: the deepest height, predicted, less three of its standard
//! deviations. These follow from the fit and the correction, so the contour is first designed without guard; where that
//! goes too deep it is designed again with three standard deviations kept free beside every sample, and once more when
//! these have changed. What a design leaves of it is taken back at the places. Limits: the standard deviation is that of the fit's parameters; a sharp inside corner, where the
//! correction never goes nearer to the wall than beside it, is not guarded; the laws kept for comparison know no guard.

use super::design::{Design, DesignStep, DesignWorkspace, Law, Predicted, copy, design, pass, worst};
use super::node::Node;
use super::profile::Profile;
use super::reader::{Again, WallReader};
use super::refine::settle_ends;
use super::scratch::Scratch;
use super::shrinkage::{Damped, damp};
use super::uncertainty::deviations;
use crate::cut::{Loop, Passage};
use crate::identify::{Fit, Prior};
use truepath_units::{Offset, Real};

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
    /// Standard deviation of the error the target aims at, with the correction; as long as `nodes`, or empty.
    pub sigma: &'a mut [Offset],
    /// Where only a share of it is applied, if anywhere; set by the design.
    pub damped: Option<Damped>,
}

/// Whether the standard deviations computed last are those of the correction as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deviations {
    Current,
    Stale,
}

/// As [`design`], under the guard of the design. Without guard the two are the same. On return
/// `workspace.profiles` holds the corrected wall and the margins the guard has kept. By [`Law::Model`] a wall that is known
/// too badly is corrected in part; what the guard forbids, it forbids of that as well.
pub fn guarded_design(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    made: &mut Guarded<'_>,
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
    observe: &mut dyn FnMut(DesignStep<'_>),
) -> Passage {
    let limit = limit(wanted);
    let free = Design { max_gouge: None, ..*wanted };
    let designs = if limit.is_some() { ROUNDS.saturating_add(1) } else { 1 };
    let (mut done, mut round) = (0u16, 0u16);
    // Passes and shares of one design among those of all.
    let mut uncorrected = Offset::ZERO;
    let mut tell = |round: u16, before: u16, done: &mut u16, step: DesignStep<'_>| match step {
        DesignStep::Uncorrected(walls) if round == 0 => {
            [uncorrected, _] = worst(&free, machine.path, walls);
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
    let mut passage = design(machine, &free, made.nodes, made.predicted, workspace, &mut |step| {
        tell(0, 0, &mut done, step);
    });
    copy(made.nodes, made.unguarded);
    let mut state = Deviations::Stale;
    while let Some(limit) = limit
        && round < ROUNDS
    {
        round = round.saturating_add(1);
        if round == 1 {
            passage = pass(machine, wanted, made.nodes, (workspace, Again::Afresh), &mut |_| ());
        }
        margins(machine, belief, wanted, workspace);
        state = Deviations::Current;
        if workspace.profiles.iter().all(|p| missed(p, limit) <= MISSED) {
            break;
        }
        let before = done;
        passage = design(machine, wanted, made.nodes, made.predicted, workspace, &mut |step| {
            tell(round, before, &mut done, step);
        });
        state = Deviations::Stale;
    }
    made.damped = None;
    if wanted.law == Law::Model {
        if state == Deviations::Stale {
            deviations(machine, belief, wanted, workspace);
        }
        hand_out(workspace.scratch, made.sigma);
        let both = [&mut *made.nodes, &mut *made.unguarded];
        made.damped = damp(machine.path, uncorrected, both, workspace.scratch, workspace.beside_sigma);
        state = if made.damped.is_none() { Deviations::Current } else { Deviations::Stale };
        if state == Deviations::Stale {
            passage = pass(machine, wanted, made.nodes, (workspace, Again::AsBefore), &mut |_| ());
        }
    }
    finish(machine, belief, wanted, (state, passage), made, workspace)
}

/// A correction that is given instead of designed, under the guard of `wanted` as the fit knows the machine now: where
/// it would go too deep it is taken back. On return as after [`guarded_design`]; the target alone wants what was given.
pub fn guarded_given(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    given: &[Node],
    made: &mut Guarded<'_>,
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
) -> Passage {
    made.damped = None;
    workspace.profiles.fill(Profile::default());
    made.nodes.fill(Node::default());
    pass(machine, wanted, made.nodes, (workspace, Again::Afresh), &mut |_| ());
    for (p, before) in made.predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.before = *before;
    }
    copy(given, made.nodes);
    copy(given, made.unguarded);
    let passage = pass(machine, wanted, made.nodes, (workspace, Again::AsBefore), &mut |_| ());
    let mut state = Deviations::Stale;
    if limit(wanted).is_some() {
        margins(machine, belief, wanted, workspace);
        state = Deviations::Current;
        hand_out(workspace.scratch, made.sigma);
    }
    finish(machine, belief, wanted, (state, passage), made, workspace)
}

/// The guard of a design: other laws than the model's heed none.
fn limit(wanted: &Design) -> Option<Offset> {
    wanted.max_gouge.filter(|_| wanted.law == Law::Model)
}

/// Takes back what the guard forbids of the correction whose walls the workspace holds, and says what remains.
/// Its standard deviations may be known already.
fn finish(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    (mut state, mut passage): (Deviations, Passage),
    made: &mut Guarded<'_>,
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
) -> Passage {
    for _ in 0..LIFTS {
        let Some(limit) = limit(wanted) else { break };
        if workspace.profiles.iter().all(|p| missed(p, limit) == Offset::ZERO) {
            break;
        }
        lift(machine, limit, made.nodes, workspace);
        passage = pass(machine, wanted, made.nodes, (workspace, Again::AsBefore), &mut |_| ());
        state = Deviations::Stale;
    }
    for (p, wall) in made.predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.after = *wall;
    }
    if state == Deviations::Stale && !made.sigma.is_empty() {
        deviations(machine, belief, wanted, workspace);
        hand_out(workspace.scratch, made.sigma);
    }
    passage
}

/// Hands out the deviations of the aimed error.
fn hand_out(slots: &[Scratch], sigma: &mut [Offset]) {
    for (sigma, slot) in sigma.iter_mut().zip(slots) {
        *sigma = slot.deviation().aimed;
    }
}

/// By how much a wall lies deeper than the guard and its margin allow.
fn missed(wall: &Profile, limit: Offset) -> Offset {
    if wall.on_wall { (wall.margin() - limit - wall.deepest()).max(Offset::ZERO) } else { Offset::ZERO }
}

/// Takes the cutter back from the wall where it was deeper than allowed, at the positions that made it so, and less and
/// less beside them. What it no longer cuts bends it less: half as much again is taken back.
fn lift(machine: &Loop, limit: Offset, nodes: &mut [Node], workspace: &mut DesignWorkspace<'_, impl WallReader>) {
    workspace.scratch.fill(Scratch::default());
    for (index, wall) in workspace.profiles.iter().enumerate() {
        let back = missed(wall, limit).scaled(Real::ratio(3, 2));
        if back == Offset::ZERO {
            continue;
        }
        for maker in wall.makers(index).chain([index]) {
            if let Some(amount) = workspace.scratch.get_mut(maker).map(Scratch::length) {
                *amount = (*amount).max(back);
            }
        }
    }
    Scratch::envelope(workspace.scratch, SLOPE, false);
    let samples = machine.path.samples().iter().skip(machine.path.first());
    for ((node, slot), sample) in nodes.iter_mut().zip(workspace.scratch.iter_mut()).zip(samples) {
        node.chip = node.chip - sample.normal.times(*slot.length());
    }
    settle_ends(machine.path, nodes);
}

/// Sets the margin of every wall to [`GUARD_SIGMAS`] standard deviations of its deepest height. The workspace holds states and walls of
/// the correction, and its [`deviations`] as well afterwards.
fn margins(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
) {
    deviations(machine, belief, wanted, workspace);
    for (wall, slot) in workspace.profiles.iter_mut().zip(workspace.scratch.iter()) {
        wall.set_margin(slot.deviation().deepest.scaled(Real::from_int(GUARD_SIGMAS)));
    }
}
