//! The stock that points show: by how much the allowance is larger along a contour than the job says.

use truepath_ground::rows::ascending;

use super::evidence::Factored;
use super::kernel::{Extent, matern};
use super::points::Row;

/// Share of the allowance by which it is expected to be larger or smaller at most.
const MOST: f64 = 0.6;

/// Expected allowance along the contours, beside that of the job.
#[derive(Clone, Debug, Default)]
pub(super) struct Allowance {
    terms: Vec<Term>,
}

/// What a row says of the allowance around it.
#[derive(Clone, Copy, Debug)]
struct Term {
    contour: usize,
    /// Arc length of the row, mm.
    s: f64,
    /// Length over which it holds, in cutter radii.
    reach: f64,
    /// What it says at its own place, mm.
    more: f64,
}

impl Allowance {
    /// By kernels with their shares and the rows that they are of.
    pub(super) fn of(kernels: &[(f64, Factored)], rows: &[&Row], extents: &[Extent]) -> Self {
        let mut reaches: Vec<f64> = kernels.iter().map(|(_, of)| of.kernel.stock_reach).collect();
        ascending(&mut reaches);
        reaches.dedup();
        let mut terms = Vec::new();
        for reach in reaches {
            let over = || kernels.iter().filter(|(_, of)| of.kernel.stock > 0.0 && of.kernel.stock_reach == reach);
            for (k, row) in rows.iter().enumerate() {
                let weight: f64 = over().map(|(share, of)| share * of.kernel.stock.powi(2) * of.weights[k]).sum();
                if weight == 0.0 {
                    continue;
                }
                let part = if row.across.is_some() { 0.5 } else { 1.0 };
                for feature in std::iter::once(&row.feature).chain(&row.across) {
                    let allowance = extents.get(feature.contour).map_or(0.0, |extent| extent.allowance);
                    let more = part * weight * feature.stock * allowance.powi(2);
                    terms.push(Term { contour: feature.contour, s: feature.s, reach, more });
                }
            }
        }
        Self { terms }
    }

    /// Whether it is that of the job everywhere.
    pub(super) const fn is_even(&self) -> bool {
        self.terms.is_empty()
    }

    /// By how much it is larger at a place, mm along a contour, mm.
    pub(super) fn more(&self, extents: &[Extent], contour: usize, s: f64) -> f64 {
        let Some(extent) = extents.get(contour) else { return 0.0 };
        let own = self.terms.iter().filter(|term| term.contour == contour);
        let says = |term: &Term| term.more * matern(extent.way(s, term.s), term.reach * extent.radius);
        let most = MOST * extent.allowance;
        own.map(says).sum::<f64>().clamp(-most, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(closed: bool) -> Extent {
        Extent { length: 100.0, closed, radius: 5.0, allowance: 0.5 }
    }

    fn shown(more: f64) -> Allowance {
        Allowance { terms: vec![Term { contour: 0, s: 2.0, reach: 2.5, more }] }
    }

    #[test]
    fn what_a_row_says_holds_around_it_and_beyond_the_seam_of_a_closed_contour() {
        let more = |closed, s| shown(0.1).more(&[extent(closed)], 0, s);
        assert!((more(false, 2.0) - 0.1).abs() < 1e-12);
        assert!(more(false, 12.0) < more(false, 7.0) && more(false, 7.0) < 0.1 && more(false, 98.0) < 1e-4);
        assert!((more(true, 98.0) - more(true, 6.0)).abs() < 1e-6, "four millimetres to either side");
        assert_eq!(shown(0.1).more(&[extent(false); 2], 1, 2.0), 0.0, "another contour");
    }

    #[test]
    fn no_more_stock_is_expected_than_there_can_be() {
        assert_eq!(shown(4.0).more(&[extent(false)], 0, 2.0), 0.3);
        assert_eq!(shown(-4.0).more(&[extent(false)], 0, 2.0), -0.3);
        assert!(Allowance::default().is_even() && Allowance::default().more(&[extent(false)], 0, 2.0) == 0.0);
    }
}
