//! The allowance along a contour, from places where the stock was touched before the pass.
//!
//! A Gaussian process over the arc length: a level, of which little is believed beforehand, and a deviation from it with a
//! Matérn 3/2 covariance, which allows waves and steps without ringing beside a step as a cubic does. How large the deviation is
//! and over which length it holds the places say: every combination counts by its evidence (Rasmussen & Williams, *Gaussian
//! Processes for Machine Learning*, 2006, ch. 2 and 5). Beyond the first and last place of an open contour the allowance of
//! that place goes on, and its standard deviation grows; a closed contour has no ends.
//!
//! Nothing but arc lengths and allowances enters: a contour that is shifted, turned or mirrored gives the same bits.
//!
//! Limit: alike at every height.

use truepath_ground::cholesky::Cholesky;

/// A touched place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Arc length, mm.
    pub s_mm: f64,
    /// Allowance there, mean over its heights, mm.
    pub allowance_mm: f64,
    /// Standard deviation of that mean, mm.
    pub sigma_mm: f64,
}

/// The allowance along a contour.
#[derive(Clone, Debug)]
pub struct Allowance {
    /// In the order of the contour.
    places: Vec<Place>,
    round: Round,
    nominal_mm: f64,
    level_mm: f64,
    /// What counts, with its share; together 1.
    models: Vec<(f64, Model)>,
}

/// How far two places are apart along the contour.
#[derive(Clone, Copy, Debug)]
struct Round {
    length_mm: f64,
    closed: bool,
}

impl Round {
    /// Along an open contour the arc length; on a closed one the chord of a circle as long, on which a covariance of the
    /// distance stays one.
    fn way(self, a: f64, b: f64) -> f64 {
        let way = (a - b).abs();
        if !self.closed || self.length_mm <= 0.0 {
            return way;
        }
        let diameter = self.length_mm / std::f64::consts::PI;
        diameter * (way.min((self.length_mm - way).abs()) / diameter).sin()
    }
}

/// One size and length of the deviation, and what the places say under it.
#[derive(Clone, Debug)]
struct Model {
    deviation_mm: f64,
    reach_mm: f64,
    factor: Cholesky,
    /// Covariance⁻¹ times the deviations of the places from the nominal allowance.
    weights: Vec<f64>,
}

/// What is believed of the level of the allowance beforehand: the nominal one, with this standard deviation as a share of it.
const LEVEL: f64 = 0.5;
/// Standard deviations of what is uneven that are tried, as shares of the nominal allowance.
const DEVIATIONS: [f64; 6] = [0.003, 0.01, 0.03, 0.08, 0.2, 0.4];
/// Lengths over which it holds that are tried, in mean distances of the places.
const REACHES: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Models less probable than this share of the best count for nothing.
const NEGLIGIBLE: f64 = 1e-3;

fn matern(way: f64, reach: f64) -> f64 {
    let x = 3f64.sqrt() * way / reach;
    (1.0 + x) * (-x).exp()
}

impl Model {
    fn covariance(&self, way: f64, level_mm: f64) -> f64 {
        level_mm * level_mm + self.deviation_mm.powi(2) * matern(way, self.reach_mm)
    }
}

impl Allowance {
    /// From places in the order of a contour of a length, mm, around a nominal allowance above 0, mm; `None` for fewer
    /// than two places.
    pub fn new(places: Vec<Place>, (length_mm, closed): (f64, bool), nominal_mm: f64) -> Option<Self> {
        if places.len() < 2 {
            return None;
        }
        let round = Round { length_mm, closed };
        let level_mm = LEVEL * nominal_mm;
        let apart_mm = length_mm / places.len() as f64;
        let right: Vec<f64> = places.iter().map(|place| place.allowance_mm - nominal_mm).collect();
        let mut models: Vec<(f64, Model)> = Vec::new();
        for (share, reach) in DEVIATIONS.iter().flat_map(|d| REACHES.iter().map(move |r| (d, r))) {
            let (deviation_mm, reach_mm) = (share * nominal_mm, reach * apart_mm);
            let covariance = |i: usize, j: usize| {
                let way = round.way(places[i].s_mm, places[j].s_mm);
                let noise = if i == j { places[i].sigma_mm.powi(2) } else { 0.0 };
                level_mm * level_mm + deviation_mm.powi(2) * matern(way, reach_mm) + noise
            };
            let lower: Vec<Vec<f64>> = (0..places.len()).map(|i| (0..=i).map(|j| covariance(i, j)).collect()).collect();
            let Some(factor) = Cholesky::new(&lower) else { continue };
            let weights = factor.solve(&right);
            let fit: f64 = right.iter().zip(&weights).map(|(y, w)| y * w).sum();
            let evidence = -0.5 * (fit + factor.ln_determinant());
            models.push((evidence, Model { deviation_mm, reach_mm, factor, weights }));
        }
        let best = models.iter().map(|(evidence, _)| *evidence).fold(f64::NEG_INFINITY, f64::max);
        models.iter_mut().for_each(|(evidence, _)| *evidence = (*evidence - best).exp());
        models.retain(|(share, _)| *share >= NEGLIGIBLE);
        let all: f64 = models.iter().map(|(share, _)| share).sum();
        models.iter_mut().for_each(|(share, _)| *share /= all);
        (!models.is_empty()).then_some(Self { places, round, nominal_mm, level_mm, models })
    }

    /// The places it follows from, in the order of the contour.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The allowance at an arc length, mm.
    pub fn at(&self, s_mm: f64) -> f64 {
        let s = self.within(s_mm);
        let one = |(share, model): &(f64, Model)| share * self.expected(model, s);
        self.nominal_mm + self.models.iter().map(one).sum::<f64>()
    }

    /// Standard deviation of the allowance at an arc length, mm.
    pub fn sigma_at(&self, s_mm: f64) -> f64 {
        let mean = self.at(s_mm) - self.nominal_mm;
        let held = self.within(s_mm);
        let mut variance = 0.0;
        for (share, model) in &self.models {
            let halfway = model.factor.halfway(&self.with_places(model, s_mm));
            let own = model.covariance(0.0, self.level_mm) - halfway.iter().map(|v| v * v).sum::<f64>();
            variance += share * (own.max(0.0) + (self.expected(model, held) - mean).powi(2));
        }
        variance.sqrt()
    }

    /// What a model expects beyond the nominal allowance, mm.
    fn expected(&self, model: &Model, s_mm: f64) -> f64 {
        self.with_places(model, s_mm).iter().zip(&model.weights).map(|(k, w)| k * w).sum()
    }

    /// Covariances of an arc length with the places, mm².
    fn with_places(&self, model: &Model, s_mm: f64) -> Vec<f64> {
        let with = |place: &Place| model.covariance(self.round.way(place.s_mm, s_mm), self.level_mm);
        self.places.iter().map(with).collect()
    }

    /// The same arc length, or the outermost place of an open contour.
    fn within(&self, s_mm: f64) -> f64 {
        match (self.places.first(), self.places.last()) {
            (Some(first), Some(last)) if !self.round.closed => s_mm.clamp(first.s_mm, last.s_mm),
            _ => s_mm,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const LENGTH: f64 = 100.0;

    fn of(count: u32, closed: bool, allowance: impl Fn(f64) -> f64) -> Allowance {
        let step = LENGTH / f64::from(count);
        let places = (0..count).map(|k| (f64::from(k) + 0.5) * step);
        let place = |s_mm: f64| Place { s_mm, allowance_mm: allowance(s_mm), sigma_mm: 0.001 };
        Allowance::new(places.map(place).collect(), (LENGTH, closed), 1.0).expect("places")
    }

    /// Largest deviation from what is true along the contour, mm.
    fn off(found: &Allowance, (from, to): (u32, u32), allowance: impl Fn(f64) -> f64) -> f64 {
        (from..=to).map(f64::from).map(|s| (found.at(s) - allowance(s)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn waves_of_a_quarter_come_back_within_a_hundredth() {
        let waves = |s: f64| 1.0 + 0.25 * (TAU * s / 50.0).sin();
        for closed in [false, true] {
            let found = of(16, closed, waves);
            assert!(off(&found, (4, 96), waves) < 0.01, "{}", off(&found, (4, 96), waves));
        }
        // Round the seam as well.
        assert!(off(&of(16, true, waves), (0, 100), waves) < 0.01);
    }

    #[test]
    fn even_stock_is_even_whatever_its_level() {
        let found = of(12, false, |_| 1.3);
        assert!(off(&found, (0, 100), |_| 1.3) < 1e-3);
        assert!((0..100).all(|s| found.sigma_at(f64::from(s)) < 0.006));
    }

    #[test]
    fn a_step_is_overshot_by_less_than_an_eighth_of_it_and_lies_between_its_places() {
        let step = |s: f64| if s < 50.0 { 1.0 } else { 1.25 };
        let found = of(20, false, step);
        for s in (0..=100).map(f64::from) {
            assert!((0.97..=1.28).contains(&found.at(s)), "{s}: {}", found.at(s));
        }
        assert!(off(&found, (0, 46), step) < 0.03 && off(&found, (54, 100), step) < 0.03);
        // Nobody knows where between two places it is.
        assert!(found.sigma_at(50.0) > 3.0 * found.sigma_at(47.5));
    }

    #[test]
    fn two_standard_deviations_hold_the_truth() {
        let (mut held, mut all) = (0, 0);
        for wave in [24.0, 31.0, 47.0, 80.0] {
            let waves = |s: f64| 1.0 + 0.2 * (TAU * s / wave + 0.3).sin();
            let found = of(14, false, waves);
            for s in (0..=200).map(|k| f64::from(k) / 2.0) {
                all += 1;
                held += i32::from((found.at(s) - waves(s)).abs() <= 2.0 * found.sigma_at(s));
            }
        }
        assert!(f64::from(held) > 0.9 * f64::from(all), "{held} of {all}");
    }

    #[test]
    fn beyond_its_ends_the_allowance_goes_on_and_is_less_certain() {
        let ramp = |s: f64| 1.0 + 0.002 * s;
        let places = [30.0, 40.0, 50.0, 60.0].map(|s_mm| Place { s_mm, allowance_mm: ramp(s_mm), sigma_mm: 0.001 });
        let found = Allowance::new(places.to_vec(), (LENGTH, false), 1.0).expect("places");
        assert_eq!(found.at(0.0).to_bits(), found.at(30.0).to_bits());
        assert!(found.sigma_at(0.0) > 2.0 * found.sigma_at(30.0));
        assert!(Allowance::new(places[..1].to_vec(), (LENGTH, false), 1.0).is_none());
    }
}
