//! The wall error that parts have shown beside the model, as a smooth function along the contour.
//!
//! A Gaussian process on measured − predicted, mean over the heights of a place (Rasmussen & Williams, *Gaussian
//! Processes for Machine Learning*, ch. 2 and 5), with the likeness of [`Kernel`]. How large it is the evidence decides: that of
//! the places with the parameters of the machine integrated out, so that what another machine could explain is not
//! called a residual, over a grid of standard deviations that contains zero. Zero is kept unless another value is
//! [`DECISIVE`]ly better: noise is never learned.
//!
//! Points of one height differ by what the model misses over the height as well; the scatter within the places says how
//! much that is, and it counts as noise.
//!
//! Limits: one residual for all heights; at most [`MOST_PLACES`](super::places::MOST_PLACES) places, the newest parts first.

use truepath_core::correct::commanded;
use truepath_core::cut::{Path, State};
use truepath_core::identify::COUNT;
use truepath_core::units::Offset;
use truepath_ground::units::float;

use super::cholesky::Cholesky;
use super::joint::{Joint, PartPoints};
use super::kernel::{Engagement, Feature, Kernel};
use super::places::{Places, places};

/// Standard deviations that are tried, mm.
const GRID: [f64; 7] = [0.0, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032];
/// Gain in evidence (natural logarithm) from which a residual is believed: 7 : 1.
const DECISIVE: f64 = 2.0;

/// A residual along a contour.
#[derive(Clone, Debug)]
pub struct Residual {
    kernel: Kernel,
    features: Vec<Feature>,
    /// K⁻¹ times the residual at the places.
    weights: Vec<f64>,
    /// Covariance of the places with their noise.
    spread: Cholesky,
}

impl Residual {
    /// Of the parts of a joint fit; `None` when the places fit the model within their noise.
    pub fn of(path: &Path, parts: &[PartPoints], joint: &Joint) -> Option<Self> {
        let path = path.with_law(joint.core.law);
        let table = joint.core.table();
        let machine = joint.core.machine(&path, &table);
        let working = path.working();
        let mut states = vec![State::REST; working.len()];
        let mut seen = Places::default();
        for (k, part) in parts.iter().enumerate().rev() {
            machine.run(working.start, &mut states, |i| commanded(&path, &part.nodes, i));
            let engagement = Engagement::of(&path, working.start, &states);
            places(k, parts.len(), part, joint, &engagement, &mut seen);
        }
        seen.close();
        let prior = Prior::of(&seen, joint);
        let plain = prior.evidence(&seen, None)?;
        let mut best: Option<(f64, Kernel)> = None;
        for (local, keyed) in GRID.iter().flat_map(|local| GRID.iter().map(move |keyed| (*local, *keyed))) {
            let kernel = Kernel::along(&path, local, keyed);
            let gain = prior.evidence(&seen, Some(&kernel)).map_or(f64::MIN, |evidence| evidence - plain);
            if gain > best.map_or(DECISIVE, |(most, _)| most) {
                best = Some((gain, kernel));
            }
        }
        let (_, kernel) = best?;
        let n = seen.features.len();
        let covariance = |i: usize, j: usize| {
            kernel.of(&seen.features[i], &seen.features[j]) + if i == j { seen.variance[i] } else { 0.0 }
        };
        let matrix: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| covariance(i, j)).collect()).collect();
        let spread = Cholesky::new(&matrix)?;
        let weights = spread.solve(&seen.residual);
        Some(Self { kernel, features: seen.features, weights, spread })
    }

    /// Standard deviations of the local and of the keyed kind that the evidence chose, mm.
    pub fn amplitudes(&self) -> [f64; 2] {
        [self.kernel.local, self.kernel.keyed]
    }

    /// Residual at a place and its standard deviation, mm.
    pub(super) fn at(&self, place: &Feature) -> (f64, f64) {
        let likeness: Vec<f64> = self.features.iter().map(|f| self.kernel.of(f, place)).collect();
        let mean = likeness.iter().zip(&self.weights).map(|(k, w)| k * w).sum();
        let known: f64 = self.spread.halfway(&likeness).iter().map(|v| v * v).sum();
        (mean, (self.kernel.variance() - known).max(0.0).sqrt())
    }

    /// Residual beside every sample of the contour where the correction leads the cutter to its nominal place, and its
    /// standard deviation.
    pub fn along(&self, path: &Path, joint: &Joint) -> (Vec<Offset>, Vec<Offset>) {
        let path = path.with_law(joint.core.law);
        let table = joint.core.table();
        let machine = joint.core.machine(&path, &table);
        let engagement = Engagement::nominal(&machine);
        let contour = &path.samples()[path.first()..path.first() + path.count()];
        let nm = |mm: f64| Offset::from_nm((mm * 1e6).round() as i64);
        let at = |(mean, sigma)| (nm(mean), nm(sigma));
        contour.iter().map(|sample| at(self.at(&engagement.at(sample.s, sample.normal)))).unzip()
    }
}

/// The machine's parameters as the fit takes them: what they explain is no residual.
struct Prior {
    /// Distance of the fit from its prior, prior standard deviations: shared parameters, then the datum of each part.
    theta: Vec<f64>,
    /// Information of prior and places, factored.
    information: Option<Cholesky>,
    /// What of the places' own information is left, and of their pull, when the parameters are integrated out.
    left: Vec<Vec<f64>>,
    pull: Vec<f64>,
}

impl Prior {
    fn of(seen: &Places, joint: &Joint) -> Self {
        let fit = &joint.core.fit;
        let shared = COUNT - 2;
        let mut theta: Vec<f64> = fit.theta.iter().take(shared).map(|t| float(*t)).collect();
        theta.extend(joint.datums.iter().flatten());
        let n = theta.len();
        let mut matrix = vec![vec![0.0; n]; n];
        let mut gradient: Vec<f64> = theta.iter().map(|t| -t).collect();
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for ((row, residual), variance) in seen.sensitivity.iter().zip(&seen.residual).zip(&seen.variance) {
            for i in 0..n {
                gradient[i] += row[i] * residual / variance;
                for j in 0..n {
                    matrix[i][j] += row[i] * row[j] / variance;
                }
            }
        }
        let information = Cholesky::new(&matrix);
        let places = seen.residual.len();
        let (mut left, mut pull) = (vec![vec![0.0; places]; places], vec![0.0; places]);
        if let Some(information) = &information {
            let scaled = |i: usize| -> Vec<f64> { seen.sensitivity[i].iter().map(|v| v / seen.variance[i]).collect() };
            let halfway: Vec<Vec<f64>> = (0..places).map(|i| information.halfway(&scaled(i))).collect();
            let towards = information.halfway(&gradient);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            for i in 0..places {
                pull[i] = seen.residual[i] / seen.variance[i] - dot(&halfway[i], &towards);
                for j in 0..places {
                    let own = if i == j { 1.0 / seen.variance[i] } else { 0.0 };
                    left[i][j] = own - dot(&halfway[i], &halfway[j]);
                }
            }
        }
        Self { theta, information, left, pull }
    }

    /// Logarithm of the evidence for a kernel, up to a constant; zero without one.
    fn evidence(&self, seen: &Places, kernel: Option<&Kernel>) -> Option<f64> {
        self.information.as_ref().filter(|_| !self.theta.is_empty())?;
        let Some(kernel) = kernel else { return Some(0.0) };
        let n = seen.features.len();
        let covariance: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| {
                        // A trace of its own for every place keeps equal places of two parts apart.
                        kernel.of(&seen.features[i], &seen.features[j]) + if i == j { 1e-10 } else { 0.0 }
                    })
                    .collect()
            })
            .collect();
        // B = 1 + Lᵀ·M·L with K = L·Lᵀ: ln det(1 + K·M), and bᵀ·(M + K⁻¹)⁻¹·b = |B^(−½)·Lᵀ·b|².
        let lower = Cholesky::new(&covariance)?;
        let columns: Vec<Vec<f64>> = (0..n).map(|k| lower.column(k)).collect();
        let product = |matrix: &[Vec<f64>], v: &[f64]| -> Vec<f64> {
            matrix.iter().map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
        };
        let moved: Vec<Vec<f64>> = columns.iter().map(|c| product(&self.left, c)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let b: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| dot(&columns[i], &moved[j]) + if i == j { 1.0 } else { 0.0 }).collect())
            .collect();
        let b = Cholesky::new(&b)?;
        let right: Vec<f64> = columns.iter().map(|c| dot(c, &self.pull)).collect();
        let explained: f64 = b.halfway(&right).iter().map(|v| v * v).sum();
        Some(0.5 * (explained - b.ln_determinant()))
    }
}
