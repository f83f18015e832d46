//! Sets of immersion angles: the parts of the cutter's circumference that are in the stock.

use std::f64::consts::TAU;

/// Disjoint intervals of immersion φ, ascending, within 0…π rad. φ = 0 points at the wall, φ = π/2 along the travel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EngagedArcs {
    arcs: Vec<[f64; 2]>,
}

/// Shorter leftovers are rounding, rad.
const SLIVER_RAD: f64 = 1e-9;

impl EngagedArcs {
    /// One arc from 0 to `leaving_rad`.
    pub fn up_to(leaving_rad: f64) -> Self {
        Self { arcs: vec![[0.0, leaving_rad]] }
    }

    pub(super) fn from_intervals(arcs: Vec<[f64; 2]>) -> Self {
        Self { arcs }
    }

    /// The intervals, rad.
    pub fn intervals(&self) -> &[[f64; 2]] {
        &self.arcs
    }

    /// φ₁: where the circumference leaves the stock, rad; 0 without engagement.
    pub fn leaving_rad(&self) -> f64 {
        self.arcs.last().map_or(0.0, |a| a[1])
    }

    /// Largest and smallest engaged angle, if any.
    pub(super) fn bounds(&self) -> Option<[f64; 2]> {
        Some([self.arcs.first()?[0], self.arcs.last()?[1]])
    }

    /// Takes the interval out, ends ascending and given in any turn.
    pub(super) fn remove(&mut self, from: f64, to: f64) {
        for shift in [-TAU, 0.0, TAU] {
            let (lo, hi) = (from + shift, to + shift);
            if hi <= 0.0 || lo >= std::f64::consts::PI {
                continue;
            }
            let mut left = Vec::with_capacity(self.arcs.len() + 1);
            for &[a, b] in &self.arcs {
                let parts = [[a, b.min(lo)], [a.max(hi), b]];
                left.extend(parts.into_iter().filter(|p| p[1] - p[0] > SLIVER_RAD));
            }
            self.arcs = left;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn removing_the_middle_leaves_two_arcs() {
        let mut arcs = EngagedArcs::up_to(2.0);
        arcs.remove(0.5 + TAU, 1.0 + TAU);
        assert_eq!(arcs.intervals().len(), 2);
        assert!((arcs.intervals()[0][1] - 0.5).abs() < 1e-12);
        assert!((arcs.intervals()[1][0] - 1.0).abs() < 1e-12);
        assert_eq!(arcs.leaving_rad(), 2.0);
    }

    #[test]
    fn removing_everything_leaves_no_engagement() {
        let mut arcs = EngagedArcs::up_to(2.0);
        arcs.remove(-1.0, 2.5);
        assert!(arcs.intervals().is_empty());
        assert_eq!(arcs.leaving_rad(), 0.0);
    }
}
