//! From the identified machine to the correction beside every sample of the contour.

use super::paper::PaperTransfer;
use super::profile::{Band, Profile, Target, profile};
use crate::cut::{ForceTable, Loop, Passage, State};
use crate::geometry::Vector;
use crate::identify::{Fit, Prior};
use crate::units::{Offset, Real};

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

/// The correction at one sample of the contour, in its two parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// The part that scales with the live feed per tooth.
    pub chip: Vector,
    /// The part that does not.
    pub edge: Vector,
}

impl Node {
    /// The correction at the programmed feed.
    pub fn total(&self) -> Vector {
        self.chip + self.edge
    }
}

/// Wall errors beside one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Predicted {
    /// Without correction.
    pub before: Profile,
    /// With it.
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
    /// The deepest cut allowed at any height of the band.
    pub max_gouge: Option<Offset>,
}

/// What one refinement does to a cutter position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Update {
    sum: Offset,
    count: u32,
}

impl Update {
    fn mean(&self) -> Offset {
        self.sum.scaled(Real::ratio(1, i64::from(self.count.max(1))))
    }
}

/// Buffers lent by the caller: `states` and `displacements` as long as the path's working range, `profiles` and
/// `updates` as long as the contour's own samples.
#[derive(Debug)]
pub struct DesignWorkspace<'a> {
    /// States of the elastic loop.
    pub states: &'a mut [State],
    /// Cutter positions at a height.
    pub displacements: &'a mut [Vector],
    /// Wall profiles.
    pub profiles: &'a mut [Profile],
    /// Changes of the correction.
    pub updates: &'a mut [Update],
}

/// Refinements on the predicted wall error.
const REFINEMENTS: usize = 24;
/// The largest wall error at which refinement stops early.
const SETTLED: Offset = Offset::from_nm(200);
/// Refinements without a tenth of improvement after which it stops: what is left cannot be reached by this cutter.
const PATIENCE: usize = 5;

/// The commanded displacement at a sample of the path: the correction of the contour, held beyond its ends.
fn commanded(nodes: &[Node], first: usize, index: usize) -> Vector {
    let last = nodes.len().saturating_sub(1);
    nodes.get(index.saturating_sub(first).min(last)).map_or(Vector::ZERO, Node::total)
}

/// Makes the correction: `nodes` and `predicted` as long as the contour's own samples.
/// Returns the summary of the last pass of the elastic loop.
pub fn design(
    machine: &Loop,
    wanted: &Design,
    nodes: &mut [Node],
    predicted: &mut [Predicted],
    workspace: &mut DesignWorkspace,
) -> Passage {
    let path = machine.path;
    let (first, from) = (path.first(), path.working().start);
    nodes.fill(Node::default());
    let mut passage = machine.run(from, workspace.states, |_| Vector::ZERO);
    profile(machine, workspace.states, wanted.band, workspace.displacements, workspace.profiles);
    for (p, before) in predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.before = *before;
    }
    match wanted.law {
        Law::Model => one_shot(machine, wanted.band, nodes, false, workspace.states),
        Law::Mirror => one_shot(machine, wanted.band, nodes, true, workspace.states),
        Law::Paper(transfer) => transfer.fill(machine, workspace.states, nodes),
    }
    let (mut best, mut since_best) = (Offset::MAX, 0usize);
    for refinement in 0..=REFINEMENTS {
        passage = machine.run(from, workspace.states, |i| commanded(nodes, first, i));
        profile(machine, workspace.states, wanted.band, workspace.displacements, workspace.profiles);
        if wanted.law != Law::Model || refinement == REFINEMENTS {
            break;
        }
        let largest = worst(wanted, workspace.profiles);
        since_best = if largest < best.scaled(Real::ratio(9, 10)) { 0 } else { since_best.saturating_add(1) };
        best = best.min(largest);
        if largest < SETTLED || since_best > PATIENCE {
            break;
        }
        refine(machine, wanted, nodes, workspace);
    }
    for (p, after) in predicted.iter_mut().zip(workspace.profiles.iter()) {
        p.after = *after;
    }
    passage
}

/// −(mean deflection over the band): at the nominal engagement, or at that of the uncorrected cut (mirror).
fn one_shot(machine: &Loop, band: Band, nodes: &mut [Node], mirror: bool, uncorrected: &[State]) {
    let path = machine.path;
    let skipped = path.first().saturating_sub(path.working().start);
    let heights = super::profile::HEIGHTS;
    let mut chip_scale = (None, Real::ZERO);
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
        for k in 0..heights {
            let (c, w) = machine.deflection_parts(&state, band.at(k));
            chip = chip + c;
            whole = whole + w;
        }
        let mean = |v: Vector| -v.scaled(Real::ratio(1, heights));
        let chip = mean(chip);
        *node = Node { chip, edge: mean(whole) - chip };
    }
}

/// One refinement: every cutter position moves along the normal by the mean error of the wall places it made (over
/// samples and heights); positions that made none follow their neighbours.
fn refine(machine: &Loop, wanted: &Design, nodes: &mut [Node], workspace: &mut DesignWorkspace) {
    let updates = &mut *workspace.updates;
    updates.fill(Update::default());
    for (index, profile) in workspace.profiles.iter().enumerate() {
        let error = profile.aim(wanted.target, wanted.max_gouge);
        for maker in profile.makers(index) {
            if let Some(update) = updates.get_mut(maker) {
                update.sum += error;
                update.count = update.count.saturating_add(1);
            }
        }
    }
    fill_gaps(updates);
    let samples = machine.path.samples().iter().skip(machine.path.first());
    for ((node, update), sample) in nodes.iter_mut().zip(updates.iter()).zip(samples) {
        // The refinement follows the chip: it comes from the change of load along the path.
        node.chip = node.chip + sample.normal.times(update.mean());
    }
}

/// The largest error the target sees.
fn worst(wanted: &Design, profiles: &[Profile]) -> Offset {
    profiles.iter().map(|p| p.aim(wanted.target, wanted.max_gouge).abs()).max().unwrap_or_default()
}

/// Gives updates that have no wall of their own the straight line between their neighbours'.
fn fill_gaps(updates: &mut [Update]) {
    let mut at = 0usize;
    while at < updates.len() {
        let gap = updates.iter().skip(at).take_while(|u| u.count == 0).count();
        if gap > 0 {
            let before = at.checked_sub(1).and_then(|i| updates.get(i)).map(Update::mean);
            let after = updates.get(at.saturating_add(gap)).map(Update::mean);
            let (from, to) = (before.or(after).unwrap_or_default(), after.or(before).unwrap_or_default());
            for (k, slot) in updates.iter_mut().skip(at).take(gap).enumerate() {
                let u = Real::ratio(k.saturating_add(1) as i64, gap.saturating_add(1) as i64);
                *slot = Update { sum: from + (to - from).scaled(u), count: 1 };
            }
        }
        at = at.saturating_add(gap).saturating_add(1);
    }
}

/// Standard deviation of the corrected wall error beside each sample, from the covariance of the fit.
///
/// The machine is displaced along each column of a square root of the covariance and cut again with the correction
/// held; the squares add up. `workspace.profiles` must hold the corrected wall ([`design`] leaves it so) and is
/// overwritten; `sigma` is as long as the contour's own samples.
pub fn uncertainty(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    nodes: &[Node],
    predicted: &[Predicted],
    sigma: &mut [Offset],
    workspace: &mut DesignWorkspace,
) {
    let (prior, fit) = belief;
    let path = machine.path;
    sigma.fill(Offset::ZERO);
    let mut table = machine.table.clone();
    for column in crate::identify::square_root(&fit.covariance) {
        if column.iter().all(|v| v.abs() < Real::ratio(1, 1000)) {
            continue;
        }
        let mut moved = fit.theta;
        for (t, c) in moved.iter_mut().zip(&column) {
            *t += *c;
        }
        let parameters = prior.at(&moved);
        if parameters.coefficients.size_exponent != table.size_exponent() {
            table = ForceTable::new(parameters.coefficients.size_exponent);
        }
        let displaced =
            Loop { path, table: &table, coefficients: parameters.coefficients, compliance: parameters.compliance };
        displaced.run(path.working().start, workspace.states, |i| commanded(nodes, path.first(), i));
        profile(&displaced, workspace.states, wanted.band, workspace.displacements, workspace.profiles);
        for ((s, p), base) in sigma.iter_mut().zip(workspace.profiles.iter()).zip(predicted) {
            let change = p.aim(wanted.target, None) - base.after.aim(wanted.target, None);
            *s = crate::units::hypot_nm(*s, change);
        }
    }
}
