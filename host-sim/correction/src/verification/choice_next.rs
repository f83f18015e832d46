//! The choice of further places, given what was measured: each the one after which the worst place of the corrected
//! wall is most certain.
//!
//! Several places of the wall may be equally uncertain, and touching one leaves the others: so what is reduced is the
//! eighth-power mean of the standard deviations along the contour, which the largest ones rule, and what is told is the
//! largest. A place is worth its touches when they are expected to move the wall anywhere by more than the
//! noise of a reading; the expected move is √(σ² before − σ² after).

use super::approach::{Xy, distance};
use super::candidates::Site;
use super::choice::Choice;
use super::covariance::{Covariance, Thing, share_of};

/// A chosen place with the largest standard deviation of the corrected wall before and after its touches, mm.
#[derive(Clone, Debug)]
pub(super) struct Gain {
    pub(super) choice: Choice,
    pub(super) sigma: [f64; 2],
    /// Where the wall is least certain before, mm along the contour.
    pub(super) worst_s: f64,
    /// The standard deviation of what is beside the model at the place before and after, mm.
    pub(super) beside: [f64; 2],
    /// By how much the touches are expected to move the wall where they move it most, mm.
    pub(super) moves: f64,
}

impl Gain {
    /// Whether its touches are worth it, given the noise of a reading, mm.
    pub(super) fn is_worth_it(&self, noise: f64) -> bool {
        self.moves >= noise
    }
}

/// What a choice is made among, and what for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub(super) sites: &'a [Site],
    /// The touches of every site.
    pub(super) touches: &'a [Vec<Thing>],
    /// The corrected wall: places along the contour, mm, ascending, and how the wall changes there, mm.
    pub(super) wall: &'a [(f64, Thing)],
    /// Walls that are touched already.
    pub(super) touched: &'a [Xy],
}

/// How many sites are chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// At most.
    pub(super) count: usize,
    /// Between two of them, and from the places touched, at least, mm.
    pub(super) apart: f64,
    /// What the last of them moves the wall by at least, mm; there is one anyway.
    pub(super) worth: f64,
}

/// Chooses sites, one after the other.
pub(super) fn choose_next(task: &Task<'_>, mut known: Covariance, limits: Limits) -> Vec<Gain> {
    let Task { sites, touches, wall, touched } = *task;
    let mut gains: Vec<Gain> = Vec::new();
    while gains.len() < limits.count {
        let allowed = |k: &usize| {
            let wall = sites[*k].wall;
            let chosen = gains.iter().map(|gain| sites[gain.choice.site].wall);
            chosen.chain(touched.iter().copied()).all(|other| distance(other, wall) >= limits.apart)
        };
        let now: Vec<f64> = wall.iter().map(|(_, thing)| known.variance(thing)).collect();
        let left = |taken: &[Vec<f64>]| -> f64 {
            let of = |(now, (_, thing)): (&f64, &(f64, Thing))| (now - share_of(taken, thing)).max(0.0).powi(4);
            now.iter().zip(wall).map(of).sum()
        };
        let ranked = (0..sites.len())
            .filter(allowed)
            .map(|k| (k, known.taken(&touches[k])))
            .map(|(k, taken)| (k, left(&taken), taken))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((site, _, taken)) = ranked else { break };
        let after = known.clone().without(&taken);
        let ((before_mm, worst_s), (after_mm, _)) = (largest(&known, wall), largest(&after, wall));
        let beside = touches[site].first().and_then(|touch| touch.beside).map(|(at, _)| Thing::of_place(at));
        let beside = [&known, &after].map(|known| beside.map_or(0.0, |thing| known.sigma(&thing)));
        let moves = wall.iter().map(|(_, thing)| share_of(&taken, thing)).fold(0.0, f64::max).sqrt();
        let choice = Choice { site, before: std::mem::replace(&mut known, after.clone()), after };
        let gain = Gain { choice, sigma: [before_mm, after_mm], worst_s, beside, moves };
        if !gains.is_empty() && gain.moves < limits.worth {
            break;
        }
        gains.push(gain);
    }
    gains
}

/// The largest standard deviation of the wall, and where it is.
pub(super) fn largest(known: &Covariance, wall: &[(f64, Thing)]) -> (f64, f64) {
    wall.iter().map(|(s, thing)| (known.sigma(thing), *s)).fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}
