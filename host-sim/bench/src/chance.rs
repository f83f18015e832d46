//! Seeded chance: the same seed gives the same campaign on every machine.
//!
//! ChaCha with eight rounds, as elsewhere in this program; probabilities are compared as 32-bit integers, so that no
//! float decides about what is sent.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// A probability in steps of 2⁻³².
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Probability(u64);

impl Probability {
    /// Never.
    pub const NEVER: Self = Self(0);

    /// From a number 0…1.
    ///
    /// # Errors
    /// `None` outside that range.
    pub fn new(share: f64) -> Option<Self> {
        (0.0..=1.0).contains(&share).then(|| Self((share * 4_294_967_296.0).round() as u64))
    }
    /// As a number 0…1.
    pub fn share(self) -> f64 {
        self.0 as f64 / 4_294_967_296.0
    }
}

impl std::str::FromStr for Probability {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().ok().and_then(Self::new).ok_or("a probability from 0 to 1")
    }
}

/// A sequence of chances.
#[derive(Clone, Debug)]
pub struct Chance(ChaCha8Rng);

impl Chance {
    /// The sequence of a seed; `stream` tells apart what draws from the same seed.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self(rng)
    }
    /// Whether something of this probability happens. A probability of 0 draws nothing.
    pub fn happens(&mut self, probability: Probability) -> bool {
        probability.0 > 0 && u64::from(self.0.next_u32()) < probability.0
    }
    /// One of 0…n − 1; 0 for n = 0.
    pub fn below(&mut self, n: u64) -> u64 {
        // The bias is below n/2⁶⁴.
        if n == 0 { 0 } else { self.0.next_u64() % n }
    }
    /// One time in n.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }
    /// −m…m.
    pub fn around(&mut self, m: i64) -> i64 {
        self.below(2 * m.unsigned_abs() + 1) as i64 - m
    }
    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probability_holds_and_a_seed_repeats() {
        let tenth = Probability::new(0.1).expect("a probability");
        let count = |seed| {
            let mut chance = Chance::new(seed, 0);
            (0..100_000).filter(|_| chance.happens(tenth)).count()
        };
        // Six standard deviations of a binomial distribution: 6 √(10⁵ · 0.1 · 0.9) = 569.
        assert!(count(1).abs_diff(10_000) < 569);
        assert_eq!(count(7), count(7));
        assert!(Probability::new(1.1).is_none() && Probability::new(-0.1).is_none());
        let mut chance = Chance::new(3, 0);
        assert!((0..1000).all(|_| chance.happens(Probability::new(1.0).expect("certain"))));
    }
}
