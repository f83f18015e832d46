//! How sure the predicted error of a process is.
//!
//! The process is run as it was designed by the machines that lie one standard deviation away from the identified one, all its
//! passes in order; the changes of the wall are the columns of its covariance. Walls are drawn from it, and the largest error of each is
//! what a part of this machine might show.
//!
//! What the model lacks stands among these machines: parameters are known no better than to a few percent, whatever the points say
//! (see [`super::choice`]). Noise of the surface and what the machine does not repeat come on top.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use truepath_core::process::Slices;
use truepath_core::units::Offset;
use truepath_ground::units::mm;

use super::wall::judged;
use truepath_core::cut::Path;

/// Walls drawn.
const DRAWN: usize = 400;

/// The predicted profile error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Predicted {
    /// Its mean over the machines that the points allow, mm.
    pub profile_mm: f64,
    /// Its standard deviation, mm.
    pub sigma_mm: f64,
}

/// Draws of the profile error of a process.
#[derive(Clone, Debug)]
pub struct Draws(Vec<f64>);

impl Draws {
    /// Of a wall and the walls of each machine one standard deviation away, with the share of its change.
    pub fn of((path, slices): (&Path, Slices), left: &[Offset], changed: &[(Vec<Offset>, f64)]) -> Self {
        let count = slices.count();
        let places: Vec<(usize, f64)> = judged(path).collect();
        let column = |field: &[Offset]| -> Vec<f64> {
            let heights = |(index, _): &(usize, f64)| field[index * count..(index + 1) * count].iter().map(|e| mm(*e));
            places.iter().flat_map(heights).collect()
        };
        let base = column(left);
        let changes: Vec<Vec<f64>> = changed
            .iter()
            .map(|(field, share)| column(field).iter().zip(&base).map(|(c, b)| (c - b) * share).collect())
            .collect();
        // The machines do not depend on each other, nor on what the model lacks; a seed keeps a plan what it is.
        let mut random = ChaCha8Rng::seed_from_u64(19);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let draws = (0..DRAWN).map(|_| {
            let weights: Vec<f64> = changes.iter().map(|_| normal()).collect();
            let moved = |at: usize| changes.iter().zip(&weights).map(|(change, w)| change[at] * w).sum::<f64>();
            base.iter().enumerate().map(|(at, error)| (error + moved(at)).abs()).fold(0.0, f64::max)
        });
        Self(draws.collect())
    }

    /// Mean and standard deviation.
    pub fn predicted(&self) -> Predicted {
        let count = self.0.len().max(1) as f64;
        let mean = self.0.iter().sum::<f64>() / count;
        let square = self.0.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / count;
        Predicted { profile_mm: mean, sigma_mm: square.sqrt() }
    }

    /// The share of machines whose wall is within a tolerance of half width, mm.
    pub fn within(&self, tolerance_mm: f64) -> f64 {
        self.0.iter().filter(|d| **d <= tolerance_mm).count() as f64 / self.0.len().max(1) as f64
    }
}
