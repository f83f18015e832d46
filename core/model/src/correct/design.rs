//! From the identified machine to the correction beside every sample of the contour.

use super::moved::Moved;
use super::node::{Node, commanded};
use super::paper::PaperTransfer;
use super::profile::{Band, HEIGHTS, Profile, Target, add_residual, deepen};
use super::reader::{Again, InOrder, WallReader};
use super::refine::{Update, refine, settle_ends};
use super::scratch::Scratch;
use crate::cut::{Loop, Passage, Path, State, Teeth};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// How the correction is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// From the model at the nominal engagement, refined on the predicted wall error.
    Model,
    /// First-order mirror: the deflection of the uncorrected cut, reversed. Leaves about δ²/h on a straight wall.
    Mirror,
    /// P23 eqs. (8)–(12) as printed; depends on the origin of the program.
    Paper(PaperTransfer),
}

/// Wall errors beside one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Predicted {
    /// The error without correction.
    pub before: Profile,
    /// The error with the correction.
    pub after: Profile,
}

/// What the correction is to achieve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Design {
    /// How it is made.
    pub law: Law,
    /// What it brings to zero.
    pub target: Target,
    /// Heights that count.
    pub band: Band,
    /// The deepest cut allowed at any height of the engaged depth.
    pub max_gouge: Option<Offset>,
}

/// Buffers lent by the caller: `states` and `displacements` as long as the path's working range, `profiles`,
/// `updates` and `scratch` as long as the contour's own samples.
#[derive(Debug)]
pub struct DesignWorkspace<'a, R = InOrder> {
    /// States of the elastic loop.
    pub states: &'a mut [State],
    /// Cutter positions at a height.
    pub displacements: &'a mut [Vector],
    /// Wall profiles.
    pub profiles: &'a mut [Profile],
    /// Changes of the correction.
    pub updates: &'a mut [Update],
    /// The best correction so far, and what else is needed for a while.
    pub scratch: &'a mut [Scratch],
    /// Wall error that parts have shown beside what the model predicts, as long as the contour's own samples; empty where
    /// none is known. The correction cancels it as well.
    pub residual: &'a [Offset],
    /// Standard deviation of the wall by what is beside the model, which the fit's parameters do not have, as long as the contour's own
    /// samples; empty where none is known.
    pub beside_sigma: &'a [Offset],
    /// Who reads the walls.
    pub reader: R,
}

/// Refinements on the predicted wall error.
const REFINEMENTS: usize = 24;
/// The largest wall error at which refinement stops early.
const SETTLED: Offset = Offset::from_nm(200);
/// Refinements without a tenth of improvement after which it stops: what is left cannot be reached by this cutter.
const PATIENCE: usize = 8;

/// What a design tells while it works.
#[derive(Clone, Copy, Debug)]
pub enum DesignStep<'a> {
    /// The walls that the uncorrected cut leaves, one beside each sample of the contour.
    Uncorrected(&'a [Profile]),
    /// How far it is.
    Done {
        /// Passes of the cutter that are computed.
        passes: u16,
        /// Share of the longest possible design, ‰, rising; a design that settles early ends before 1000.
        permille: u16,
    },
}

/// Makes the correction: `nodes` as long as the contour's own samples, `predicted` as well, or empty where the predictions
/// are not needed one by one.
///
/// Near a sharp inside corner, where the load ends the moment the direction changes, the correction never goes nearer to the
/// wall than that of the straight wall: the cutter springs back there into what it was sent to.
/// `observe` is told what the design does. Returns the summary of the last pass of the elastic loop;
/// `workspace.profiles` then holds the corrected wall.
pub fn design<R: WallReader>(
    machine: &Loop,
    wanted: &Design,
    nodes: &mut [Node],
    predicted: &mut [Predicted],
    workspace: &mut DesignWorkspace<'_, R>,
    observe: &mut dyn FnMut(DesignStep<'_>),
) -> Passage {
    let path = machine.path;
    let mut passes = 0u16;
    let mut pass = |nodes: &[Node], workspace: &mut DesignWorkspace<'_, R>, observe: &mut dyn FnMut(DesignStep<'_>)| {
        let again = if passes == 0 { Again::Afresh } else { Again::AsBefore };
        let passage = pass(machine, wanted, nodes, (workspace, again), &mut |share| {
            observe(DesignStep::Done { passes, permille: permille(passes, share) });
        });
        passes = passes.saturating_add(1);
        observe(DesignStep::Done { passes, permille: permille(passes, 0) });
        passage
    };
    nodes.fill(Node::default());
    pass(nodes, workspace, observe);
    observe(DesignStep::Uncorrected(workspace.profiles));
    for (p, before) in predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.before = *before;
    }
    match wanted.law {
        Law::Model => one_shot(machine, wanted.band, nodes, false, workspace.states),
        Law::Mirror => one_shot(machine, wanted.band, nodes, true, workspace.states),
        Law::Paper(transfer) => transfer.fill(machine, workspace.states, nodes),
    }
    let mut passage = Passage::default();
    let (mut best, mut least, mut is_best) = ([Offset::MAX; 2], Offset::MAX, true);
    let (mut milestone, mut since) = ([Offset::MAX; 2], 0usize);
    for _ in 0..=REFINEMENTS {
        settle_ends(path, nodes);
        passage = pass(nodes, workspace, observe);
        let now = worst(wanted, path, workspace.profiles);
        let [largest, beside] = now;
        let tenth = |now: Offset, before: Offset| now < before.scaled(Real::ratio(9, 10));
        if now.iter().zip(&milestone).any(|(now, before)| tenth(*now, *before)) {
            (milestone, since) = (now, 0);
        } else {
            since = since.saturating_add(1);
        }
        // What stays beside sharp corners decides where the rest is as good.
        let [best_largest, best_beside] = best;
        is_best = if beside == best_beside {
            largest < best_largest
        } else {
            largest + SETTLED < best_largest || (largest <= least + SETTLED && beside < best_beside)
        };
        least = least.min(largest);
        if is_best {
            best = now;
            copy(nodes, workspace.scratch);
        }
        if wanted.law != Law::Model || largest.max(beside) < SETTLED || since > PATIENCE {
            break;
        }
        refine(path, (wanted.target, wanted.max_gouge), nodes, workspace.profiles, workspace.updates);
    }
    // Also where the last was the best: it has been refined since, but not cut.
    copy(workspace.scratch, nodes);
    if !is_best {
        passage = pass(nodes, workspace, observe);
    }
    for (p, after) in predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.after = *after;
    }
    passage
}

pub(super) fn copy<A: Copy + Into<B>, B>(from: &[A], to: &mut [B]) {
    for (slot, node) in to.iter_mut().zip(from) {
        *slot = (*node).into();
    }
}

/// Share of the longest possible design, ‰, after some passes and a share (‰) of the next.
fn permille(passes: u16, share: u16) -> u16 {
    // The uncorrected pass, all refinements, and once more the best.
    const MOST: u32 = REFINEMENTS as u32 + 3;
    let done = u32::from(passes).saturating_mul(1000).saturating_add(u32::from(share));
    (done / MOST).min(1000) as u16
}

/// One pass of the cutter with a correction: states and walls of the workspace, of which those stay that the correction has not changed
/// since the pass before. `observe` is told the share of the elastic loop that is done, ‰.
pub(super) fn pass(
    machine: &Loop,
    wanted: &Design,
    nodes: &[Node],
    (workspace, again): (&mut DesignWorkspace<'_, impl WallReader>, Again),
    observe: &mut dyn FnMut(u16),
) -> Passage {
    let path = machine.path;
    let working = path.working();
    let by_nodes = |index| commanded(path, nodes, index);
    let DesignWorkspace { states, profiles, reader, .. } = workspace;
    let mut all = Moved::default();
    let passage = reader.run(machine, working.start, states, again, by_nodes, &mut |index, moved| {
        all.note(path, index, moved, profiles);
        let done = index.saturating_sub(working.start).saturating_mul(1000);
        observe(done.checked_div(working.len()).unwrap_or(0).min(1000) as u16);
    });
    all.spread(path, profiles);
    walls(machine, wanted, workspace);
    passage
}

/// Reads the walls that are not current off the states of the workspace.
fn walls(machine: &Loop, wanted: &Design, workspace: &mut DesignWorkspace<'_, impl WallReader>) {
    let (states, displacements) = (&*workspace.states, &mut *workspace.displacements);
    workspace.reader.profile(machine, states, wanted.band, displacements, workspace.profiles);
    if wanted.max_gouge.is_some() || wanted.band != Band::WHOLE {
        deepen(machine, states, wanted.band, displacements, workspace.profiles);
    }
    add_residual(workspace.profiles, workspace.residual);
}

/// −(mean deflection over the band): at the nominal engagement, or at that of the uncorrected cut (mirror).
fn one_shot(machine: &Loop, band: Band, nodes: &mut [Node], mirror: bool, uncorrected: &[State]) {
    let path = machine.path;
    let skipped = path.first().saturating_sub(path.working().start);
    let (mut chip_scale, mut teeth) = ((None, Real::ZERO), Teeth::BLANK);
    for (i, node) in nodes.iter_mut().enumerate() {
        let index = path.first().saturating_add(i);
        let state = if mirror {
            uncorrected.get(skipped.saturating_add(i)).copied().unwrap_or(State::REST)
        } else {
            let Some(sample) = path.samples().get(index) else { break };
            if chip_scale.0 != Some(sample.feed) {
                let feed = path.setup().feed_per_tooth(sample.feed);
                chip_scale = (Some(sample.feed), machine.coefficients.chip_scale(feed));
            }
            machine.nominal(index, chip_scale.1)
        };
        let (mut chip, mut whole) = (Vector::ZERO, Vector::ZERO);
        for k in 0..HEIGHTS {
            let (c, w) = machine.deflection_parts(&mut teeth, &state, band.at(k));
            chip = chip + c;
            whole = whole + w;
        }
        let mean = |v: Vector| -v.scaled(Real::ratio(1, HEIGHTS));
        let chip = mean(chip);
        let normal = path.samples().get(index).map_or(Vector::ZERO, |s| s.normal.times(machine.undersize));
        *node = Node { chip, edge: mean(whole) - chip + normal };
    }
}

/// The largest error the target sees away from sharp inside corners, and the deepest beside them: material that is left there
/// stays, and what the wall keeps in the corner itself is nobody's.
pub(super) fn worst(wanted: &Design, path: &Path, profiles: &[Profile]) -> [Offset; 2] {
    let mut worst = [Offset::ZERO; 2];
    for (i, (p, sample)) in profiles.iter().zip(path.samples().iter().skip(path.first())).enumerate() {
        let error = p.aim(wanted.target, wanted.max_gouge);
        let [away, beside] = &mut worst;
        if !sample.near_corner {
            *away = (*away).max(error.abs());
        } else if !path.is_pivot(path.first().saturating_add(i)) {
            *beside = (*beside).max(-error);
        }
    }
    worst
}
