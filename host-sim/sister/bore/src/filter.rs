//! The profile as equally spaced samples and the Gaussian filter for closed profiles (ISO 16610-21).
//!
//! A closed profile needs no run-in: the filter is exact in the Fourier domain, where a component of `n` undulations per revolution
//! passes by the share `exp(−π(αn/n_c)²) = 2^−(n/n_c)²` (α = √(ln 2/π); half at the cut-off `n_c`). A cut-off wavelength λ on
//! a wall of radius ρ is the cut-off `2πρ/λ` undulations per revolution.

use std::f64::consts::TAU;
use std::sync::Arc;

use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection};

use super::envelope::Profile;

/// Samples a mark.
const A_MARK: usize = 64;
/// Samples a wave at the finest cut-off.
const A_WAVE: f64 = 16.0;
/// Fewest samples a turn.
const FEWEST: usize = 1 << 14;
/// Most samples a turn.
const MOST: usize = 1 << 22;

/// Share of `n` undulations per revolution that the long-wave side of a cut-off passes.
pub fn passed(undulations: f64, cutoff: f64) -> f64 {
    (-(undulations / cutoff).powi(2)).exp2()
}

/// The discrete Fourier transform, in place, not scaled. A planner would choose among algorithms of every length, 0.3 MB of program; the
/// lengths here are powers of two, but for profiles that were measured.
fn transform(values: &mut [Complex<f64>], direction: FftDirection) {
    let count = values.len();
    if count < 2 {
        return;
    }
    if count.is_power_of_two() {
        Radix4::new(count, direction).process(values);
    } else {
        let inner = Radix4::new((2 * count - 1).next_power_of_two(), direction);
        BluesteinsAlgorithm::new(count, Arc::new(inner)).process(values);
    }
}

/// A closed profile: deviations from a circle about the centre of the path at equal angles from 0.
#[derive(Clone, Debug)]
pub struct Closed {
    /// Radius of the circle: the mean, mm.
    pub mean_mm: f64,
    /// Deviations, mm.
    pub deviations: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
}

impl Closed {
    /// Samples a profile: 64 points a mark and 16 a wave of the finest cut-off in undulations per revolution, 2¹⁴…2²² in all.
    pub fn of(profile: &Profile, finest: f64) -> Self {
        let wanted = (A_MARK * profile.stretches.len()).max((A_WAVE * finest).min(MOST as f64) as usize);
        let count = wanted.min(MOST).next_power_of_two().clamp(FEWEST, MOST);
        let radius = |n: usize| profile.at(TAU * n as f64 / count as f64).0;
        Self::from_radii((0..count).map(radius).collect())
    }
    /// From radii, mm, at equal angles; any number of them.
    pub fn from_radii(radii: Vec<f64>) -> Self {
        let base = radii.first().copied().unwrap_or(0.0);
        let count = radii.len().max(1) as f64;
        let mean_mm = base + radii.iter().map(|r| r - base).sum::<f64>() / count;
        let deviations: Vec<f64> = radii.into_iter().map(|r| r - mean_mm).collect();
        let mut spectrum: Vec<Complex<f64>> = deviations.iter().map(|d| Complex::new(*d, 0.0)).collect();
        transform(&mut spectrum, FftDirection::Forward);
        Self { mean_mm, deviations, spectrum }
    }
    /// Circumference of the mean circle, mm.
    pub fn circumference(&self) -> f64 {
        TAU * self.mean_mm
    }
    /// Undulations per revolution of a wavelength on the wall, mm.
    pub fn undulations(&self, wavelength_mm: f64) -> f64 {
        self.circumference() / wavelength_mm
    }
    /// The long-wave part below a cut-off in undulations per revolution, mm.
    pub fn below(&self, cutoff: f64) -> Vec<f64> {
        let count = self.spectrum.len();
        let mut kept = self.spectrum.clone();
        for (index, component) in kept.iter_mut().enumerate() {
            *component *= passed(index.min(count - index) as f64, cutoff) / count as f64;
        }
        transform(&mut kept, FftDirection::Inverse);
        kept.into_iter().map(|c| c.re).collect()
    }
    /// Amplitude, mm, of the component of `n` undulations per revolution.
    pub fn amplitude(&self, n: usize) -> f64 {
        self.spectrum.get(n).map_or(0.0, |c| 2.0 * c.norm() / self.spectrum.len() as f64)
    }
}
