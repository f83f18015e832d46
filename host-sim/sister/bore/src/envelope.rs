//! The profile of the bore: for every ray the pass that cuts farthest out.
//!
//! Not sampled: the profile is the list of stretches led by one pass each, and its crests of material are the exact places
//! where the lead changes. Two passes of teeth of one radius meet midway between their crests, since their curves are
//! symmetric and fall on either side. With runout the curves differ, and the change is searched from the left with steps that
//! a bound of the second derivative proves safe ([`super::takeover`]).

use std::f64::consts::TAU;

use super::passes::{Passes, ToothPass, around};
use super::refusal::Refusal;
use super::sweep::{Round, Stretch};

/// The most steps of comparison for one profile.
pub const MAX_STEPS: u64 = 20_000_000;
/// The most for what repeats.
const STEADY_STEPS: u64 = 1_000_000;

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
    /// [`Refusal::Comparisons`] when passes of unequal edges take more than [`MAX_STEPS`] steps to compare.
    pub fn of(passes: Passes) -> Result<Self, Refusal> {
        // The longest edge leads where it points at the wall.
        let start = passes.passes.iter().position(|p| p.arc == passes.longest).ok_or(Refusal::Unfinished)? as i64;
        let last = start + passes.passes.len() as i64;
        let mut stretches = Round::new(&passes, MAX_STEPS).sweep(start, last)?;
        // The first stretch begins at its crest; its beginning has now been found one turn later.
        let end = stretches.last().map_or(0.0, |s| s.to);
        if let Some(first) = stretches.first_mut() {
            first.from = end - TAU;
        }
        Ok(Self { passes, stretches })
    }
    /// Radius of the wall on the ray φ, mm, and the pass that cut it.
    pub fn at(&self, phi: f64) -> (f64, &ToothPass) {
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
        height(&self.passes, &self.stretches)
    }
    /// Smallest radius of the wall, mm.
    pub fn lowest(&self) -> f64 {
        self.passes.highest() - self.height()
    }
}

fn height(passes: &Passes, stretches: &[Stretch]) -> f64 {
    let longest = passes.arcs[passes.longest].edge;
    let below = |s: &Stretch| {
        let arc = passes.arc(&passes.passes[s.pass]);
        longest - arc.edge + arc.below_crest(s.to - s.crest)
    };
    stretches.iter().map(below).fold(0.0, f64::max)
}

/// What repeats with every turn of the cutter, away from where the cut begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// Height of the profile, mm.
    pub height_mm: f64,
    /// Teeth that leave a mark.
    pub cutting_teeth: usize,
    /// Largest radius of the wall, mm.
    pub highest_mm: f64,
}

impl Steady {
    /// From one turn of the cutter when there is one lap, from the whole circle when there are more.
    ///
    /// # Errors
    /// As [`Profile::of`].
    pub fn of(passes: Passes, one_lap: bool) -> Result<Self, Refusal> {
        let (passes, stretches) = if one_lap {
            let from = 2.0 * passes.motion.spacing();
            let of = |p: &ToothPass, after: f64| p.arc == passes.longest && p.crest >= after;
            let start = passes.passes.iter().position(|p| of(p, from)).ok_or(Refusal::Unfinished)?;
            let tooth = passes.passes[start].tooth;
            let next = passes.passes[start + 1..].iter().position(|p| p.tooth == tooth).ok_or(Refusal::Unfinished)?;
            let stretches = Round::new(&passes, STEADY_STEPS).sweep(start as i64, (start + 1 + next) as i64)?;
            (passes, stretches)
        } else {
            let profile = Profile::of(passes)?;
            (profile.passes, profile.stretches)
        };
        Ok(Self {
            height_mm: height(&passes, &stretches),
            cutting_teeth: cutting_teeth(&passes, &stretches),
            highest_mm: passes.highest(),
        })
    }
}

/// How many teeth leave a mark.
pub fn cutting_teeth(passes: &Passes, stretches: &[Stretch]) -> usize {
    let mut cuts = vec![false; passes.teeth.len()];
    for stretch in stretches {
        cuts[passes.passes[stretch.pass].tooth] = true;
    }
    cuts.into_iter().filter(|c| *c).count()
}
