//! What a dynamometer under the workpiece records of a straight cut: forces of the teeth with their runout, the drift and the
//! low-pass of its amplifier, noise, and air before and after.
//!
//! Axes as a dynamometer is mounted: x along the travel of the cutter, y to the left of it; forces on the workpiece.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::arcs::EngagedArcs;
use super::flutes::Flutes;
use super::machine::Machine;
use super::setup::Cut;

/// A dynamometer with its amplifier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dynamometer {
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of a sample, N.
    pub noise_n: f64,
    /// Drift of x and y, N/s.
    pub drift_n_per_s: [f64; 2],
    /// Zero of x and y when the record begins, N.
    pub zero_n: [f64; 2],
    /// Corner frequency of the low-pass (first order), Hz.
    pub low_pass_hz: f64,
    /// Standard deviation by which the force of a cut made again differs, as a share of it; x and y by themselves.
    pub repeatability: f64,
    /// Air before and after, and the cut, s.
    pub air_s: f64,
    /// The cut, s.
    pub cut_s: f64,
}

impl Default for Dynamometer {
    fn default() -> Self {
        Self {
            rate_hz: 10_000.0,
            noise_n: 2.0,
            drift_n_per_s: [1.5, -1.0],
            zero_n: [4.0, -3.0],
            low_pass_hz: 2_000.0,
            repeatability: 0.02,
            air_s: 0.3,
            cut_s: 1.0,
        }
    }
}

impl Dynamometer {
    /// Samples of x and y, N, of a straight cut at the allowance and the feed of `cut`; `number` tells repeated cuts apart.
    pub fn record(&self, cut: &Cut, machine: &Machine, climb: bool, number: u64) -> Vec<[f64; 2]> {
        let mut chance = ChaCha8Rng::seed_from_u64(machine.seed);
        chance.set_stream(100 + number);
        let mut normal = || -> f64 { StandardNormal.sample(&mut chance) };
        let level = [normal(), normal()].map(|drawn| 1.0 + self.repeatability * drawn);
        let phase = TAU * normal();
        let flutes = Flutes::new(cut, machine, climb, cut.feed_mm_per_min);
        let arcs = EngagedArcs::up_to((1.0 - cut.allowance_mm / cut.radius_mm).clamp(-1.0, 1.0).acos());
        let sense = if climb { -1.0 } else { 1.0 };
        let turn = TAU * cut.spindle_rpm / 60.0 / self.rate_hz;
        let keep = (-TAU * self.low_pass_hz / self.rate_hz).exp();
        let [air, cutting] = [self.air_s, self.cut_s].map(|s| (s * self.rate_hz).round() as usize);
        let mut passed = [0.0; 2];
        (0..2 * air + cutting)
            .map(|n| {
                let force = if n < air || n >= air + cutting {
                    [0.0; 2]
                } else {
                    let [normal, along] =
                        flutes.at_immersion(0, sense * (phase + turn * n as f64).rem_euclid(TAU), &arcs, 1.0);
                    // The wall lies on the right in climb milling; the workpiece feels the opposite of the tool.
                    [-level[0] * along, -level[1] * sense * normal]
                };
                let time = n as f64 / self.rate_hz;
                std::array::from_fn(|k| {
                    passed[k] = keep * passed[k] + (1.0 - keep) * force[k];
                    passed[k] + self.zero_n[k] + self.drift_n_per_s[k] * time + self.noise_n * normal()
                })
            })
            .collect()
    }

    /// A record as DynoWare exports it.
    pub fn text(&self, samples: &[[f64; 2]]) -> String {
        let mut text = format!(
            "DynoWare,virtual\nSampling rate [Hz]:,{}\nSamples per channel:,{}\nTime,Fx,Fy\ns,N,N\n",
            self.rate_hz,
            samples.len()
        );
        for (n, [x, y]) in samples.iter().enumerate() {
            text += &format!("{:.5},{x:.3},{y:.3}\n", n as f64 / self.rate_hz);
        }
        text
    }
}
