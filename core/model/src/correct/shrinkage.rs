//! Shrinkage: where the points say too little about the wall, only a share of its correction is applied.
//!
//! A correction of `d` makes a wall worse whose true error is less than `d/2`: where the error is known to a quarter of
//! itself that takes two standard deviations, where it is known to no more than its own size it often comes so. Every
//! sample is therefore corrected by the share `(B/σ − 1)/2`, between nothing and all of it: `B` is the largest error of
//! the uncorrected wall, `σ` the standard deviation of the wall beside the sample. `B` stands for the whole part, so that
//! a wall whose own error is small is still corrected as long as it is known well beside the largest. The ends are from
//! random machines: where `B` is more than 3σ, most corrections by the whole came out several times better, and damping
//! them costs more than it saves; a wall that is known to no better than the largest error is left alone. `σ` is that of the fit's
//! parameters and, where a caller knows it, of what is beside the model. Limits: a share makes the wall better with more certainty,
//! but by less.

use super::node::Node;
use super::refine::settle_ends;
use super::scratch::{Doubt, Scratch};
use crate::cut::Path;
use truepath_units::{Offset, Real, hypot_nm};

/// Standard deviations of the wall that the largest error has to outweigh for a whole correction.
const SIGMAS: i32 = 3;
/// How much less these may become from sample to sample: a correction of the size of the largest error then changes by at
/// most twice that, and no step remains in the path.
const SLOPE: Offset = Offset::from_nm(500);

/// Where a correction is applied in part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Damped {
    /// The least share of it that is applied, 0…1.
    pub least: Real,
    /// Standard deviation of the wall there.
    pub sigma: Offset,
    /// First sample of the stretch around that place, counted along the contour.
    pub from: usize,
    /// Its last sample.
    pub to: usize,
}

/// Damps a correction, and the one without guard beside it, where its wall is known badly beside the largest error of the
/// uncorrected wall. `slots` hold the [deviations](super::uncertainty::deviations) of the wall and are overwritten; `beside` are those of
/// what is beside the model, or empty.
pub(super) fn damp(
    path: &Path,
    uncorrected: Offset,
    [nodes, unguarded]: [&mut [Node]; 2],
    slots: &mut [Scratch],
    beside: &[Offset],
) -> Option<Damped> {
    let samples = path.samples().iter().skip(path.first());
    let beside = beside.iter().copied().chain(core::iter::repeat(Offset::ZERO));
    for ((slot, sample), beside) in slots.iter_mut().zip(samples).zip(beside) {
        // Around a sharp inside corner the correction is no larger than beside it, or spares the wall.
        let sigma = if sample.near_corner { Offset::ZERO } else { hypot_nm(slot.deviation().aimed, beside) };
        *slot = Doubt { outweighed: sigma.scaled(Real::from_int(SIGMAS)), sigma }.into();
    }
    Scratch::envelope(slots, SLOPE, path.is_closed());
    let damped = stretch(slots, uncorrected);
    if damped.is_some() {
        for nodes in [nodes, unguarded] {
            for (node, slot) in nodes.iter_mut().zip(slots.iter()) {
                let share = share(slot.doubt(), uncorrected);
                *node = Node { chip: node.chip.scaled(share), edge: node.edge.scaled(share) };
            }
            settle_ends(path, nodes);
        }
    }
    damped
}

/// The share of a correction that is applied.
fn share(doubt: Doubt, uncorrected: Offset) -> Real {
    if doubt.outweighed <= uncorrected {
        return Real::ONE;
    }
    let known = uncorrected.over(doubt.outweighed) * Real::from_int(SIGMAS);
    ((known - Real::ONE) * Real::HALF).max(Real::ZERO)
}

/// The stretch around the place where least is applied, if it is not everything.
fn stretch(slots: &[Scratch], uncorrected: Offset) -> Option<Damped> {
    let doubts = || slots.iter().map(|slot| slot.doubt());
    let partly = |doubt: &Doubt| doubt.outweighed > uncorrected;
    let (at, worst) = doubts().enumerate().filter(|(_, d)| partly(d)).max_by_key(|(_, doubt)| doubt.outweighed)?;
    let before = doubts().take(at).rev().take_while(partly).count();
    let behind = doubts().skip(at).take_while(partly).count();
    Some(Damped {
        least: share(worst, uncorrected),
        sigma: worst.sigma,
        from: at.saturating_sub(before),
        to: at.saturating_add(behind).saturating_sub(1),
    })
}
