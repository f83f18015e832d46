//! Round the circle from lead to lead.

use std::f64::consts::TAU;

use super::passes::Passes;
use super::refusal::Refusal;
use super::takeover::{Steps, takeover};

/// A stretch of wall left by one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins, rad; ascending from stretch to stretch, over one turn in all.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Index of the pass.
    pub pass: usize,
    /// Place of the pass's crest, rad, within half a turn of the stretch.
    pub crest: f64,
}

/// The passes round and round: index `i + count` is pass `i` one turn later.
pub(super) struct Round<'a> {
    passes: &'a Passes,
    steps: Steps,
}

impl<'a> Round<'a> {
    /// For at most so many steps of comparison.
    pub(super) fn new(passes: &'a Passes, most: u64) -> Self {
        Self { passes, steps: Steps::new(most) }
    }
    /// The stretches from the crest of pass `start` until pass `last` takes the lead; both of the longest edge, so that they
    /// lead at their crests.
    pub(super) fn sweep(mut self, start: i64, last: i64) -> Result<Vec<Stretch>, Refusal> {
        let mut stretches = Vec::with_capacity((last - start).max(0) as usize);
        let (mut leader, mut from) = (start, self.crest(start));
        for _ in 0..8 * self.count() + 16 {
            let (to, next) = self.next_leader(leader, from)?;
            if to > from || leader == start {
                stretches.push(Stretch { from, to, pass: self.pass(leader), crest: self.crest(leader) });
            }
            if next == last {
                return Ok(stretches);
            }
            (leader, from) = (next, to);
        }
        Err(Refusal::Unfinished)
    }
    fn count(&self) -> i64 {
        self.passes.passes.len() as i64
    }
    fn pass(&self, index: i64) -> usize {
        index.rem_euclid(self.count()) as usize
    }
    fn crest(&self, index: i64) -> f64 {
        self.passes.passes[self.pass(index)].crest + TAU * index.div_euclid(self.count()) as f64
    }
    /// Who takes the lead from `leader` behind `from`, and where.
    fn next_leader(&mut self, leader: i64, from: f64) -> Result<(f64, i64), Refusal> {
        if self.passes.arcs.len() == 1 {
            return Ok((0.5 * (self.crest(leader) + self.crest(leader + 1)), leader + 1));
        }
        let mut steps = self.steps;
        let (own, reach, count) = (self.crest(leader), self.passes.reach, self.count());
        let number = |index: i64| self.passes.passes[self.pass(index)].arc;
        let arc = |index: i64| &self.passes.arcs[number(index)];
        // A pass matters within its reach of its crest.
        let near = |j: &i64| self.crest(*j) <= own + 2.0 * reach * (1.0 + 1e-9);
        let forward = (leader + 1..=leader + count).take_while(near);
        let back = (leader - count..leader).rev().take_while(|j| self.crest(*j) >= from - reach);
        let (mut end, mut next) = (own + reach, None);
        for j in forward.chain(back) {
            let other = self.crest(j);
            let found = if number(j) == number(leader) {
                steps.take()?;
                (other > own).then(|| (0.5 * (own + other)).max(from))
            } else {
                let range = (from.max(other - reach), end.min(other + reach));
                takeover((arc(leader), own), (arc(j), other), range, &mut steps)?
            };
            if let Some(place) = found.filter(|place| *place < end || next.is_none()) {
                (end, next) = (place.min(end), Some(j));
            }
        }
        // At the end of the leader's reach another is at least as far out; when rounding hides which, the farthest.
        let next = next.unwrap_or_else(|| {
            let wall = |j: i64| arc(j).wall(end - self.crest(j)).0;
            let ahead = (leader + 1..=leader + count).take_while(near);
            ahead.max_by(|a, b| wall(*a).total_cmp(&wall(*b))).unwrap_or(leader + 1)
        });
        self.steps = steps;
        Ok((end, next))
    }
}
