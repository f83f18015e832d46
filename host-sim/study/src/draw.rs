//! Chance of the study: numbers drawn from stated ranges, the same on every run and every computer.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// A source of numbers.
#[derive(Clone, Debug)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// The numbers of a seed under a name: another name gives unrelated ones.
    pub fn new(name: &str, seed: u64) -> Self {
        // FNV-1a, 64 bits: stable for ever, unlike the standard library's hash.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        Self(ChaCha8Rng::seed_from_u64(hash ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// Evenly from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * share
    }

    /// Evenly from `low` to `high`, in steps of `step`, as a person chooses.
    pub fn round(&mut self, low: f64, high: f64, step: f64) -> f64 {
        rounded(self.between(low, high), step)
    }

    /// Evenly in the logarithm from `low` to `high`, both above 0.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Normal with mean 0, cut at twice its standard deviation `sigma`.
    pub fn normal(&mut self, sigma: f64) -> f64 {
        let value: f64 = StandardNormal.sample(&mut self.0);
        sigma * value.clamp(-2.0, 2.0)
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// −1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// One of several.
    ///
    /// # Panics
    /// Never for a list that is not empty.
    pub fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        let index = self.between(0.0, list.len() as f64) as usize;
        list[index.min(list.len() - 1)]
    }

    /// A seed for someone else's chance.
    pub fn seed(&mut self) -> u64 {
        // TOML holds integers of 63 bits.
        self.0.next_u64() >> 2
    }
}

/// A number rounded to a multiple of `step`.
pub fn rounded(value: f64, step: f64) -> f64 {
    // Division by the reciprocal keeps decimal steps decimal.
    let per = 1.0 / step;
    (value * per).round() / per
}
