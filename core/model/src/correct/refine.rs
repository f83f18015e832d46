//! Refinement of a correction on the predicted wall error, and where it is not refined.

use super::corner;
use super::node::Node;
use super::profile::{Profile, Target};
use crate::cut::Path;
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// What one refinement does to a cutter position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Update {
    pub(crate) sum: Offset,
    pub(crate) count: u32,
}

impl Update {
    pub(crate) fn mean(&self) -> Offset {
        self.sum.scaled(Real::ratio(1, i64::from(self.count.max(1))))
    }
}

/// One refinement: every cutter position moves along the normal by the mean error of the wall places it made (over
/// samples and heights); positions that made none follow their neighbours. What stays in a sharp inside corner, where the wall turns on
/// the spot, asks for nothing: no position reaches it that does not cut into a wall beside it.
pub(super) fn refine(
    path: &Path,
    (target, max_gouge): (Target, Option<Offset>),
    nodes: &mut [Node],
    profiles: &[Profile],
    updates: &mut [Update],
) {
    updates.fill(Update::default());
    for (index, profile) in profiles.iter().enumerate() {
        if path.is_pivot(path.first().saturating_add(index)) {
            continue;
        }
        let error = profile.aim(target, max_gouge);
        for maker in profile.makers(index) {
            if let Some(update) = updates.get_mut(maker) {
                update.sum += error;
                update.count = update.count.saturating_add(1);
            }
        }
    }
    fill_gaps(updates);
    // Beside tight inside corners the tooth that makes the wall changes from height to height, and positions next to each other
    // are asked for different things: unsmoothed, the path would come to zigzag where the wall does not see it and the drives do.
    // Where a guard begins, more of it.
    let times = if max_gouge.is_some() { SMOOTHED } else { 1 };
    (0..times).for_each(|_| smooth(updates));
    let samples = path.samples().iter().skip(path.first());
    for ((node, update), sample) in nodes.iter_mut().zip(updates.iter()).zip(samples) {
        // The refinement follows the chip: it comes from the change of load along the path.
        node.chip = node.chip + sample.normal.times(update.mean());
    }
}

/// Times that updates are smoothed under a guard: over about the length on which a circle leaves its tangent by a micrometre.
pub(crate) const SMOOTHED: usize = 3;

/// Every update becomes half of itself and a quarter of either neighbour; at the ends nothing comes from beyond.
pub(crate) fn smooth(updates: &mut [Update]) {
    let mut before: Option<Offset> = None;
    for at in 0..updates.len() {
        let behind = updates.get(at.saturating_add(1)).map(Update::mean);
        let Some(slot) = updates.get_mut(at) else { break };
        let own = slot.mean();
        let sum = own + own + before.unwrap_or(own) + behind.unwrap_or(own);
        *slot = Update { sum: sum.scaled(Real::ratio(1, 4)), count: 1 };
        before = Some(own);
    }
}

/// Gives updates that have no wall of their own the straight line between their neighbours'.
pub(crate) fn fill_gaps(updates: &mut [Update]) {
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

/// Closes a closed correction, turns it round outside corners from that of one leg to that of the other, and leads it through
/// sharp inside corners ([`corner`]).
pub(crate) fn settle_ends(path: &Path, nodes: &mut [Node]) {
    round_corners(path, nodes);
    close(path, nodes);
    corner::turn(path, nodes);
    close(path, nodes);
}

/// A closed correction ends as it begins.
fn close(path: &Path, nodes: &mut [Node]) {
    if path.is_closed()
        && let Some(&first) = nodes.first()
        && let Some(last) = nodes.last_mut()
    {
        *last = first;
    }
}

/// Round an outside corner the cutter makes no wall: from the end of one leg to the start of the other the correction
/// goes over smoothly. At an end of the contour it is held.
fn round_corners(path: &Path, nodes: &mut [Node]) {
    let samples = path.samples().get(path.first()..).unwrap_or_default();
    let count = nodes.len().min(samples.len());
    let rounds = |i: usize| samples.get(i).is_some_and(|s| s.rounds_corner);
    let run = |from: usize| (from..count).take_while(|i| rounds(*i)).count();
    if count == 0 || run(0) == count {
        return;
    }
    // Of a closed contour a corner may lie across its seam: its last sample is its first.
    let tail = (0..count).rev().take_while(|i| path.is_closed() && rounds(*i)).count();
    let mut at = 0usize;
    while at < count {
        let zone = run(at);
        let end = at.saturating_add(zone);
        if zone > 0 {
            let wraps = path.is_closed() && (at == 0 || end == count);
            let (from, to) = if wraps {
                (count.saturating_sub(tail).checked_sub(1), Some(run(0)))
            } else {
                (at.checked_sub(1), Some(end).filter(|end| *end < count))
            };
            let known = |i: Option<usize>| Some((samples.get(i?)?.s, *nodes.get(i?)?));
            let legs = [known(from).or(known(to)), known(to).or(known(from))];
            if let [Some((begin, first)), Some((stop, last))] = legs {
                let turn = if stop < begin { path.length() } else { Offset::ZERO };
                for (node, sample) in nodes.iter_mut().zip(samples).take(end).skip(at) {
                    let before_seam = sample.s >= begin;
                    let way = sample.s - begin + if before_seam { Offset::ZERO } else { turn };
                    *node = blend(first, last, way.over(stop + turn - begin));
                }
            }
        }
        at = end.saturating_add(1);
    }
}

/// From one correction to another, with neither kink at the ends, at a share 0…1 of the way.
fn blend(from: Node, to: Node, way: Real) -> Node {
    let u = way.max(Real::ZERO).min(Real::ONE);
    let share = u * u * (Real::from_int(3) - u - u);
    let mix = |a: Vector, b: Vector| a + (b - a).scaled(share);
    Node { chip: mix(from.chip, to.chip), edge: mix(from.edge, to.edge) }
}
