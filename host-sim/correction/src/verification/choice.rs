//! The choice of places: one after the other, each the one that most reduces what is uncertain about the wall.
//!
//! Uncertain is the wall error that the correction will be computed from: its variance, summed over every place that
//! may be touched and every height, given what the touches chosen so far will tell (a greedy I-optimal design). The
//! radius of cutter and ball and the shift of the datum are unknowns of the touches, not of the wall: they are told
//! apart from it because the places disagree about them.
//!
//! The model is not the machine: a chatter mark or a chip spoils neighbours together. So the places are kept apart by a
//! share of the contour, as long as there are places left that far apart.

use super::approach::distance;
use super::candidates::Site;
use super::covariance::{Covariance, products};
use super::sensitivity::Sensitivity;

/// A chosen place and what was known before and after it.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// Index of the site.
    pub(super) site: usize,
    pub(super) before: Covariance,
    pub(super) after: Covariance,
}

/// The choice and what it leaves.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    /// In the order in which they were chosen: the most telling first.
    pub(super) choices: Vec<Choice>,
    /// Standard deviation of the wall error, root mean square over all places and heights, mm: before and after.
    pub(super) wall_sigma: [f64; 2],
    /// What is known at the end.
    pub(super) known: Covariance,
}

/// Share of the contour that a place has to itself, as long as possible.
const OWN_SHARE: f64 = 0.35;

/// Chooses up to `count` sites at least `least` millimetres from each other, on contours of a length in mm together. Then
/// every owner of sites (`owners` names that of each) has at least `each` of them, where it has as many.
pub(super) fn choose(
    sites: &[Site],
    sensitivities: &[Sensitivity],
    count: usize,
    least: f64,
    length: f64,
    (owners, each): (&[usize], usize),
) -> Chosen {
    let wall = products(sensitivities.iter().flat_map(|t| &t.wall));
    let things = sensitivities.iter().map(|t| t.wall.len()).sum::<usize>().max(1) as f64;
    let sigma = |known: &Covariance| (known.total(&wall).max(0.0) / things).sqrt();
    let mut known = Covariance::prior();
    let before = sigma(&known);
    let mut choices: Vec<Choice> = Vec::new();
    let usual = (OWN_SHARE * length / count as f64).max(least);
    let mut grow = |of: Option<usize>, count: usize, mut apart: f64| {
        let own = |choice: &&Choice| of.is_none_or(|owner| owners[choice.site] == owner);
        while choices.iter().filter(own).count() < count {
            let allowed = |k: &usize| {
                of.is_none_or(|owner| owners[*k] == owner)
                    && choices.iter().all(|c| distance(sites[c.site].wall, sites[*k].wall) >= apart)
            };
            let ranked = (0..sites.len())
                .filter(allowed)
                .map(|k| (k, known.after_all(&sensitivities[k].touches(None))))
                .min_by(|a, b| a.1.total(&wall).total_cmp(&b.1.total(&wall)));
            let Some((site, after)) = ranked else {
                if apart <= least {
                    break;
                }
                apart = (apart / 2.0).max(least);
                continue;
            };
            choices.push(Choice { site, before: std::mem::replace(&mut known, after.clone()), after });
        }
    };
    grow(None, count, usual);
    for owner in 0..owners.last().map_or(0, |last| last + 1) {
        grow(Some(owner), each, usual);
    }
    Chosen { choices, wall_sigma: [before, sigma(&known)], known }
}
