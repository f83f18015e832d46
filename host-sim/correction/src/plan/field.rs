//! What planned parts show beside the model: a wall error that is smooth over arc length and height.
//!
//! A Gaussian process (Rasmussen & Williams, *Gaussian Processes for Machine Learning*, ch. 2) with two kinds of likeness
//! along the contour: the same stretch, and any place where the cutter is engaged alike, so that what one corner taught is known
//! in the next, and on the other contours of the part. Half of either holds at every height, half at heights near to each other only: a wall that yields is off
//! from tip to top, a helix that differs at some heights.
//!
//! It was seen on the walls of the same passes with much the same loads, and is believed in for these only.

use truepath_core::cut::{Loop, Path};
use truepath_core::process::Slices;
use truepath_core::units::Offset;
use truepath_ground::cholesky::Cholesky;
use truepath_ground::units::{float, mm};

/// A place of the wall as the kernel sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of the contour on the part, and its length where it is closed, mm.
    contour: (usize, Option<f64>),
    /// Arc length, mm.
    s: f64,
    /// Engagement there and a quarter of the cutter's radius before and behind, rad.
    engaged: [f64; 3],
    /// Height above the tip as a share of the wall's.
    height: f64,
}

/// Standard deviations of the two kinds and the lengths over which they hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Of the same stretch, mm.
    pub stretch: f64,
    /// Of places that are engaged alike, mm.
    pub load: f64,
    /// Length over which a stretch holds, mm.
    reach: f64,
}

/// Engagement along a path, where a correction that works leads the cutter.
#[derive(Clone, Debug)]
pub struct Engagement<'p> {
    path: &'p Path<'p>,
    contour: usize,
    from: usize,
    engaged: Vec<f64>,
}

/// What the points of planned parts say about it.
#[derive(Clone, Debug)]
pub struct Field {
    kernel: Kernel,
    /// The points of planned parts, and which of all points they are.
    seen: Vec<(usize, Place)>,
    /// Covariance of all points, factored, and its inverse times what they have unexplained.
    factor: Cholesky,
    weights: Vec<f64>,
}

/// Engagements nearer than this are alike, rad.
const ALIKE: f64 = 0.15;
/// Length over which a stretch holds, in cutter radii.
const REACH: f64 = 0.5;
/// Length over the height, as a share of it.
const OVER_HEIGHT: f64 = 0.3;
/// Kinds of walls that are drawn of what stays open, at most.
const RANK: usize = 12;

fn bell(square: f64) -> f64 {
    (-0.5 * square).exp()
}

impl Place {
    /// On the first contour, open: with the arc length, mm, the engagement there and a quarter of the cutter's radius before and behind, rad, and the height
    /// above the tip as a share of the wall's.
    pub const fn new(s: f64, engaged: [f64; 3], height: f64) -> Self {
        Self { contour: (0, None), s, engaged, height }
    }

    /// The same on a contour of the part by its number, with its length where it is closed, mm.
    #[must_use]
    pub const fn on(self, contour: usize, round: Option<f64>) -> Self {
        Self { contour: (contour, round), ..self }
    }
}

impl<'p> Engagement<'p> {
    /// Of a machine on its path, which is a contour of the part by its number.
    pub fn of(machine: &'p Loop<'p>, contour: usize) -> Self {
        let path = machine.path;
        let working = path.working();
        let from = working.start;
        let engaged = |index: usize| {
            let per_tooth = path.setup().feed_per_tooth(path.samples()[index].feed);
            float(machine.nominal(index, machine.coefficients.chip_scale(per_tooth)).engaged)
        };
        Self { path, contour, from, engaged: working.map(engaged).collect() }
    }

    /// A place of the wall.
    pub fn place(&self, s: Offset, height: f64) -> Place {
        let quarter = Offset::from_nm(self.path.setup().radius.nm() / 4);
        let engaged = |s: Offset| {
            let at = self.path.index_at(s).saturating_sub(self.from);
            self.engaged.get(at).or(self.engaged.last()).copied().unwrap_or(0.0)
        };
        let round = self.path.is_closed().then(|| mm(self.path.length()));
        Place::new(mm(s), [engaged(s - quarter), engaged(s), engaged(s + quarter)], height).on(self.contour, round)
    }

    /// The middles of all slices beside every sample of the contour, as a bench holds a wall.
    fn wall(&self, slices: Slices) -> Vec<Place> {
        let samples = &self.path.samples()[self.path.first()..self.path.first() + self.path.count()];
        let middle = |k: usize| (k as f64 + 0.5) / slices.count() as f64;
        samples
            .iter()
            .flat_map(|sample| {
                let lowest = self.place(sample.s, 0.0);
                (0..slices.count()).map(move |k| Place { height: middle(k), ..lowest })
            })
            .collect()
    }
}

impl Kernel {
    /// With the standard deviations of the same stretch and of places that are engaged alike, mm; a stretch holds over half of
    /// the cutter's `radius`.
    pub fn new([stretch, load]: [f64; 2], radius: f64) -> Self {
        Self { stretch, load, reach: REACH * radius }
    }

    /// Covariance of two places, mm².
    pub fn of(&self, a: &Place, b: &Place) -> f64 {
        let ((contour, round), mut way) = (a.contour, (a.s - b.s).abs());
        if let Some(round) = round {
            way = way.min((round - way).abs());
        }
        let near = if contour == b.contour.0 { bell((way / self.reach).powi(2)) } else { 0.0 };
        let apart = |k: usize| ((a.engaged[k] - b.engaged[k]) / ALIKE).powi(2);
        let along = self.stretch.powi(2) * near + self.load.powi(2) * bell(apart(0) + apart(1) + apart(2));
        along * (0.5 + 0.5 * bell(((a.height - b.height) / OVER_HEIGHT).powi(2)))
    }
}

impl Field {
    /// Of a factored covariance of all points, whose `seen` ones are of planned parts, and its inverse times what they have
    /// unexplained.
    pub fn new(kernel: Kernel, seen: Vec<(usize, Place)>, factor: Cholesky, weights: Vec<f64>) -> Self {
        Self { kernel, seen, factor, weights }
    }

    /// Standard deviations of the same stretch and of places that are engaged alike, mm.
    pub const fn amplitudes_mm(&self) -> [f64; 2] {
        [self.kernel.stretch, self.kernel.load]
    }

    /// Covariance of a place with all points.
    fn likeness(&self, place: &Place) -> Vec<f64> {
        let mut likeness = vec![0.0; self.weights.len()];
        for (at, seen) in &self.seen {
            likeness[*at] = self.kernel.of(seen, place);
        }
        likeness
    }

    /// Its most probable size at a place, mm.
    pub fn at(&self, place: &Place) -> f64 {
        self.seen.iter().map(|(at, seen)| self.kernel.of(seen, place) * self.weights[*at]).sum()
    }

    /// Its most probable size beside every sample of a contour of the part, slice by slice.
    pub fn along(&self, (machine, contour): (&Loop, usize), slices: Slices) -> Vec<Offset> {
        let mean = |place: &Place| Offset::from_nm((self.at(place) * 1e6).round() as i64);
        Engagement::of(machine, contour).wall(slices).iter().map(mean).collect()
    }

    /// What the points leave open of it: columns whose outer products add up to nearly all of its covariance, each beside
    /// every sample of the contour, slice by slice, mm (a pivoted Cholesky decomposition of low rank).
    pub fn open(&self, (machine, contour): (&Loop, usize), slices: Slices) -> Vec<Vec<f64>> {
        let places = Engagement::of(machine, contour).wall(slices);
        let known: Vec<Vec<f64>> = places.iter().map(|p| self.factor.halfway(&self.likeness(p))).collect();
        let covariance = |a: usize, b: usize| {
            let learned: f64 = known[a].iter().zip(&known[b]).map(|(x, y)| x * y).sum();
            self.kernel.of(&places[a], &places[b]) - learned
        };
        let mut left: Vec<f64> = (0..places.len()).map(|k| covariance(k, k)).collect();
        let enough = 0.01 * left.iter().copied().fold(0.0, f64::max);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        while columns.len() < RANK {
            let Some((pivot, most)) = left.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            if most <= enough.max(1e-12) {
                break;
            }
            let root = most.sqrt();
            let entry = |k: usize| {
                let before: f64 = columns.iter().map(|column| column[k] * column[pivot]).sum();
                (covariance(k, pivot) - before) / root
            };
            let column: Vec<f64> = (0..places.len()).map(entry).collect();
            left.iter_mut().zip(&column).for_each(|(left, entry)| *left = (*left - entry * entry).max(0.0));
            columns.push(column);
        }
        columns
    }
}
