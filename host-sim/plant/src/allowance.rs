//! The allowance on the wall along the contour, as the passes before this one have left it.
//!
//! Waves, a step and more stock in inside corners are what roughing leaves: chance of their own (`seed` of [`UnevenStock`]), so that
//! they repeat from part to part. The level is of this part. The absolute variation of [`Machine`] is of its blank.
//!
//! Limit: alike at every height. A measured surface ([`Cut`]) takes the place of all this.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::machine::Machine;
use super::path::{Path, Side};
use super::setup::Cut;
use super::uneven_stock::UnevenStock;
use super::vector::turn;

/// A step rises over this way, mm: a cutter leaves none that is steeper.
const STEP_MM: f64 = 1.0;

/// The allowance at every place of a contour.
pub(super) struct Allowance {
    nominal_mm: f64,
    /// Of the blank, mm.
    variation: Waves,
    uneven: UnevenStock,
    /// Of the roughing, largest value on the contour 1.
    waves: Waves,
    bend: Bend,
}

impl Allowance {
    pub(super) fn new(path: &Path, cut: &Cut, machine: &Machine) -> Self {
        let uneven = machine.stock;
        let variation = Waves::new((machine.seed, 1), machine.stock_wavelength_mm, machine.stock_variation_mm);
        let mut waves = Waves::new((uneven.seed, 5), uneven.wavelength_mm, 1.0);
        waves.fill(&path.s_mm);
        let bend = Bend::new(path, 0.5 * cut.radius_mm);
        Self { nominal_mm: cut.allowance_mm, variation, uneven, waves, bend }
    }

    /// Along the normal, mm.
    pub(super) fn at(&self, s_mm: f64) -> f64 {
        self.nominal_mm + (self.variation.at(s_mm) + self.nominal_mm * self.share(s_mm))
    }

    /// What is uneven, as a share of the nominal value.
    fn share(&self, s_mm: f64) -> f64 {
        let UnevenStock { waves, step, step_from_mm, corner, level, .. } = self.uneven;
        let stepped = ((s_mm - step_from_mm) / STEP_MM + 0.5).clamp(0.0, 1.0);
        let mut share = step * stepped + level;
        if waves > 0.0 {
            share += waves * self.waves.at(s_mm);
        }
        if corner.abs() > 0.0 {
            share += corner * self.bend.at(s_mm).clamp(0.0, 1.0);
        }
        share
    }
}

/// Smooth deviation: a few waves of random phase, never more than the stated amplitude.
struct Waves(Vec<(f64, f64, f64)>);

impl Waves {
    /// Lengths of the waves as multiples of the shortest; not commensurate, so that the sum does not repeat.
    const LENGTHS: [f64; 4] = [1.0, 1.618, 2.639, 4.236];

    fn new((seed, stream): (u64, u64), wavelength_mm: f64, most: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let amplitude = most / Self::LENGTHS.len() as f64;
        let wave = |l: &f64| {
            let phase = TAU * f64::from(rng.next_u32()) / 2f64.powi(32);
            (amplitude, TAU / (l * wavelength_mm), phase)
        };
        Self(Self::LENGTHS.iter().map(wave).collect())
    }

    fn at(&self, s: f64) -> f64 {
        self.0.iter().map(|(a, k, p)| a * (k * s + p).sin()).sum()
    }

    /// Scales them so that the largest magnitude at these places is 1.
    fn fill(&mut self, places_mm: &[f64]) {
        let most = places_mm.iter().map(|s| self.at(*s).abs()).fold(0.0, f64::max);
        if most > 0.0 {
            self.0.iter_mut().for_each(|(a, ..)| *a /= most);
        }
    }
}

/// How much the path turns away from the wall about a place.
struct Bend {
    s_mm: Vec<f64>,
    /// Turned so far, rad.
    turned: Vec<f64>,
    /// Once round, rad; `None` for an open path.
    round: Option<f64>,
    reach_mm: f64,
}

impl Bend {
    fn new(path: &Path, reach_mm: f64) -> Self {
        let away = if path.side == Side::Right { 1.0 } else { -1.0 };
        let mut sum = 0.0;
        let mut turned = vec![0.0];
        for pair in path.tangent.windows(2) {
            sum += away * turn(pair[0], pair[1]);
            turned.push(sum);
        }
        let ends = path.tangent.last().zip(path.tangent.first());
        let round = ends.filter(|_| path.closed).map(|(out, on)| sum + away * turn(*out, *on));
        Self { s_mm: path.s_mm.clone(), turned, round, reach_mm }
    }

    /// Turn within the reach to either side, rad, positive in inside corners.
    fn at(&self, s: f64) -> f64 {
        self.until(s + self.reach_mm) - self.until(s - self.reach_mm)
    }

    fn until(&self, s: f64) -> f64 {
        let length = self.s_mm.last().copied().unwrap_or_default();
        if let Some(round) = self.round.filter(|_| length > 0.0) {
            let laps = (s / length).floor();
            return laps * round + self.within(s - laps * length);
        }
        self.within(s.clamp(0.0, length))
    }

    fn within(&self, s: f64) -> f64 {
        let last = self.s_mm.len() - 1;
        let k = self.s_mm.partition_point(|at| *at <= s).clamp(1, last);
        let u = ((s - self.s_mm[k - 1]) / (self.s_mm[k] - self.s_mm[k - 1])).clamp(0.0, 1.0);
        self.turned[k - 1] + (self.turned[k] - self.turned[k - 1]) * u
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::segment::Segment;
    use super::*;

    #[test]
    fn a_bend_is_counted_round_the_seam_and_only_away_from_the_wall() {
        let at = |a: f64| [20.0 * a.cos(), 20.0 * a.sin()];
        let arc = |from: f64, to: f64| Segment::Arc { from: at(from), to: at(to), centre: [0.0, 0.0], ccw: true };
        let ring = [arc(0.0, PI), arc(PI, 2.0 * PI)];
        // 10 mm of way on a radius of 20 mm turn by half a radian, at the seam as elsewhere.
        for (side, expected) in [(Side::Right, 0.5), (Side::Left, -0.5)] {
            let bend = Bend::new(&Path::new(&ring, side, 0.1).expect("a path"), 5.0);
            for s in [0.0, 2.0, 60.0, 124.0] {
                assert!((bend.at(s) - expected).abs() < 0.02, "{s}: {}", bend.at(s));
            }
        }
    }
}
