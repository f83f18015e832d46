//! A ball that is moved about beside a milled wall, wherever a program sends it.
//!
//! Unlike [`super::probe::probe`], which is told the place on the contour, this knows ways only: where on the way from one
//! point to another does a ball meet the wall as it was cut? The wall is that of the height of the ball's centre.
//!
//! What lies behind the wall is material: a ball whose centre is there touches.
//!
//! Instead of a milled wall it may be the raw stock, before the pass: alike at every height.
//!
//! Limit: as for the probe, the slope of the wall over the height is not seen, and nothing but the wall of the pass is
//! there: neither floor nor clamps nor the walls of other passes.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::machine::Machine;
use super::mill::Milled;
use super::part::Part;
use super::path::Path;
use super::setup::Cut;
use super::stock::Stock;
use super::vector::{Point, along, dot, mix, norm, scaled, squared_distance, sub, unit};

/// Points of the wall lie this near to each other, mm: a ball of 2 mm sinks 0.03 µm between them.
const SPACING_MM: f64 = 0.02;
/// Heights nearer to each other than this have one wall, mm.
const LAYER_MM: f64 = 0.001;
/// Neighbours farther apart than this, in steps of the path, are the ends of two walls.
const GAP_STEPS: f64 = 5.0;

/// A point beside which the wall is this far away along its own heading belongs to no place of it, mm.
const BESIDE_MM: f64 = 0.5;

/// Readings nearer to each other than this are of one touch, fast and slow, mm.
const SAME_TOUCH_MM: f64 = 0.2;

/// A point of the wall with the unit normal into the material.
#[derive(Debug, Clone, Copy)]
struct Spot {
    place: Point,
    normal: Point,
}

/// The raw stock before a pass, to be felt.
#[derive(Debug)]
pub struct RawStock {
    stock: Stock,
    machine: Machine,
}

impl RawStock {
    /// What the passes before this one have left for a cut, as the machine says it is uneven.
    pub fn new(path: &Path, cut: &Cut, machine: &Machine) -> Self {
        Self { stock: Stock::new(path, cut, machine), machine: machine.clone() }
    }

    fn spots(&self) -> Vec<Spot> {
        let (points, closed, side) = self.stock.outline();
        let normal = |from: Point, to: Point| {
            let [x, y] = unit(sub(to, from));
            scaled([-y, x], side)
        };
        let ends = points.iter().skip(1).chain(points.first().filter(|_| closed));
        let pieces = points.iter().zip(ends);
        pieces.map(|(from, to)| Spot { place: *from, normal: normal(*from, *to) }).collect()
    }
}

/// Whose wall it is.
#[derive(Debug, Clone, Copy)]
enum Made<'m> {
    /// A pass, with Z of the cutter's tip.
    Pass(&'m Milled, f64),
    /// A part that several runs have cut.
    Part(&'m Part),
    /// Nobody has cut it yet.
    Stock(&'m RawStock),
}

impl<'m> Made<'m> {
    fn machine(self) -> &'m Machine {
        match self {
            Self::Pass(milled, _) => &milled.machine,
            Self::Part(part) => part.machine(),
            Self::Stock(stock) => &stock.machine,
        }
    }

    /// Points of the wall at a height in their order, and from which distance on two neighbours are the ends of two walls;
    /// beyond tip and top it is that of tip and top.
    fn wall(self, z_mm: f64) -> (Vec<Spot>, f64) {
        let (path, radius, errors) = match self {
            Self::Pass(milled, tip) => {
                let level = ((z_mm - tip) / milled.cut.axial_depth_mm).clamp(0.0, 1.0);
                let errors = milled.wall_errors(&[level]).into_iter().next().unwrap_or_default();
                (&milled.path, milled.cut.radius_mm, errors)
            }
            Self::Part(part) => (part.path(), part.set_up().radius_mm, part.errors_at(z_mm)),
            Self::Stock(stock) => return (stock.spots(), f64::INFINITY),
        };
        let spot = |(k, error): (usize, f64)| Spot {
            place: along(path.wall(k, radius), path.normal[k], -error),
            normal: path.normal[k],
        };
        let wall = errors.into_iter().enumerate().filter(|(_, e)| e.is_finite()).map(spot).collect();
        (wall, GAP_STEPS * path.step_mm)
    }
}

/// A milled wall, felt with a ball.
#[derive(Debug)]
pub struct Felt<'m> {
    made: Made<'m>,
    layers: BTreeMap<i64, Vec<Spot>>,
    noise: ChaCha8Rng,
    /// How many touches there were, and where the ball stopped last, mm.
    touches: u64,
    last: Option<[f64; 3]>,
}

impl<'m> Felt<'m> {
    /// A wall; `tip_z_mm` is the Z of the cutter's tip in its pass.
    pub fn new(milled: &'m Milled, tip_z_mm: f64) -> Self {
        Self::made(Made::Pass(milled, tip_z_mm))
    }

    /// The wall of a part as all its runs have left it.
    pub fn of_part(part: &'m Part) -> Self {
        Self::made(Made::Part(part))
    }

    /// The stock before any pass.
    pub fn of_stock(stock: &'m RawStock) -> Self {
        Self::made(Made::Stock(stock))
    }

    fn made(made: Made<'m>) -> Self {
        let mut noise = ChaCha8Rng::seed_from_u64(made.machine().seed);
        noise.set_stream(3);
        Self { made, layers: BTreeMap::new(), noise, touches: 0, last: None }
    }

    /// The share of the way at which a ball, its centre at the height `z_mm`, meets the wall first; 0 where it touches it
    /// from the beginning, `None` where it does not meet it. Radius in mm.
    pub fn meets(&mut self, z_mm: f64, from: Point, to: Point, radius_mm: f64) -> Option<f64> {
        let way = sub(to, from);
        let square = dot(way, way);
        let middle = mix(from, to, 0.5);
        let reach = (0.5 * norm(way) + radius_mm).powi(2);
        if self.is_inside(z_mm, from) {
            return Some(0.0);
        }
        let first = |wall: &Spot| {
            let off = sub(from, wall.place);
            let ahead = dot(off, off) - radius_mm * radius_mm;
            if ahead <= 0.0 {
                return Some(0.0);
            }
            let closing = dot(off, way);
            let root = closing * closing - square * ahead;
            (square > 0.0 && root >= 0.0 && closing < 0.0)
                .then(|| (-closing - root.sqrt()) / square)
                .filter(|share| *share <= 1.0)
        };
        let near = self.layer(z_mm).iter().filter(|wall| squared_distance(wall.place, middle) <= reach);
        near.filter_map(first).min_by(f64::total_cmp)
    }

    /// Distance of a point from the wall at a height, mm.
    pub fn distance_mm(&mut self, z_mm: f64, point: Point) -> f64 {
        self.layer(z_mm).iter().map(|w| squared_distance(w.place, point)).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Whether a point lies behind the wall, in the material.
    fn is_inside(&mut self, z_mm: f64, point: Point) -> bool {
        let off = |spot: &&Spot| squared_distance(spot.place, point);
        let nearest = self.layer(z_mm).iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.is_some_and(|spot| {
            let away = sub(point, spot.place);
            let depth = dot(away, spot.normal);
            depth > 0.0 && dot(away, away) - depth * depth < BESIDE_MM * BESIDE_MM
        })
    }

    /// What the next reading is off along the way of the ball, mm, by the probe of the machine: Gaussian noise, lobes by the
    /// direction of the way in the plane, wild touches. `at` is where the ball stops; a second reading there is of the same touch.
    pub fn off_mm(&mut self, at: [f64; 3], way: Point) -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut self.noise);
        let machine = self.made.machine();
        let off = machine.probe_noise_mm * drawn;
        if norm(way) == 0.0 {
            return off;
        }
        let apart = |last: [f64; 3]| (0..3).map(|k| (at[k] - last[k]).powi(2)).sum::<f64>().sqrt() > SAME_TOUCH_MM;
        if self.last.is_none_or(apart) {
            self.touches += 1;
        }
        self.last = Some(at);
        off + machine.probe.beyond(self.touches - 1, way, machine.seed)
    }

    /// The wall at a height; beyond tip and top that of tip and top.
    fn layer(&mut self, z_mm: f64) -> &[Spot] {
        let made = self.made;
        self.layers.entry((z_mm / LAYER_MM).round() as i64).or_insert_with(|| {
            let (wall, gap) = made.wall(z_mm);
            let mut dense = Vec::new();
            for pair in wall.windows(2) {
                let length = norm(sub(pair[1].place, pair[0].place));
                let pieces = if length > gap { 1.0 } else { (length / SPACING_MM).ceil().max(1.0) };
                let place = |k: usize| mix(pair[0].place, pair[1].place, k as f64 / pieces);
                dense.extend((0..pieces as usize).map(|k| Spot { place: place(k), normal: pair[0].normal }));
            }
            dense.extend(wall.last());
            dense
        })
    }
}
