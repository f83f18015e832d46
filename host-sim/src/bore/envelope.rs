//! The profile of the bore: for every ray the pass that cuts farthest out.
//!
//! Not sampled: the profile is the list of stretches led by one pass each, and its crests of material are the exact places
//! where the lead changes. Two passes of teeth of one radius meet midway between their crests, since their curves are
//! symmetric and fall on either side. With runout the curves differ, and the change is searched from the left with steps that
//! a bound of the second derivative proves safe ([`super::takeover`]).

use std::f64::consts::TAU;

use super::passes::{Pass, Passes, around};
use super::refusal::Refusal;
use super::takeover::takeover;

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

/// The profile of one height of the bore.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The passes it is made of.
    pub passes: Passes,
    /// Its stretches.
    pub stretches: Vec<Stretch>,
}

impl Profile {
    /// The profile that passes leave.
    ///
    /// # Errors
    /// [`Refusal::Unfinished`] when a bound of the search is met.
    pub fn of(passes: Passes) -> Result<Self, Refusal> {
        // The longest edge leads where it points at the wall.
        let start = passes.passes.iter().position(|p| p.arc == passes.longest).ok_or(Refusal::Unfinished)? as i64;
        let round = Round { passes: &passes };
        round.check_work()?;
        let last = start + round.count();
        let mut stretches = Vec::with_capacity(passes.passes.len());
        let (mut leader, mut from) = (start, round.crest(start));
        for _ in 0..8 * passes.passes.len() + 16 {
            let (to, next) = round.next_leader(leader, from);
            if to > from || leader == start {
                let pass = round.pass(leader);
                stretches.push(Stretch { from, to, pass, crest: round.crest(leader) });
            }
            if next == last {
                // The first stretch began at its crest; its beginning has now been found one turn later.
                if let Some(first) = stretches.first_mut() {
                    first.from = to - TAU;
                }
                return Ok(Self { passes, stretches });
            }
            (leader, from) = (next, to);
        }
        Err(Refusal::Unfinished)
    }
    /// Radius of the wall on the ray φ, mm, and the pass that cut it.
    pub fn at(&self, phi: f64) -> (f64, &Pass) {
        let first = self.stretches.first().map_or(0.0, |s| s.from);
        let phi = first + around(phi - first);
        let index = self.stretches.partition_point(|s| s.to <= phi).min(self.stretches.len() - 1);
        let stretch = &self.stretches[index];
        let pass = &self.passes.passes[stretch.pass];
        (self.passes.arc(pass).wall(phi - stretch.crest).0, pass)
    }
    /// The crests of material between passes: place in [0, 2π) and radius of the wall, mm.
    pub fn cusps(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.stretches.iter().map(|s| {
            let arc = self.passes.arc(&self.passes.passes[s.pass]);
            (around(s.to), arc.wall(s.to - s.crest).0)
        })
    }
    /// Largest height of the profile, mm: what Urinov 2020 calls waviness; exact, about the centre of the path.
    pub fn height(&self) -> f64 {
        let longest = self.passes.arcs[self.passes.longest].edge;
        let below = |s: &Stretch| {
            let arc = self.passes.arc(&self.passes.passes[s.pass]);
            longest - arc.edge + arc.below_crest(s.to - s.crest)
        };
        self.stretches.iter().map(below).fold(0.0, f64::max)
    }
    /// Smallest radius of the wall, mm.
    pub fn lowest(&self) -> f64 {
        self.passes.highest() - self.height()
    }
}

/// The passes round and round: index `i + count` is pass `i` one turn later.
struct Round<'a> {
    passes: &'a Passes,
}

/// The most comparisons of two passes for one profile.
pub const MAX_COMPARISONS: f64 = 2e7;

impl Round<'_> {
    fn count(&self) -> i64 {
        self.passes.passes.len() as i64
    }
    fn pass(&self, index: i64) -> usize {
        index.rem_euclid(self.count()) as usize
    }
    fn crest(&self, index: i64) -> f64 {
        self.passes.passes[self.pass(index)].crest + TAU * index.div_euclid(self.count()) as f64
    }
    /// Passes of unequal edges are compared with all within reach: that may be many only with many laps.
    fn check_work(&self) -> Result<(), Refusal> {
        let passes = self.passes.passes.len() as f64;
        let found = passes * passes * (3.0 * self.passes.reach / TAU).min(1.0);
        if self.passes.arcs.len() > 1 && found > MAX_COMPARISONS {
            return Err(Refusal::Comparisons { found, limit: MAX_COMPARISONS });
        }
        Ok(())
    }
    /// Who takes the lead from `leader` behind `from`, and where.
    fn next_leader(&self, leader: i64, from: f64) -> (f64, i64) {
        if self.passes.arcs.len() == 1 {
            return (0.5 * (self.crest(leader) + self.crest(leader + 1)), leader + 1);
        }
        let (own, reach) = (self.crest(leader), self.passes.reach);
        let arc = |index: i64| self.passes.arc(&self.passes.passes[self.pass(index)]);
        let mut best = (own + reach, None);
        let forward =
            (leader + 1..=leader + self.count()).take_while(|j| self.crest(*j) <= own + 2.0 * reach * (1.0 + 1e-9));
        let back = (leader - self.count()..leader).rev().take_while(|j| self.crest(*j) >= from - reach);
        for j in forward.chain(back) {
            let other = self.crest(j);
            let found = if self.passes.passes[self.pass(j)].arc == self.passes.passes[self.pass(leader)].arc {
                (other > own).then(|| (0.5 * (own + other)).max(from))
            } else {
                // Outside its reach a pass leads nowhere.
                let (low, high) = (from.max(other - reach), best.0.min(other + reach));
                takeover((arc(leader), own), (arc(j), other), low, high)
            };
            if let Some(place) = found.filter(|place| *place < best.0 || best.1.is_none()) {
                best = (place.min(best.0), Some(j));
            }
        }
        // At its reach some other pass is at least as far out; rounding may hide which, so take the farthest.
        let farthest = || {
            let wall = |j: &i64| arc(*j).wall(best.0 - self.crest(*j)).0;
            let near =
                (leader + 1..=leader + self.count()).take_while(|j| self.crest(*j) <= own + 2.0 * reach * (1.0 + 1e-9));
            near.max_by(|a, b| wall(a).total_cmp(&wall(b))).unwrap_or(leader + 1)
        };
        (best.0, best.1.unwrap_or_else(farthest))
    }
}
