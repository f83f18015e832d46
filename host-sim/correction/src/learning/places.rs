//! Measured − predicted at the places of all parts, with its noise and what the machine's parameters do to it.

use truepath_core::identify::{COUNT, Observation};
use truepath_ground::units::{float, mm};

use super::joint::{Joint, PartPoints};
use super::kernel::{Engagement, Feature};

/// Places that are looked at.
pub(super) const MOST_PLACES: usize = 160;

/// Places, one entry each; lengths in mm.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    pub(super) features: Vec<Feature>,
    /// Measured − predicted, mean over the heights.
    pub(super) residual: Vec<f64>,
    /// Variance of that by noise.
    pub(super) variance: Vec<f64>,
    /// Change of the prediction per prior standard deviation: shared parameters, then the datum of each part.
    pub(super) sensitivity: Vec<Vec<f64>>,
    /// Sum of squares of the heights about their places, less that of the probe's noise, and how many it is of.
    scatter: (f64, f64),
    /// Effective number of heights.
    heights: Vec<f64>,
}

/// Adds the places of a part, the `k`-th of `parts`, while there is room.
pub(super) fn places(
    k: usize,
    parts: usize,
    part: &PartPoints,
    joint: &Joint,
    engagement: &Engagement,
    seen: &mut Places,
) {
    let Some(observations) = joint.observations.get(k) else { return };
    let noise = mm(part.noise).powi(2);
    for place in part.places() {
        let Some(points) = observations.get(place).filter(|_| seen.features.len() < MOST_PLACES) else { break };
        // What the fit gave little weight is of something else.
        let weight: f64 = points.iter().map(|o| float(o.weight)).sum();
        if weight < 0.3 {
            continue;
        }
        let mean =
            |f: &dyn Fn(&Observation) -> f64| points.iter().map(|o| float(o.weight) * f(o)).sum::<f64>() / weight;
        let residual = mean(&|o| mm(o.error - o.predicted));
        let about = points.iter().map(|o| float(o.weight) * (mm(o.error - o.predicted) - residual).powi(2));
        let free = weight - 1.0;
        if free > 0.5 {
            seen.scatter.0 += about.sum::<f64>() - free * noise;
            seen.scatter.1 += free;
        }
        let mut sensitivity: Vec<f64> = vec![0.0; COUNT - 2 + 2 * parts];
        for i in 0..COUNT {
            let at = if i < COUNT - 2 { i } else { i + 2 * k };
            sensitivity[at] = mean(&|o| float(o.sensitivity[i]) * mm(o.deviation()));
        }
        seen.features.push(engagement.at(points[0].s, points[0].normal));
        seen.residual.push(residual);
        seen.variance.push(noise / weight);
        seen.sensitivity.push(sensitivity);
        seen.heights.push(weight);
    }
}

impl Places {
    /// Adds what the model misses over the height to the noise, when all places are in.
    pub(super) fn close(&mut self) {
        let missed = (self.scatter.0 / self.scatter.1.max(1.0)).max(0.0);
        for (variance, heights) in self.variance.iter_mut().zip(&self.heights) {
            *variance += missed / heights;
        }
    }
}
