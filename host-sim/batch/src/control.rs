//! Control chart and capability of one place (individuals and moving range, EWMA; Montgomery, *Introduction to Statistical
//! Quality Control*, chapters 6, 8 and 9).

use statrs::distribution::{ContinuousCDF, Normal};

/// Mean moving range of two over the standard deviation.
const D2: f64 = 1.128;
/// Weight of the newest part in the EWMA.
pub const LAMBDA: f64 = 0.2;

/// The chart of a place.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Chart {
    /// Parts touched there.
    pub parts: usize,
    /// Mean deviation, mm.
    pub mean_mm: f64,
    /// Standard deviation from part to part, by the mean moving range, mm: what the process does at its best.
    pub sigma_mm: f64,
    /// Limits of single parts, mm.
    pub limits_mm: [f64; 2],
    /// Limits of the exponentially weighted mean, mm.
    pub ewma_limits_mm: [f64; 2],
    /// The exponentially weighted mean, part by part, mm.
    pub ewma_mm: Vec<f64>,
    /// Capability, with a tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capability: Option<Capability>,
}

/// How well a place fits into its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Capability {
    /// Width of the tolerance over six standard deviations.
    pub cp: f64,
    /// The nearer limit from the mean over three standard deviations.
    pub cpk: f64,
    /// Interval that holds Cpk with 95 % (Bissell 1990).
    pub cpk_95: [f64; 2],
}

impl Chart {
    /// Of the deviations at a place, in the order of the parts, mm; `None` of fewer than five. Limits are exceeded by chance once in
    /// `rarely` charts' parts.
    pub fn of(deviations: &[f64], tolerance: Option<[f64; 2]>, rarely: f64) -> Option<Self> {
        let n = deviations.len();
        if n < 5 {
            return None;
        }
        let mean = deviations.iter().sum::<f64>() / n as f64;
        let ranges: f64 = deviations.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
        // A process that repeats to the last digit is one of a simulation; a tenth of a micrometre is what is read at best.
        let sigma = (ranges / (n - 1) as f64 / D2).max(1e-4);
        let far = quantile(1.0 - 0.5 / rarely.max(2.0)).max(3.0) * sigma;
        let weighted = far * (LAMBDA / (2.0 - LAMBDA)).sqrt();
        let mut now = mean;
        let ewma = deviations.iter().map(|d| {
            now += LAMBDA * (d - now);
            now
        });
        Some(Self {
            parts: n,
            mean_mm: mean,
            sigma_mm: sigma,
            limits_mm: [mean - far, mean + far],
            ewma_limits_mm: [mean - weighted, mean + weighted],
            ewma_mm: ewma.collect(),
            capability: tolerance.map(|[low, high]| {
                let cpk = (high - mean).min(mean - low) / (3.0 * sigma);
                let spread = 1.96 * (1.0 / (9.0 * n as f64) + cpk * cpk / (2.0 * (n - 1) as f64)).sqrt();
                Capability { cp: (high - low) / (6.0 * sigma), cpk, cpk_95: [cpk - spread, cpk + spread] }
            }),
        })
    }
}

/// Quantile of the normal distribution.
pub fn quantile(share: f64) -> f64 {
    Normal::standard().inverse_cdf(share)
}

/// Share of the normal distribution below a value.
pub fn share_below(value: f64) -> f64 {
    Normal::standard().cdf(value)
}
