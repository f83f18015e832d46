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
pub struct Chance(Drawn);

/// Where a chance comes from.
#[derive(Clone, Debug)]
enum Drawn {
    /// A seed; it never ends.
    Seed(Box<ChaCha8Rng>),
    /// Bytes that somebody else chose, and how many of them are used.
    Tape(Vec<u8>, usize),
}

impl Chance {
    /// The sequence of a seed; `stream` tells apart what draws from the same seed.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self(Drawn::Seed(Box::new(rng)))
    }
    /// Chances read off bytes, two or four for each; zeros behind their end.
    pub fn taped(bytes: &[u8]) -> Self {
        Self(Drawn::Tape(bytes.to_vec(), 0))
    }
    /// Whether the bytes have come to their end.
    pub const fn is_over(&self) -> bool {
        match &self.0 {
            Drawn::Seed(_) => false,
            Drawn::Tape(bytes, used) => *used >= bytes.len(),
        }
    }
    fn word(&mut self) -> u32 {
        match &mut self.0 {
            Drawn::Seed(rng) => rng.next_u32(),
            Drawn::Tape(bytes, used) => u32::from_le_bytes(taken(bytes, used)),
        }
    }
    fn long_word(&mut self) -> u64 {
        match &mut self.0 {
            Drawn::Seed(rng) => rng.next_u64(),
            // Few bytes for a draw, spread over the range: one byte of the tape decides about much.
            Drawn::Tape(bytes, used) => u64::from(u16::from_le_bytes(taken(bytes, used))).wrapping_mul(SPREAD),
        }
    }
    /// Whether something of this probability happens. A probability of 0 draws nothing.
    pub fn happens(&mut self, probability: Probability) -> bool {
        probability.0 > 0 && u64::from(self.word()) < probability.0
    }
    /// One of 0…n − 1; 0 for n = 0.
    pub fn below(&mut self, n: u64) -> u64 {
        // The bias is below n/2⁶⁴.
        if n == 0 { 0 } else { self.long_word() % n }
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
        self.long_word()
    }
}

/// An odd number near 2⁶⁴/φ.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// The next bytes of a tape.
fn taken<const N: usize>(bytes: &[u8], used: &mut usize) -> [u8; N] {
    let mut word = [0; N];
    for (to, byte) in word.iter_mut().zip(bytes.iter().skip(*used)) {
        *to = *byte;
    }
    *used = used.saturating_add(N);
    word
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

    #[test]
    fn a_tape_gives_the_same_chances_again_and_comes_to_an_end() {
        let draws = |bytes: &[u8]| {
            let mut chance = Chance::taped(bytes);
            let draws: Vec<u64> = (0..3).map(|_| chance.below(1_000)).collect();
            (draws, chance.is_over())
        };
        assert_eq!(draws(&[1, 2, 3, 4, 5, 6]), draws(&[1, 2, 3, 4, 5, 6]));
        assert_ne!(draws(&[1, 2, 3, 4, 5, 6]).0, draws(&[1, 2, 3, 4, 5, 7]).0);
        assert!(draws(&[9; 6]).1 && !draws(&[9; 8]).1 && draws(&[]) == (vec![0; 3], true));
        assert!(!Chance::new(1, 0).is_over());
    }
}
