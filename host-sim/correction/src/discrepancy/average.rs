//! Kernels by their evidence: points of something else, mean and standard deviation.

use rayon::prelude::*;
use truepath_core::cut::{Path, Sample};
use truepath_core::identify::COUNT;
use truepath_core::job;
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm, nm, rounded};

use super::allowance::Allowance;
use super::evidence::{Factored, Task, discrepancy};
use super::feature::{Feature, Sensitivity};
use super::kernel::{Extent, Kernel, Pair, SIZE};
use super::nominal::{Nominal, by_stock, stock_sensitivities, with_stock};
use super::points::{Points, Row, SHARED, WithPlace};

/// One quantity of a kernel: the values that are tried, with what is believed of each (natural logarithm).
struct Axis {
    values: &'static [([f64; 2], f64)],
    set: fn(&mut Kernel, [f64; 2]),
}

/// What is tried. Sizes and beliefs are those of shops: most walls are cut evenly, a few with a quarter more stock in places;
/// machines drift by some micrometres while a contour is cut; a cutter's force rises by some per cent from part to part, and a step
/// of 18 % has been seen.
const AXES: [Axis; 8] = [
    Axis {
        values: &[
            ([0.0, 1.0], -0.7),
            ([0.03, 4.0], -2.5),
            ([0.07, 1.0], -3.5),
            ([0.07, 2.5], -3.0),
            ([0.07, 6.0], -3.0),
            ([0.15, 1.0], -4.0),
            ([0.15, 2.5], -3.5),
            ([0.15, 6.0], -3.5),
        ],
        set: |kernel, [stock, reach]| (kernel.stock, kernel.stock_reach) = (stock, reach),
    },
    Axis {
        values: &[([0.0, 0.0], -0.7), ([0.04, 0.0], -2.0), ([0.15, 0.0], -3.0)],
        set: |kernel, [load, _]| kernel.load = load,
    },
    Axis {
        values: &[([0.0, 0.0], -0.5), ([0.004, 0.0], -1.6), ([0.012, 0.0], -2.3)],
        set: |kernel, [drift, _]| kernel.drift = drift,
    },
    Axis {
        values: &[
            ([0.0, 0.4], -0.7),
            ([0.002, 0.4], -2.0),
            ([0.002, 2.0], -2.5),
            ([0.005, 0.4], -2.5),
            ([0.005, 2.0], -3.0),
            ([0.012, 0.4], -3.5),
            ([0.012, 2.0], -4.0),
            ([0.03, 0.4], -4.5),
        ],
        set: |kernel, [local, reach]| (kernel.local, kernel.local_reach) = (local, reach),
    },
    Axis {
        values: &[
            ([0.0, 0.0], -0.7),
            ([0.002, 0.0], -1.6),
            ([0.005, 0.0], -2.3),
            ([0.012, 0.0], -3.5),
            ([0.03, 0.0], -4.5),
        ],
        set: |kernel, [keyed, _]| kernel.keyed = keyed,
    },
    Axis {
        values: &[([0.02, 0.0], -1.0), ([0.08, 0.0], -0.9), ([0.16, 0.0], -1.5)],
        set: |kernel, [wear, _]| kernel.wear = wear,
    },
    Axis {
        values: &[([0.0, 0.0], -0.7), ([0.003, 0.0], -1.6), ([0.008, 0.0], -2.3), ([0.02, 0.0], -3.5)],
        set: |kernel, [height, _]| kernel.height = height,
    },
    Axis {
        values: &[([0.7, 0.0], -1.6), ([1.0, 0.0], -0.7), ([1.5, 0.0], -1.6), ([2.5, 0.0], -3.0)],
        set: |kernel, [noise, _]| kernel.noise = noise,
    },
];

/// What readings of something else are: one in a hundred, anywhere within half a millimetre.
const ELSEWHERE: f64 = 0.01 / 0.5;
/// A value of one quantity that lowers the probability to less is not combined with others.
const NEARLY: f64 = 0.15;
/// Combinations that are looked at.
const MOST_KERNELS: usize = 128;
/// Kernels of a smaller share than this of the largest do not count.
const LEAST_SHARE: f64 = 0.02;
/// Times that points of something else are looked for.
const ROUNDS: usize = 8;
/// Sweeps over the axes until nothing is better.
const SWEEPS: usize = 4;
/// Places at most between which a standard deviation is interpolated.
const PLACES: usize = 400;

/// What parts show beside the model.
#[derive(Clone, Debug)]
pub struct Discrepancy {
    points: Points,
    /// The rows that are used: the others are of something else.
    used: Vec<usize>,
    /// Kernels with their shares.
    kernels: Vec<(f64, Factored)>,
    /// All kinds of these, and those of the load.
    distinct: Distinct,
    of_load: Distinct,
    /// The stock that they show.
    allowance: Allowance,
}

/// Beside every sample of a contour.
#[derive(Clone, Debug, Default)]
pub struct Along {
    /// Expected discrepancy, that of other stock included.
    pub mean: Vec<Offset>,
    /// The same without it.
    pub rest: Vec<Offset>,
    /// By how much the expected stock lies nearer to the wall than the job says, at every sample of the path; empty for nowhere.
    pub stock: Vec<Offset>,
    /// Standard deviation of the wall that the next correction leaves by what the points leave open, beyond that by the
    /// fitted parameters.
    pub sigma: Vec<Offset>,
    /// Standard deviation by what the next part does otherwise than the last: level of force, size of the cutter.
    pub repeat: Vec<Offset>,
    /// What differs by the load, which is more at some heights and less at others.
    pub by_load: ByLoad,
}

/// What the load does of what is beside every sample of a contour.
#[derive(Clone, Debug, Default)]
pub struct ByLoad {
    /// Its part of the expected discrepancy, that of other stock not included.
    pub mean: Vec<Offset>,
    /// Its part of the variance that the points leave open, 0…1.
    pub share: Vec<f64>,
    /// Standard deviation of the level of force of the next part over that of the last, natural logarithm.
    pub level: f64,
}

impl ByLoad {
    /// Nothing.
    const NONE: Self = Self { mean: Vec::new(), share: Vec::new(), level: 0.0 };
}

impl Along {
    /// Nothing.
    pub const NONE: Self = Self {
        mean: Vec::new(),
        rest: Vec::new(),
        stock: Vec::new(),
        sigma: Vec::new(),
        repeat: Vec::new(),
        by_load: ByLoad::NONE,
    };

    /// The same before a part whose level of force over that of the last has a standard deviation of its own, natural logarithm.
    #[must_use]
    pub fn of_next_level(self, sigma: f64) -> Self {
        let more = if self.by_load.level > 0.0 { (sigma / self.by_load.level).powi(2) } else { 0.0 };
        let scaled = |repeat: &Offset| {
            let of_level = mm(*repeat).powi(2) - SIZE.powi(2);
            nm((of_level.max(0.0) * more + SIZE.powi(2)).sqrt())
        };
        let repeat = self.repeat.iter().map(scaled).collect();
        Self { repeat, by_load: ByLoad { level: sigma, ..self.by_load }, ..self }
    }

    /// A path in the stock that is expected, in a buffer, and what is beside a machine that cuts it.
    pub fn in_stock<'a>(&self, path: &Path<'a>, buffer: &'a mut Vec<Sample>) -> (Path<'a>, Self) {
        if self.stock.len() != path.samples().len() {
            return (*path, self.clone());
        }
        let path = with_stock(path, self.stock.iter().copied(), buffer);
        (path, Self { mean: self.rest.clone(), ..self.clone() })
    }
}

/// Expected discrepancy at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AtPoint {
    /// All of it, mm.
    pub(super) all: f64,
    /// What of that a millimetre more of allowance does, mm.
    pub(super) per_stock: f64,
    /// What a level of force larger by one does, natural logarithm, mm.
    pub(super) per_level: f64,
}

/// How large the kinds are, root mean square over the kernels by their shares.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Sizes {
    /// Share of the allowance that differs along the contour.
    pub stock_share: f64,
    /// Share of the load that differs along the contour at the same stock.
    pub load_share: f64,
    /// Drift of the datum, mm.
    pub drift_mm: f64,
    /// What holds around a place only, mm.
    pub local_mm: f64,
    /// What holds wherever the cutter is engaged alike, mm.
    pub keyed_mm: f64,
    /// Level of force from part to part.
    pub level_share: f64,
}

impl Discrepancy {
    /// Of the points; `None` when there are none.
    pub fn of(points: Points) -> Option<Self> {
        let Likeliest { kernel, used, .. } = Likeliest::of(&points)?;
        let kernels = averaged(&Task::of(&points, &used), &kernel);
        Some(Self::by(points, used, kernels))
    }

    /// Of points about other parameters, by the kernels of this one: which are tried and which points are of the wall stays as it
    /// is, and so what follows changes little by little.
    pub(super) fn again(&self, points: Points) -> Option<Self> {
        let task = Task::of(&points, &self.used);
        let factored = |(_, factored): &(f64, Factored)| {
            let again = task.factored(&factored.kernel)?;
            Some((again.evidence + belief(&factored.kernel), again))
        };
        let kernels: Vec<(f64, Factored)> = self.kernels.iter().filter_map(factored).collect();
        let most = kernels.iter().map(|(height, _)| *height).max_by(f64::total_cmp)?;
        let kernels = shares(kernels.into_iter().map(|(height, of)| ((height - most).exp(), of)).collect());
        Some(Self::by(points, self.used.clone(), kernels))
    }

    fn by(points: Points, used: Vec<usize>, kernels: Vec<(f64, Factored)>) -> Self {
        let rows: Vec<&Row> = used.iter().map(|k| &points.rows[*k]).collect();
        let allowance = Allowance::of(&kernels, &rows, &points.extents);
        let distinct = Distinct::of(kernels.iter().map(|(_, of)| of.kernel));
        let of_load = Distinct::of(kernels.iter().map(|(_, of)| of.kernel.of_load()));
        Self { points, used, kernels, distinct, of_load, allowance }
    }

    /// How probable the points are by its most probable kernel, machine and discrepancy left open: natural logarithm of a density per
    /// mm of each.
    pub(super) fn ln_probability(&self) -> f64 {
        let heights = self.kernels.iter().map(|(_, of)| of.evidence + belief(&of.kernel));
        per_point(&self.points, &self.used, heights.fold(f64::NEG_INFINITY, f64::max))
    }

    /// The rows that are of the wall.
    pub(super) fn rows(&self) -> impl Iterator<Item = &Row> {
        self.used.iter().map(|k| &self.points.rows[*k])
    }

    /// Kernels with their shares.
    pub(super) fn kernels(&self) -> &[(f64, Factored)] {
        &self.kernels
    }

    /// The contours of the part.
    pub(super) fn extents(&self) -> &[Extent] {
        &self.points.extents
    }

    /// Mean of a quantity over the kernels.
    fn mean_over(&self, mut of: impl FnMut(&Factored) -> f64) -> f64 {
        self.kernels.iter().map(|(share, kernel)| share * of(kernel)).sum()
    }

    /// Expected discrepancy at a place of the next part, mm.
    pub fn at(&self, place: &Feature) -> f64 {
        self.by_kernels(place, &self.distinct)
    }

    /// The part of it that some kinds of every kernel make.
    fn by_kernels(&self, place: &Feature, kinds: &Distinct) -> f64 {
        let mut rows: Vec<WithPlace<'_>> = self.rows().map(|row| row.with(&self.points.extents, place)).collect();
        let mut lasting = |kernel| rows.iter_mut().map(|row| row.lasting(kernel)).collect::<Vec<f64>>();
        let known: Vec<Vec<f64>> = kinds.kernels.iter().map(&mut lasting).collect();
        self.mean_by(kinds, |factored, which| factored.mean(&known[which]))
    }

    /// Mean of a quantity over the kernels, which is asked for with the distinct one of each.
    fn mean_by(&self, kinds: &Distinct, of: impl Fn(&Factored, usize) -> f64) -> f64 {
        self.kernels.iter().zip(&kinds.which).map(|((share, kernel), which)| share * of(kernel, *which)).sum()
    }

    /// What is [beside the path with its stock](Self::rest_at) because the load differs, mm.
    fn by_load_at(&self, place: &Feature) -> f64 {
        self.by_kernels(place, &self.of_load) - place.stock * self.more_stock(place.contour, place.s)
    }

    /// The share of the variance of a place that the load has, before any points, 0…1.
    fn share_of_load(&self, place: &Feature) -> f64 {
        let mut pair = Pair::of(&self.points.extents, place, place);
        let mut variance = |kinds: &Distinct| {
            let known: Vec<f64> = kinds.kernels.iter().map(|kernel| kernel.lasting_of(&mut pair)).collect();
            self.mean_by(kinds, |_, which| known[which])
        };
        let all = variance(&self.distinct);
        if all > 0.0 { variance(&self.of_load) / all } else { 0.0 }
    }

    /// The same with all stock among the discrepancy: none is expected of the path.
    pub(super) fn in_even_stock(self) -> Self {
        Self { allowance: Allowance::default(), ..self }
    }

    /// By how much the allowance is expected to be larger at a place, mm along a contour, than the job says, mm.
    pub(super) fn more_stock(&self, contour: usize, s: f64) -> f64 {
        self.allowance.more(&self.points.extents, contour, s)
    }

    /// Expected discrepancy at a place, mm, beside what the path [with its stock](Self::stocked) has.
    pub fn rest_at(&self, place: &Feature) -> f64 {
        self.at(place) - place.stock * self.more_stock(place.contour, place.s)
    }

    /// A path with the stock that is expected along it, in a buffer; as it is where that is the job's.
    pub fn stocked<'a>(&self, path: &Path<'a>, contour: usize, buffer: &'a mut Vec<Sample>) -> Path<'a> {
        if self.allowance.is_even() {
            return *path;
        }
        with_stock(path, self.moved(path, contour).into_iter(), buffer)
    }

    /// By how much the expected stock lies nearer to the wall than the job says, at every sample of a path.
    fn moved(&self, path: &Path, contour: usize) -> Vec<Offset> {
        path.samples().iter().map(|sample| -nm(self.more_stock(contour, mm(sample.s)))).collect()
    }

    /// Expected level of force over that of the newest part of one that was cut so many parts before the next, natural logarithm.
    pub(super) fn level(&self, parts_ago: u32) -> f64 {
        self.mean_over(|factored| {
            let level = |row: &Row| factored.kernel.with_level(&row.feature, [row.parts_ago, parts_ago]);
            factored.mean(&self.rows().map(level).collect::<Vec<f64>>())
        })
    }

    /// Expected discrepancy at every point that was given, in their order; that of its own part, its level of force included.
    pub(super) fn at_points(&self) -> Vec<AtPoint> {
        let mut all = vec![AtPoint::default(); self.points.given];
        for row in &self.points.rows {
            let value = self.mean_over(|factored| {
                let covariance: Vec<f64> =
                    self.rows().map(|other| discrepancy(&self.points, &factored.kernel, other, row)).collect();
                factored.mean(&covariance)
            });
            for slot in row.points.clone().chain(row.other_half) {
                all[slot] = AtPoint { all: value, per_stock: row.feature.stock, per_level: row.feature.load };
            }
        }
        all
    }

    /// Beside every sample of a contour, where the correction leads the cutter to its nominal place. `core` is the fit of
    /// the relieved points.
    pub fn along(&self, path: &Path, contour: usize, core: &job::Identified) -> Along {
        let even = path.with_law(core.law);
        let mut buffer = Vec::new();
        let path = self.stocked(&even, contour, &mut buffer);
        let nominal = Nominal::of(&path, core);
        let features = looks(&nominal, &path, contour, core);
        let rest: Vec<Offset> = features.par_iter().map(|feature| nm(self.rest_at(feature))).collect();
        let (mean, rest, stock) = if self.allowance.is_even() {
            (rest, Vec::new(), Vec::new())
        } else {
            let all = rest.iter().zip(by_stock(&even, &path, core)).map(|(rest, by_stock)| *rest + by_stock);
            (all.collect(), rest, self.moved(&path, contour))
        };
        let stride = features.len().div_ceil(PLACES).max(1);
        let places: Vec<usize> = (0..features.len()).step_by(stride).chain(features.len().checked_sub(1)).collect();
        let known: Vec<[f64; 2]> = places
            .par_iter()
            .zip(nominal.sensitivities(&places))
            .map(|(k, sensitivity)| self.deviations(&features[*k], &sensitivity, core))
            .collect();
        let deviation = |k: usize| {
            let (at, share) = (k / stride, (k % stride) as f64 / stride as f64);
            let [from, to] = [at, at + 1].map(|at| known.get(at).or(known.last()).copied().unwrap_or_default());
            [0, 1].map(|which| nm(from[which] + share * (to[which] - from[which])))
        };
        let (sigma, repeat) = (0..features.len()).map(deviation).map(|[sigma, repeat]| (sigma, repeat)).unzip();
        let by_load = ByLoad {
            mean: features.par_iter().map(|feature| nm(self.by_load_at(feature))).collect(),
            // The exponentials of a browser have other last bits than those of a system.
            share: features.par_iter().map(|feature| rounded(self.share_of_load(feature), 9)).collect(),
            level: rounded(self.mean_over(|of| of.kernel.next_level().powi(2)).sqrt(), 9),
        };
        Along { mean, rest, stock, sigma, repeat, by_load }
    }

    /// How the places beside every sample of a contour look to the kernels, in the stock that is expected.
    pub(super) fn features(&self, path: &Path, contour: usize, core: &job::Identified) -> Vec<Feature> {
        let even = path.with_law(core.law);
        let mut buffer = Vec::new();
        let path = self.stocked(&even, contour, &mut buffer);
        looks(&Nominal::of(&path, core), &path, contour, core)
    }

    /// Standard deviations at a place of the next part, mm: of parameters and discrepancy together, without that which the
    /// covariance of the fit says already, and of what the part does otherwise than the last.
    fn deviations(&self, place: &Feature, sensitivity: &[f64; COUNT], core: &job::Identified) -> [f64; 2] {
        let prior: f64 = (0..SHARED).map(|k| sensitivity[k].powi(2) / self.points.precision[k]).sum();
        let (mut first, mut second, mut repeat) = (0.0, 0.0, 0.0);
        for (share, factored) in &self.kernels {
            let kernel = &factored.kernel;
            let covariance: Vec<f64> = self
                .rows()
                .map(|row| {
                    let of_parameters = |k: usize| row.sensitivity[k] * sensitivity[k] / self.points.precision[k];
                    let parametric: f64 = (0..SHARED).map(of_parameters).sum();
                    parametric + row.lasting(kernel, &self.points.extents, place)
                })
                .collect();
            let own = kernel.lasting(&self.points.extents, place, place);
            let variance = (prior + own - factored.known(&covariance)).max(0.0);
            repeat += share * kernel.next_step(place);
            let mean = factored.mean(&covariance);
            first += share * mean;
            second += share * (variance + mean * mean);
        }
        let together = (second - first * first).max(0.0);
        let sigma = core.fit.covariance.map(|row| row.map(float));
        let of_fit: f64 =
            (0..SHARED).map(|i| (0..SHARED).map(|j| sensitivity[i] * sigma[i][j] * sensitivity[j]).sum::<f64>()).sum();
        [(together - of_fit).max(0.0).sqrt(), repeat.sqrt()]
    }

    /// How large the kinds are.
    pub fn sizes(&self) -> Sizes {
        let square = |of: fn(&Kernel) -> f64| self.mean_over(|factored| of(&factored.kernel).powi(2)).sqrt();
        Sizes {
            stock_share: square(|k| k.stock),
            load_share: square(|k| k.load),
            drift_mm: square(|k| k.drift),
            local_mm: square(|k| k.local),
            keyed_mm: square(|k| k.keyed),
            level_share: square(|k| k.wear),
        }
    }
}

/// The kernels of a discrepancy as [`Kernel::lasting`] sees them: many differ only in what is of no account there.
#[derive(Clone, Debug)]
struct Distinct {
    kernels: Vec<Kernel>,
    /// Which of them every kernel is.
    which: Vec<usize>,
}

impl Distinct {
    fn of(all: impl Iterator<Item = Kernel>) -> Self {
        let mut kernels: Vec<Kernel> = Vec::new();
        let mut which = Vec::new();
        for kernel in all.map(|kernel| kernel.of_one_part()) {
            which.push(kernels.iter().position(|other| *other == kernel).unwrap_or(kernels.len()));
            if which.last() == Some(&kernels.len()) {
                kernels.push(kernel);
            }
        }
        Self { kernels, which }
    }
}

/// How the places beside every sample of a contour look to a kernel, where the correction leads the cutter to its nominal place.
fn looks(nominal: &Nominal<'_>, path: &Path, contour: usize, core: &job::Identified) -> Vec<Feature> {
    let engagement = nominal.engagement(contour);
    let level = float(core.prior.sigma[0]).max(1e-9);
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let by = nominal.by_compliance().into_iter().zip(stock_sensitivities(path, core));
    samples
        .iter()
        .zip(by)
        .map(|(sample, (compliance, stock))| {
            engagement.at(sample.s, sample.normal, Sensitivity { load: compliance / level, stock })
        })
        .collect()
}

/// The most probable kernel of some points.
struct Likeliest {
    kernel: Factored,
    /// The rows that are of the wall.
    used: Vec<usize>,
    /// Evidence of these rows and belief, natural logarithm.
    height: f64,
}

impl Likeliest {
    /// Points of something else are left out one after the other; `None` when there are none.
    fn of(points: &Points) -> Option<Self> {
        let mut used: Vec<usize> = (0..points.rows.len()).collect();
        let mut starts = Kernel::STARTS.to_vec();
        for round in 0..ROUNDS {
            let task = Task::of(points, &used);
            let climbed = starts.iter().filter_map(|start| ascend(&task, *start));
            let (kernel, height) = climbed.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
            starts = vec![kernel.kernel, Kernel::EVEN];
            let strange = strangest(&kernel, &used);
            // No more than a quarter may be of something else.
            let Some(strange) = strange.filter(|_| round + 1 < ROUNDS && used.len() * 4 > points.rows.len() * 3) else {
                return Some(Self { kernel, used, height });
            };
            used.retain(|k| *k != strange);
        }
        None
    }
}

/// How probable points are, machine and discrepancy left open: natural logarithm of a density per mm of each.
pub(super) fn ln_probability(points: &Points) -> Option<f64> {
    let Likeliest { used, height, .. } = Likeliest::of(points)?;
    Some(per_point(points, &used, height))
}

/// Evidence and belief of the rows that are used, with those that are not.
fn per_point(points: &Points, used: &[usize], height: f64) -> f64 {
    let strange = points.rows.len() - used.len();
    height - 0.5 * used.len() as f64 * std::f64::consts::TAU.ln() + strange as f64 * ELSEWHERE.ln()
}

/// The same of a reading of something else.
pub fn ln_probability_elsewhere() -> f64 {
    ELSEWHERE.ln()
}

/// Uphill from a kernel along one axis after the other, by evidence and belief: what is reached, and how high that is.
fn ascend(task: &Task<'_>, from: Kernel) -> Option<(Factored, f64)> {
    let mut best = task.factored(&from)?;
    let mut height = best.evidence + belief(&from);
    for _ in 0..SWEEPS {
        let before = height;
        for axis in &AXES {
            for (value, _) in axis.values {
                let mut kernel = best.kernel;
                (axis.set)(&mut kernel, *value);
                if kernel == best.kernel {
                    continue;
                }
                let Some(other) = task.factored(&kernel) else { continue };
                let its = other.evidence + belief(&kernel);
                if its > height + 1e-9 {
                    (best, height) = (other, its);
                }
            }
        }
        if height <= before {
            break;
        }
    }
    Some((best, height))
}

/// What is believed of a kernel, natural logarithm.
fn belief(kernel: &Kernel) -> f64 {
    let of = |axis: &Axis| {
        let same = |value: &[f64; 2]| {
            let mut other = *kernel;
            (axis.set)(&mut other, *value);
            other == *kernel
        };
        axis.values.iter().find(|(value, _)| same(value)).map_or(f64::NEG_INFINITY, |(_, belief)| *belief)
    };
    AXES.iter().map(of).sum()
}

/// Kernels around the best with their shares: every combination of the values that are nearly as probable by themselves,
/// the others at their best.
fn averaged(task: &Task<'_>, best: &Factored) -> Vec<(f64, Factored)> {
    let height = best.evidence + belief(&best.kernel);
    let probable = |kernel: &Kernel| {
        let other = task.factored(kernel)?;
        let share = (other.evidence + belief(kernel) - height).exp();
        Some((share, other))
    };
    let mut worth: Vec<(f64, usize, [f64; 2])> = Vec::new();
    for (at, axis) in AXES.iter().enumerate() {
        for (value, _) in axis.values {
            let mut kernel = best.kernel;
            (axis.set)(&mut kernel, *value);
            if kernel != best.kernel {
                worth.extend(probable(&kernel).map(|(share, _)| (share, at, *value)));
            }
        }
    }
    worth.retain(|(share, ..)| *share > NEARLY);
    worth.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
    let mut combined = vec![best.kernel];
    for (axis, values) in AXES.iter().zip(combinable(&worth)) {
        let with = |value: [f64; 2]| {
            let set = |kernel: &Kernel| {
                let mut kernel = *kernel;
                (axis.set)(&mut kernel, value);
                kernel
            };
            combined.iter().map(set).collect::<Vec<_>>()
        };
        let more: Vec<Kernel> = values.into_iter().flat_map(with).collect();
        combined.extend(more);
    }
    shares(combined.iter().filter_map(probable).collect())
}

/// The values of every axis that are combined, of some in the order of their shares: the most probable ones first, as many as all
/// combinations leave room for.
fn combinable(worth: &[(f64, usize, [f64; 2])]) -> [Vec<[f64; 2]>; AXES.len()] {
    let mut chosen: [Vec<[f64; 2]>; AXES.len()] = Default::default();
    let mut count = 1;
    for (_, axis, value) in worth {
        let values = chosen[*axis].len() + 1;
        let more = count / values * (values + 1);
        if more <= MOST_KERNELS {
            chosen[*axis].push(*value);
            count = more;
        }
    }
    chosen
}

/// Kernels with their shares, one in all, by how probable they are.
fn shares(mut kernels: Vec<(f64, Factored)>) -> Vec<(f64, Factored)> {
    let most = kernels.iter().map(|(share, _)| *share).fold(0.0, f64::max);
    kernels.retain(|(share, _)| *share > LEAST_SHARE * most);
    let sum: f64 = kernels.iter().map(|(share, _)| share).sum();
    for (share, _) in &mut kernels {
        *share /= sum;
    }
    kernels
}

/// The used row that is most probably of something else, if any is more probably so than not.
fn strangest(factored: &Factored, used: &[usize]) -> Option<usize> {
    let surprise = |(residual, variance): (f64, f64)| {
        let density = (-0.5 * residual * residual / variance).exp() / (std::f64::consts::TAU * variance).sqrt();
        density / ELSEWHERE
    };
    let each = factored.left_out().into_iter().map(surprise).zip(used);
    let (least, row) = each.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (least < 1.0).then_some(*row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_probable_values_are_combined_whatever_their_axis() {
        let worth: Vec<(f64, usize, [f64; 2])> =
            (0..60).map(|k| (1.0 - f64::from(k) / 100.0, (k % 8) as usize, [f64::from(k), 0.0])).collect();
        let chosen = combinable(&worth);
        assert_eq!(chosen.iter().map(|values| values.len() + 1).product::<usize>(), MOST_KERNELS);
        assert_eq!(chosen.each_ref().map(Vec::len), [1, 1, 1, 1, 1, 1, 1, 0], "the first seven, twice each");
        // The last axis alone: as many as there is room for.
        let worth: Vec<(f64, usize, [f64; 2])> = (0..200).map(|k| (0.5, 7, [f64::from(k), 0.0])).collect();
        assert_eq!(combinable(&worth)[7].len() + 1, MOST_KERNELS);
        assert!(combinable(&[]).iter().all(Vec::is_empty));
    }

    #[test]
    fn what_is_believed_of_a_kernel_is_of_the_values_that_are_tried() {
        assert!(belief(&Kernel::EVEN).is_finite());
        for start in Kernel::STARTS {
            assert!(belief(&start).is_finite(), "{start:?}");
        }
        assert_eq!(belief(&Kernel { wear: 0.5, ..Kernel::EVEN }), f64::NEG_INFINITY);
    }
}
