//! How sure the predicted errors of a wall are.
//!
//! The wall is cut as it was designed by the machines that lie one standard deviation away from the identified one, all passes of it
//! in order; the changes of the wall are the columns of its covariance. Walls are drawn from it, and the largest error of each is
//! what a part of this machine might show.
//!
//! What the model lacks stands among these machines: parameters are known no better than to a few percent, whatever the points say
//! ([`unmodelled`](super::unmodelled)). Noise of the surface and what the machine does not repeat come on top.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use truepath_core::cut::Path;
use truepath_core::process::Slices;
use truepath_core::units::Offset;
use truepath_ground::rows::{Weighable, add, add_scaled, largest};
use truepath_ground::units::mm;

use super::causes::Causes;
use super::wall::judged;

/// Walls drawn.
const DRAWN: usize = 400;

/// The predicted profile error.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Predicted {
    /// Its mean over the machines that the points allow, mm.
    pub profile_mm: f64,
    /// Its standard deviation, mm.
    pub sigma_mm: f64,
}

/// A predicted wall with what is not known of it; errors in mm, place by place, all heights of a place side by side.
#[derive(Clone, Debug, Default)]
pub struct Uncertain {
    /// Heights of a place.
    pub heights: usize,
    /// The errors as the identified machine leaves them.
    pub base: Vec<f64>,
    /// What noise and number of the points leave open: how each machine one standard deviation away changes them.
    pub noise: Vec<Vec<f64>>,
    /// What the model lacks, the same way.
    pub lacking: Vec<Vec<f64>>,
    /// How a cutter that does not bend changes them; empty where that is nothing.
    pub unbent: Vec<f64>,
    /// Standard deviation of what parts show beside the model.
    pub beside: Option<Beside>,
}

/// The standard deviation of what parts show beside the model. It has one value for every place, and is alike within a stretch.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    /// Arc length of every place and the standard deviation that is the same at all its heights, mm.
    pub places: Vec<(f64, f64)>,
    /// That of another load at every height of every place, mm: its sign says which way the wall moves there. Empty for nowhere.
    pub load: Vec<f64>,
    /// Length of a stretch, mm, above 0.
    pub reach_mm: f64,
}

impl Uncertain {
    /// Of a wall and the walls of each machine one standard deviation away, with the share of its change: those that the points do
    /// not tell apart, and those that a model does not; and the wall of a cutter that does not bend, where it is another.
    pub fn of(
        (path, slices): (&Path, Slices),
        left: &[Offset],
        noise: &[(Vec<Offset>, f64)],
        lacking: &[Vec<Offset>],
        unbent: Option<&[Offset]>,
    ) -> Self {
        let count = slices.count();
        let places: Vec<(usize, f64)> = judged(path).collect();
        let column = |field: &[Offset]| -> Vec<f64> {
            let heights = |(index, _): &(usize, f64)| field[index * count..(index + 1) * count].iter().map(|e| mm(*e));
            places.iter().flat_map(heights).collect()
        };
        let base = column(left);
        let change = |field: &[Offset], share: f64| -> Vec<f64> {
            column(field).iter().zip(&base).map(|(c, b)| (c - b) * share).collect()
        };
        let noise = noise.iter().map(|(field, share)| change(field, *share)).collect();
        let lacking = lacking.iter().map(|field| change(field, 1.0)).collect();
        let unbent = unbent.map(|field| change(field, 1.0)).unwrap_or_default();
        Self { heights: count, base, noise, lacking, unbent, beside: None }
    }

    /// What makes one of the errors.
    pub fn causes_at(&self, at: usize) -> Causes {
        let (place, height) = (at / self.heights.max(1), at % self.heights.max(1));
        let of_place = place * self.heights..(place + 1) * self.heights;
        let column = self.base.get(of_place.clone()).unwrap_or_default();
        let unbent = self.unbent.get(of_place).unwrap_or_default().iter().chain(std::iter::repeat(&0.0));
        let unbent: Vec<f64> = column.iter().zip(unbent).map(|(error, change)| error + change).collect();
        let [noise_mm, not_modelled_mm] = self.sigma_at(at);
        Causes { noise_mm, not_modelled_mm, ..Causes::of(column, &unbent, height) }
    }

    /// Standard deviations of one of the errors, mm: from the points, and from what is not modelled.
    fn sigma_at(&self, at: usize) -> [f64; 2] {
        let square = |columns: &[Vec<f64>]| -> f64 { columns.iter().filter_map(|c| c.get(at)).map(|c| c * c).sum() };
        let beside = self.beside.as_ref().map_or(0.0, |beside| {
            let even =
                at.checked_div(self.heights).and_then(|place| beside.places.get(place)).map_or(0.0, |place| place.1);
            together(even, beside.load.get(at).copied().unwrap_or_default())
        });
        [square(&self.noise).sqrt(), together(square(&self.lacking).sqrt(), beside)]
    }

    /// Draws the largest error.
    pub fn largest(&self) -> Draws {
        let [draws] = self.draws(|wall| [largest(wall)]);
        draws
    }

    /// Draws quantities of the wall, which are given the errors of each.
    pub fn draws<const N: usize>(&self, mut of: impl FnMut(&[f64]) -> [f64; N]) -> [Draws; N] {
        // The machines do not depend on each other, nor on what the model lacks; a seed keeps a prediction what it is.
        let mut random = ChaCha8Rng::seed_from_u64(19);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let columns = || self.noise.iter().chain(&self.lacking);
        let changes = Weighable::of(columns().map(Vec::as_slice), self.base.len());
        let mut wall = self.base.clone();
        let mut draws = std::array::from_fn(|_| Draws(Vec::with_capacity(DRAWN)));
        for _ in 0..DRAWN {
            wall.clone_from(&self.base);
            changes.add(&mut wall, &columns().map(|_| normal()).collect::<Vec<f64>>());
            if let Some(beside) = &self.beside {
                beside.draw(self.heights, &mut wall, &mut normal);
            }
            draws.iter_mut().zip(of(&wall)).for_each(|(draws, value)| draws.0.push(value));
        }
        draws
    }
}

impl Beside {
    /// Adds one draw of it.
    fn draw(&self, heights: usize, wall: &mut [f64], normal: &mut impl FnMut() -> f64) {
        let heights = heights.max(1);
        let even = self.along(normal);
        for ((column, (_, sigma)), share) in wall.chunks_mut(heights).zip(&self.places).zip(even) {
            add(column, sigma * share);
        }
        if self.load.is_empty() {
            return;
        }
        let by_load = self.along(normal);
        for ((column, sigmas), share) in wall.chunks_mut(heights).zip(self.load.chunks(heights)).zip(by_load) {
            add_scaled(column, sigmas, share);
        }
    }

    /// Standard deviations from nothing, one for every place, alike within a stretch.
    fn along(&self, normal: &mut impl FnMut() -> f64) -> Vec<f64> {
        let end = self.places.iter().map(|(s, _)| *s).fold(0.0, f64::max);
        let knots: Vec<f64> = (0..=(end / self.reach_mm) as usize + 1).map(|_| normal()).collect();
        let at = |(s, _): &(f64, f64)| {
            let (knot, u) = ((s / self.reach_mm) as usize, (s / self.reach_mm).fract());
            let [before, behind] = [knot, knot + 1].map(|k| knots.get(k).copied().unwrap_or_default());
            // Between two knots the deviation is that at them.
            (before * (1.0 - u) + behind * u) / together(1.0 - u, u)
        };
        self.places.iter().map(at).collect()
    }
}

/// Two deviations together; the `hypot` of a browser has other last bits than that of a system.
fn together(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// Draws of a quantity.
#[derive(Clone, Debug)]
pub struct Draws(Vec<f64>);

impl Draws {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_of_one_place_is_the_root_of_the_sum_of_squares_of_all_that_is_not_known() {
        let (places, load) = (vec![(0.0, 0.0), (5.3, 0.012)], vec![0.0, 0.0, -0.005, 0.001]);
        let beside = Beside { places, load, reach_mm: 2.0 };
        let wall = Uncertain {
            heights: 2,
            unbent: Vec::new(),
            base: vec![0.0, 0.0, 0.2, 0.1],
            noise: vec![vec![0.0, 0.0, 0.003, 0.0]],
            lacking: vec![vec![0.0, 0.0, 0.004, 0.0]],
            beside: Some(beside),
        };
        let [noise, not_modelled] = wall.sigma_at(2);
        assert!((noise - 0.003).abs() < 1e-12 && (not_modelled - 0.004f64.hypot(0.013)).abs() < 1e-12);
        // Far from zero the largest error is this one in every draw: mean 0.2, deviation 0.0139.
        let drawn = wall.largest().predicted();
        assert!((drawn.profile_mm - 0.2).abs() < 0.002 && (drawn.sigma_mm - 0.0139).abs() < 0.0013, "{drawn:?}");
        assert!((wall.largest().within(0.2) - 0.5).abs() < 0.08);
    }
}
