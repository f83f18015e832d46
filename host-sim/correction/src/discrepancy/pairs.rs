//! Widths between two contours: each is a pair of readings, one half on either.

use std::collections::HashMap;

use truepath_core::identify::Observation;

/// Which readings are halves of one.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    others: Vec<Option<usize>>,
}

impl Pairs {
    /// Among readings in their order.
    pub(super) fn of<'o>(observations: impl Iterator<Item = &'o Observation>) -> Self {
        let mut others = Vec::new();
        let mut first: HashMap<u32, usize> = HashMap::new();
        for (at, observation) in observations.enumerate() {
            let half = observation.pair().and_then(|pair| first.insert(pair, at));
            others.push(half);
            if let Some(half) = half {
                others[half] = Some(at);
            }
        }
        Self { others }
    }

    /// The place of the other half of a reading; `None` of one that is whole.
    pub(super) fn other(&self, at: usize) -> Option<usize> {
        self.others.get(at).copied().flatten()
    }

    /// Gives both halves of every pair the mean of their values.
    pub(super) fn join(&self, values: &mut [f64]) {
        for (at, other) in self.others.iter().enumerate() {
            let Some(other) = other.filter(|other| *other > at) else { continue };
            let mean = 0.5 * (values[at] + values[other]);
            (values[at], values[other]) = (mean, mean);
        }
    }
}
