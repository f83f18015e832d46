//! What the points leave open beside the model along a contour: by it further places are chosen.

use truepath_core::cut::Path;
use truepath_core::job;

use super::average::Discrepancy;
use super::evidence::Factored;
use super::feature::Feature;

/// Places at most at which what is beside the model is looked at.
const PLACES: usize = 120;
/// Kernels that count, the most probable first.
const KERNELS: usize = 12;

/// Covariance of what is open.
#[derive(Clone, Debug)]
pub struct Open {
    /// Places of the contour, mm along it, ascending.
    pub places_mm: Vec<f64>,
    /// Of the discrepancy at the places, mm².
    pub covariance: Vec<Vec<f64>>,
}

impl Open {
    /// The place nearest to one along the contour, mm; `None` without any.
    pub fn nearest(&self, s_mm: f64) -> Option<usize> {
        let behind = self.places_mm.partition_point(|place| *place < s_mm);
        let near = [behind.checked_sub(1), Some(behind)].into_iter().flatten();
        let way = |at: &usize| self.places_mm.get(*at).map_or(f64::INFINITY, |place| (place - s_mm).abs());
        near.filter(|at| *at < self.places_mm.len()).min_by(|a, b| way(a).total_cmp(&way(b)))
    }
}

impl Discrepancy {
    /// What its points leave open along a contour that is cut as `core` has it.
    pub fn open(&self, path: &Path, contour: usize, core: &job::Identified) -> Open {
        let beside = self.features(path, contour, core);
        let stride = beside.len().div_ceil(PLACES).max(1);
        let places: Vec<Feature> = beside.into_iter().step_by(stride).collect();
        let mut covariance = vec![vec![0.0; places.len()]; places.len()];
        let mut kernels: Vec<&(f64, Factored)> = self.kernels().iter().collect();
        kernels.sort_by(|a, b| b.0.total_cmp(&a.0));
        kernels.truncate(KERNELS);
        let all: f64 = kernels.iter().map(|(share, _)| share).sum();
        for (share, factored) in kernels {
            let lasting = |a: &Feature, b: &Feature| factored.kernel.lasting(self.extents(), a, b);
            let known = |place: &Feature| {
                let with_rows: Vec<f64> =
                    self.rows().map(|row| row.lasting(&factored.kernel, self.extents(), place)).collect();
                factored.halfway(&with_rows)
            };
            let known: Vec<Vec<f64>> = places.iter().map(known).collect();
            for ((row, a), known_of_a) in covariance.iter_mut().zip(&places).zip(&known) {
                for ((entry, b), known_of_b) in row.iter_mut().zip(&places).zip(&known) {
                    let by_points: f64 = known_of_a.iter().zip(known_of_b).map(|(a, b)| a * b).sum();
                    *entry += share / all * (lasting(a, b) - by_points);
                }
            }
        }
        Open { places_mm: places.iter().map(|place| place.s).collect(), covariance }
    }
}
