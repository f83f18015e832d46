//! A shop that mills one part after the other, by the numbers that are drawn for it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use truepath_batch::series::{Event, Place, Reading, Series};

/// A shop.
#[derive(Clone, Copy, Debug)]
pub struct Shop {
    /// Places on the wall.
    pub places: usize,
    /// Noise of a reading, mm.
    pub noise_mm: f64,
    /// What the datum differs by from part to part, mm.
    pub datum_mm: f64,
    /// Drift of the datum along X per part, mm.
    pub warming_mm: f64,
    /// Growth of the force level per part.
    pub wear: f64,
    /// A step of the force level at a part.
    pub step: Option<(u32, f64)>,
    /// A step of the datum at a part, mm.
    pub moved: Option<(u32, f64)>,
    /// New cutters, told or not: the level falls back to where it was at first.
    pub cutter: Option<(u32, bool)>,
    /// Every so manieth part is touched.
    pub every: u32,
}

impl Default for Shop {
    fn default() -> Self {
        Self {
            places: 24,
            noise_mm: 0.002,
            datum_mm: 0.0015,
            warming_mm: 0.0,
            wear: 0.0,
            step: None,
            moved: None,
            cutter: None,
            every: 1,
        }
    }
}

impl Shop {
    /// The force level at a part, counted from the first.
    pub fn level(&self, part: u32) -> f64 {
        let since = self.cutter.map_or(1, |(at, _)| if part >= at { at } else { 1 });
        let worn = self.wear * f64::from(part - since);
        worn + self.step.filter(|(at, _)| part >= *at).map_or(0.0, |(_, by)| by)
    }

    /// Parts 1 to `last`, touched.
    pub fn mill(&self, last: u32, seed: u64) -> Series {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let mut draw = || normal.sample(&mut random);
        let places: Vec<(Place, f64)> = (0..self.places)
            .map(|k| {
                let turn = std::f64::consts::TAU * k as f64 / self.places as f64;
                let place = Place {
                    contour: None,
                    s_mm: 12.0 * k as f64,
                    height_mm: 5.0,
                    normal: [turn.cos(), turn.sin()],
                    // Three times as much in some corners.
                    deflection_mm: if k % 6 == 5 { 0.3 } else { 0.1 },
                };
                (place, 0.004 * draw())
            })
            .collect();
        let mut series = Series::default();
        let mut datum = [0.0; 2];
        for part in 1..=last {
            datum = [0.7 * datum[0] + self.datum_mm * draw(), 0.7 * datum[1] + self.datum_mm * draw()];
            let drift = self.warming_mm * f64::from(part - 1)
                + self.moved.filter(|(at, _)| part >= *at).map_or(0.0, |(_, by)| by);
            if part % self.every != 1 % self.every {
                continue;
            }
            let event = self.cutter.filter(|(at, told)| *at == part && *told).map(|_| Event::Cutter);
            let readings = places.iter().map(|(place, offset)| Reading {
                place: place.clone(),
                error_mm: offset
                    + self.level(part) * place.deflection_mm
                    + (datum[0] + drift) * place.normal[0]
                    + datum[1] * place.normal[1]
                    + self.noise_mm * draw(),
            });
            let readings: Vec<Reading> = readings.collect();
            series.push(part, event.into_iter().collect(), readings);
        }
        series
    }
}
