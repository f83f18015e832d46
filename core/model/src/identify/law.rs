//! Which wall law the points speak for.

use super::fit::{Cut, Fit, identify};
use super::observation::{Observation, Predictor};
use super::parameters::Prior;
use crate::cut::{Path, WallLaw};
use truepath_units::Real;
use truepath_units::geometry::Vector;

/// By how much the evidence for the mean law must exceed that for the helical one before it is believed (20 : 1).
const DECISIVE: Real = Real::from_int(3);

/// Identifies from one contour of one part under both wall laws and takes the mean law only where the points speak decisively for it: on a
/// helical cutter it is the wrong one, and a few points at one height cannot tell.
///
/// `around` gives the prior for a law, the others are those of [`identify`]. Returns the law with its prior and fit; the
/// observations hold its predictions.
pub fn identify_law(
    path: &Path,
    around: impl Fn(WallLaw) -> Prior,
    observations: &mut [Observation],
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    predictor: &mut impl Predictor,
    observe: &mut dyn FnMut(u16),
) -> (WallLaw, Prior, Fit) {
    let mut under = |law, observations: &mut [Observation], fits: u16| {
        let prior = around(law);
        let third = &mut |permille: u16| observe(fits.saturating_mul(1000).saturating_add(permille) / 3);
        let cuts = [Cut { path: path.with_law(law), points: observations.len(), part: 0 }];
        let fit = identify(&cuts, (&prior, None), &mut [], observations, commanded, predictor, third);
        (law, prior, fit)
    };
    let mean = under(WallLaw::Mean, observations, 0);
    let helical = under(WallLaw::Helical, observations, 1);
    if speaks_for_mean(&mean.2, &helical.2) { under(WallLaw::Mean, observations, 2) } else { helical }
}

/// Whether the points speak decisively for the mean law, after a fit under it and one under the helical law.
pub fn speaks_for_mean(mean: &Fit, helical: &Fit) -> bool {
    mean.evidence > helical.evidence + DECISIVE
}
