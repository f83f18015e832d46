//! Coefficients from mean forces: every pair of laws by weighted least squares, and the evidence for each.
//!
//! A mean force over whole revolutions holds neither helix nor runout nor phase, so that a few feeds at one engagement give
//! the coefficients by themselves (Altintas, ch. 2.8). The evidence of a pair of laws is its marginal likelihood (Laplace),
//! with what handbooks let expect as a prior ([`Law::expected`]) and the standard deviations of the means: three feeds rarely
//! decide by themselves. A model that misses the means by more than those has its standard deviations widened by the root
//! of `χ²` per degree of freedom.

use truepath_ground::rows::ascending;

use crate::cut::Cut;
use crate::law::{LAWS, Law};
use crate::squares::{Estimate, least_squares};

/// By how much the mean force of a cut differs from that of the same cut made again, as a share of it, where nothing is
/// stated: depth, hardness, edge and dynamometer together.
pub const REPEATABILITY: f64 = 0.03;

/// What a mean is of; forces are those on the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Along {
    /// The travel, N.
    Feed,
    /// Left of it, N.
    Across,
    /// The turn of the spindle, N·m.
    Torque,
}

/// A mean over whole revolutions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Mean {
    /// What of.
    pub along: Along,
    /// The value, N or N·m.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The means of one cut.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measured {
    /// The cut.
    pub cut: Cut,
    /// What was measured in it.
    pub means: Vec<Mean>,
}

/// Two laws with their unknowns.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Model {
    /// Tangential and radial.
    pub laws: [Law; 2],
    /// Unknowns of the tangential law, then of the radial one.
    pub unknowns: Vec<f64>,
}

impl Model {
    /// The unknowns of one direction, 0 tangential, 1 radial.
    pub fn of(&self, direction: usize) -> &[f64] {
        let (tangential, radial) = self.unknowns.split_at(self.laws[0].unknowns().min(self.unknowns.len()));
        if direction == 0 { tangential } else { radial }
    }

    /// The mean over a revolution, N or N·m.
    pub fn mean(&self, cut: &Cut, along: Along) -> f64 {
        let sum = |direction: usize, pick: &dyn Fn(crate::cut::Integrals) -> f64| -> f64 {
            let terms = self.laws[direction].terms(self.of(direction)).into_iter();
            terms.filter(|(_, by)| *by != 0.0).map(|(term, by)| by * pick(cut.mean(term))).sum()
        };
        match along {
            Along::Feed => -sum(0, &|i| i.cos) - sum(1, &|i| i.sin),
            Along::Across => sum(0, &|i| i.sin) - sum(1, &|i| i.cos),
            Along::Torque => 1e-3 * cut.radius_mm() * sum(0, &|i| i.one),
        }
    }
}

/// A fitted pair of laws.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Fitted {
    /// The laws and what was found.
    pub model: Model,
    /// Standard deviations of the unknowns.
    pub sigma: Vec<f64>,
    /// Their correlation.
    pub correlation: Vec<Vec<f64>>,
    /// Sum of squared residuals over their standard deviations.
    pub chi2: f64,
    /// Means less unknowns.
    pub freedom: usize,
    /// Natural logarithm of the marginal likelihood, but for a constant.
    pub evidence: f64,
    /// Probability among the pairs that were tried.
    pub weight: f64,
    /// Largest deviation of a mean, as a share of the force in its cut.
    pub worst: f64,
}

/// Whether a spindle's torque is all that was measured: it tells nothing of the radial force.
pub fn torque_alone(cuts: &[Measured]) -> bool {
    cuts.iter().flat_map(|c| &c.means).all(|m| m.along == Along::Torque)
}

/// Feeds per tooth that differ by more than 2 %.
pub fn feeds(cuts: &[Measured]) -> usize {
    let mut feeds: Vec<f64> = cuts.iter().map(|c| c.cut.feed_per_tooth_mm).collect();
    ascending(&mut feeds);
    feeds.dedup_by(|b, a| *b < 1.02 * *a);
    feeds.len()
}

/// Fits one pair of laws, with what handbooks expect or to the means alone; `None` where the cuts do not tell the unknowns apart.
pub fn fit(cuts: &[Measured], laws: [Law; 2], prior: bool) -> Option<Fitted> {
    let radial = !torque_alone(cuts);
    let counts = [laws[0].unknowns(), if radial { laws[1].unknowns() } else { 0 }];
    let places: Vec<(usize, usize)> = (0..2).flat_map(|d| (0..counts[d]).map(move |k| (d, k))).collect();
    let means: Vec<(&Cut, &Mean)> = cuts.iter().flat_map(|c| c.means.iter().map(move |m| (&c.cut, m))).collect();
    if !prior && means.len() < places.len() {
        return None;
    }
    let scale: Vec<f64> = places.iter().map(|&(d, k)| laws[d].of_unknown(k).2).collect();
    let range: Vec<[f64; 2]> = places.iter().map(|&(d, k)| laws[d].of_unknown(k).3).collect();
    let model = |unknowns: &[f64]| Model { laws, unknowns: unknowns.to_vec() };
    let residuals = |unknowns: &[f64]| -> Vec<f64> {
        let model = model(unknowns);
        let missed = means.iter().map(|(cut, mean)| (model.mean(cut, mean.along) - mean.value) / mean.sigma);
        let unexpected = places.iter().zip(unknowns).map(|(&(d, k), value)| {
            let [expected, sigma] = laws[d].expected(k, d);
            (value - expected) / sigma
        });
        missed.chain(unexpected.take(if prior { places.len() } else { 0 })).collect()
    };
    let mut best: Option<Estimate> = None;
    let radials: &[f64] = if radial { laws[1].shapes() } else { &[0.0] };
    for (tangential, radial) in laws[0].shapes().iter().flat_map(|t| radials.iter().map(move |r| (*t, *r))) {
        let start: Vec<f64> = places
            .iter()
            .zip(&scale)
            .map(|(&(d, k), typical)| match laws[d].of_unknown(k).0 {
                "m" | "h0" => [tangential, radial][d],
                _ => *typical,
            })
            .collect();
        let found = least_squares(&start, &scale, &range, &residuals);
        best = best.into_iter().chain(found).min_by(|a, b| a.chi2.total_cmp(&b.chi2));
    }
    let Estimate { theta, covariance, chi2: all } = best?;
    let chi2: f64 = residuals(&theta).iter().take(means.len()).map(|r| r * r).sum();
    let freedom = means.len().saturating_sub(theta.len());
    let widened = if freedom > 0 { (chi2 / freedom as f64).max(1.0) } else { 1.0 };
    let sigma: Vec<f64> = (0..theta.len()).map(|k| (widened * covariance[k][k]).sqrt()).collect();
    let correlation = (0..theta.len())
        .map(|i| (0..theta.len()).map(|j| covariance[i][j] / (covariance[i][i] * covariance[j][j]).sqrt()).collect())
        .collect();
    let model = model(&theta);
    let worst = cuts.iter().flat_map(|c| {
        let size = c.means.iter().map(|m| m.value.abs()).fold(0.0, f64::max);
        c.means
            .iter()
            .map(|m| (m, size))
            .map(|(m, size)| (model.mean(&c.cut, m.along) - m.value).abs() / size)
            .collect::<Vec<_>>()
    });
    let worst = worst.fold(0.0, f64::max);
    let narrowed =
        log_determinant(&covariance) - places.iter().map(|&(d, k)| 2.0 * laws[d].expected(k, d)[1].ln()).sum::<f64>();
    let evidence = 0.5 * (narrowed - all);
    Some(Fitted { model, sigma, correlation, chi2, freedom, evidence, weight: 1.0, worst })
}

/// Every pair of laws that the cuts can tell, the likeliest first. With one feed only the chip is fitted.
pub fn fit_every(cuts: &[Measured]) -> Vec<Fitted> {
    let feeds = feeds(cuts);
    let possible = |law: &&Law| law.unknowns() <= feeds;
    let laws: Vec<Law> = if feeds < 2 { vec![Law::Chip] } else { LAWS.iter().filter(possible).copied().collect() };
    let radial = if torque_alone(cuts) { vec![Law::Chip] } else { laws.clone() };
    let pairs = laws.iter().flat_map(|t| radial.iter().map(move |r| [*t, *r]));
    let mut fitted: Vec<Fitted> = pairs.filter_map(|pair| fit(cuts, pair, true)).collect();
    fitted.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let best = fitted.first().map_or(0.0, |f| f.evidence);
    let total: f64 = fitted.iter().map(|f| (f.evidence - best).exp()).sum();
    fitted.iter_mut().for_each(|f| f.weight = (f.evidence - best).exp() / total);
    fitted
}

/// The mean that several laws predict, weighted by their evidence, and how far they are apart (standard deviation).
pub fn average(laws: &[Fitted], cut: &Cut, along: Along) -> (f64, f64) {
    let each: Vec<(f64, f64)> = laws.iter().map(|f| (f.weight, f.model.mean(cut, along))).collect();
    let mean: f64 = each.iter().map(|(w, v)| w * v).sum();
    (mean, each.iter().map(|(w, v)| w * (v - mean).powi(2)).sum::<f64>().sqrt())
}

/// ln det of a covariance.
fn log_determinant(covariance: &[Vec<f64>]) -> f64 {
    let mut work = covariance.to_vec();
    let mut sum = 0.0;
    for k in 0..work.len() {
        sum += work[k][k].ln();
        let row = work[k].clone();
        for other in work.iter_mut().skip(k + 1) {
            let factor = other[k] / row[k];
            other.iter_mut().zip(&row).for_each(|(v, r)| *v -= factor * r);
        }
    }
    sum
}
