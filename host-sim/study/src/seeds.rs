//! Seeds of the study. What is tuned is tuned on the one set and judged on the other.
//!
//! A seed together with the name of a family fixes a case: geometry, machine, the user's beliefs, probe places and every
//! chance of cutting and probing. The sets have no seed in common, and no seed is left out of a set because of how its
//! cases come out.

use std::ops::Range;

/// Which seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Set {
    /// Seen while the method is being improved.
    Tuning,
    /// Looked at only to state what it does.
    Test,
    /// Wholly random machines, for the statement that nothing is ever made worse.
    Random,
}

impl Set {
    /// The seeds of the set, in the order in which they are used.
    pub const fn seeds(self) -> Range<u64> {
        match self {
            Self::Tuning => 1_001..1_101,
            Self::Test => 7_001..7_101,
            Self::Random => 100_000..1_000_000,
        }
    }

    /// Its name on the command line and in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tuning => "tuning",
            Self::Test => "test",
            Self::Random => "random",
        }
    }

    /// The set a seed belongs to.
    pub fn of(seed: u64) -> Option<Self> {
        [Self::Tuning, Self::Test, Self::Random].into_iter().find(|set| set.seeds().contains(&seed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_seed_is_in_two_sets() {
        let sets = [Set::Tuning, Set::Test, Set::Random];
        for (k, a) in sets.iter().enumerate() {
            for b in &sets[k + 1..] {
                let (a, b) = (a.seeds(), b.seeds());
                assert!(a.end <= b.start || b.end <= a.start, "{a:?} and {b:?}");
            }
        }
    }
}
