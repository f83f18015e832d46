//! The choice of further places, given what was measured: each the one after which the worst place of the corrected
//! wall is most certain.
//!
//! Several places of the wall may be equally uncertain, and touching one leaves the others: so what is reduced is the
//! eighth-power mean of the standard deviations along the contour, which the largest ones rule, and what is told is the
//! largest. A place is worth its touches when they are expected to move the worst place of the wall by more than the
//! noise of a reading; the expected move is √(σ² before − σ² after).

use super::approach::{Xy, distance};
use super::candidates::Site;
use super::choice::Choice;
use super::covariance::Covariance;
use super::sensitivity::Sensitivity;
use super::wall_sensitivity::WallSensitivity;

/// A chosen place with the largest standard deviation of the corrected wall before and after its touches, mm.
#[derive(Clone, Debug)]
pub(super) struct Gain {
    pub(super) choice: Choice,
    pub(super) sigma: [f64; 2],
    /// Where the wall is least certain before, mm along the contour.
    pub(super) worst_s: f64,
}

impl Gain {
    /// Whether its touches are worth it, given the noise of a reading, mm.
    pub(super) fn is_worth_it(&self, noise: f64) -> bool {
        let [before, after] = self.sigma;
        (before * before - after * after).max(0.0).sqrt() > noise
    }
}

/// Chooses up to `count` sites at least `least` millimetres from each other and from the places `probed`; ends behind
/// the last that is worth its touches, but gives one at least where there is one.
pub(super) fn choose_next(
    sites: &[Site],
    sensitivities: &[Sensitivity],
    wall: &WallSensitivity,
    mut known: Covariance,
    probed: &[Xy],
    (count, least, noise): (usize, f64, f64),
) -> Vec<Gain> {
    let mut gains: Vec<Gain> = Vec::new();
    while gains.len() < count {
        let allowed = |k: &usize| {
            let wall = sites[*k].wall;
            let chosen = gains.iter().map(|gain| sites[gain.choice.site].wall);
            chosen.chain(probed.iter().copied()).all(|other| distance(other, wall) >= least)
        };
        let ranked = (0..sites.len())
            .filter(allowed)
            .map(|k| (k, known.after_all(&sensitivities[k].rows)))
            .map(|(k, after)| (k, ruled_by_worst(&after, wall), after))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((site, _, after)) = ranked else { break };
        let ((before_mm, worst_s), (after_mm, _)) = (largest(&known, wall), largest(&after, wall));
        let choice = Choice { site, before: std::mem::replace(&mut known, after.clone()), after };
        let gain = Gain { choice, sigma: [before_mm, after_mm], worst_s };
        if !gains.is_empty() && !gain.is_worth_it(noise) {
            break;
        }
        gains.push(gain);
    }
    gains
}

fn ruled_by_worst(known: &Covariance, wall: &WallSensitivity) -> f64 {
    wall.rows.iter().map(|(_, row)| known.sigma(row).powi(8)).sum()
}

/// The largest standard deviation of the wall, and where it is.
pub(super) fn largest(known: &Covariance, wall: &WallSensitivity) -> (f64, f64) {
    wall.rows.iter().map(|(s, row)| (known.sigma(row), *s)).fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}
